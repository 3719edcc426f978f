"""The words of ``maulstick plan``, and what can be said against them before anything is read."""

from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.folder import check_free
from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan.options import PlanRequest, state_files
from maulstick.painting.picture import FITS
from maulstick.painting.raster import parse_size
from maulstick.painting.video import Video

_PAINTS = 12
_MOST_STROKES, _MOST_STEPS, _MOST_SEED, _MOST_TRIES = 100_000, 1_000_000, 2**32 - 1, 64
_FEWEST_PX, _MOST_PX = 16, 32_768

_painting = partial(typer.Option, rich_help_panel="The painting")
_liking = partial(typer.Option, rich_help_panel="What it should be like")
_planning = partial(typer.Option, rich_help_panel="How it is planned")
_writing = partial(typer.Option, rich_help_panel="What is written")


def paint(
    context: typer.Context,
    photo: Annotated[Path | None, typer.Argument(help="The picture to paint: JPEG, PNG, TIFF, WebP …")] = None,
    demo: Annotated[bool, typer.Option("--demo", metavar="", help="Paint the portrait that comes along.")] = False,
    size: Annotated[
        str, _painting(metavar="SIZE", help="Of the sheet: 200x160mm, 8x10in, A4-landscape.")
    ] = "200x160mm",
    paper: Annotated[str, _painting(metavar="COLOUR", help="Of the sheet: white, or #rrggbb.")] = "white",
    canvas: Annotated[
        Path | None, _painting(metavar="PICTURE", help="A photograph of the sheet, with what is painted on it so far.")
    ] = None,
    fit: Annotated[
        str, _painting(metavar="FIT", help="contain: all of the picture; cover: all of the sheet.")
    ] = "contain",
    strokes: Annotated[int, _painting(metavar="N", help="At most so many; those that do nothing are left out.")] = 400,
    exact: Annotated[bool, _painting("--exact", metavar="", help="Exactly so many strokes.")] = False,
    paints: Annotated[
        int | None, _painting(metavar="N", show_default=f"{_PAINTS}", help="How many to mix, of the picture's colours.")
    ] = None,
    paints_from: Annotated[
        Path | None, _painting(metavar="FILE", help="Paint with these, unmixed: CSV lines name,#rrggbb.")
    ] = None,
    ink: Annotated[
        str | None, _painting(metavar="COLOUR", help="One ink instead of paints: black, or #rrggbb.")
    ] = None,
    brush: Annotated[
        str, _painting(metavar="BRUSH", help="round, marker, fineliner, one of your own, or a JSON file.")
    ] = "round",
    pressure: Annotated[
        float | None,
        _painting(
            metavar="P", show_default="varied", help="Hold the brush at one pressure, 0 to 1, for a pen plotter."
        ),
    ] = None,
    style: Annotated[
        str, _painting(metavar="STYLE", help="Whose strokes: a name out of maulstick style list, or a JSON file.")
    ] = "free",
    text: Annotated[
        str | None, _liking(metavar="TEXT", help="What it should show, beside a picture or alone; needs CLIP.")
    ] = None,
    look: Annotated[
        Path | None, _liking(metavar="PICTURE", help="Let it look as this picture does, whatever that shows.")
    ] = None,
    weights: Annotated[
        list[str] | None,
        _liking(
            metavar="TERM=WEIGHT",
            help="How much a term counts, 0 not at all, 1 as usual: tone, edges, likeness, sketch, words, look.",
        ),
    ] = None,
    clip: Annotated[
        str | None,
        _liking(metavar="MODEL", show_default="RN101 with --text", help="Look through CLIP: RN101, ViT-B-32, …"),
    ] = None,
    clip_weights: Annotated[
        Path | None, _liking(metavar="FILE", help="Its weights; OpenAI's, unless --clip names another set: MODEL:SET.")
    ] = None,
    clip_layers: Annotated[
        str | None,
        _liking(metavar="N,N", show_default="four, spread evenly", help="Which of its layers to compare by."),
    ] = None,
    steps: Annotated[int, _planning(metavar="N", help="More are finer, and take longer.")] = 1500,
    ask_every: Annotated[
        int, _planning(metavar="N", help="Ask networks every so many steps; in between, go by what they said last.")
    ] = 10,
    px: Annotated[
        int | None,
        _planning(
            metavar="N",
            show_default="as the brush needs",
            help="Pixels over the picture's height while planning; a canvas of more than 2048 is planned in windows.",
        ),
    ] = None,
    seed: Annotated[int, _planning(metavar="N", help="Another seed, another painting; the same repeats it.")] = 0,
    tries: Annotated[
        int, _planning(metavar="N", help="Plan from so many seeds, as many at once as can be, and keep the best.")
    ] = 1,
    out: Annotated[Path, _writing(metavar="FOLDER", help="Where the painting goes.")] = Path("painting"),
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace what an earlier run wrote.")] = False,
    video: Annotated[str | None, _writing(metavar="FORMAT", help="Film the planning, too: mp4 or gif.")] = None,
    resume: Annotated[
        Path | None, _writing(metavar="FOLDER", help="Go on with a plan that was cut off, or stopped with Ctrl-C.")
    ] = None,
) -> None:
    """Plan a painting of a photograph, or of a text.

    Writes painting.json (the plan itself), painting.svg (for plotters: real millimetres, a layer a paint), preview.png
    and palette.png. Ctrl-C stops early and saves the plan so far; a second one leaves without it. While it works the
    plan is saved as plan-SEED.npz now and then, and --resume goes on from there with the same result.
    """
    if resume is not None:
        _refuse_other_words(context)
        from maulstick.cli.plan.run import go_on  # loads torch

        go_on(resume)
        return
    _check("--strokes", strokes, 1, _MOST_STROKES)
    request = PlanRequest(
        photo=_picture_path(photo, demo, text),
        text=_a_text(text),
        look=_whole(look),
        weights=_weights(weights or []),
        clip=clip,
        clip_weights=_whole(clip_weights),
        clip_layers=_layers(clip_layers),
        size=size,
        paper=paper,
        canvas=_whole(canvas),
        fit=fit,
        strokes=strokes,
        exact=exact,
        paints=_how_many_paints(paints, ink, paints_from, strokes),
        ink=ink,
        paints_from=_whole(paints_from),
        brush=_name_or_file(brush),
        pressure=pressure,
        style=_name_or_file(style),
        steps=steps,
        ask_every=ask_every,
        px=px,
        seed=seed,
        tries=tries,
        video=video,
    )
    _check_words(request)
    if state_files(out) and not overwrite:
        raise OutputError(
            f"the folder {out} holds a plan that was cut off; go on with maulstick plan --resume {out}, "
            "or add --overwrite"
        )
    check_free(out, overwrite)
    from maulstick.cli.plan.run import begin  # loads torch

    begin(request, out)


def _check_words(request: PlanRequest) -> None:
    """Whatever can be refused without reading a file."""
    from maulstick.colour.palette import parse_colour  # takes a moment

    parse_size(request.size)
    parse_colour(request.paper)
    if request.ink is not None:
        parse_colour(request.ink)
    if request.pressure is not None and not 0 <= request.pressure <= 1:
        raise InputError.of_range(
            "--pressure", request.pressure, "from 0, just touching, to 1, as deep as the brush goes"
        )
    if request.fit not in FITS:
        raise InputError.of_choice("fit", request.fit, FITS)
    _check("--steps", request.steps, 1, _MOST_STEPS)
    _check("--ask-every", request.ask_every, 1, _MOST_STEPS)
    _check("--px", request.px, _FEWEST_PX, _MOST_PX)
    _check("--tries", request.tries, 1, _MOST_TRIES)
    _check("--seed", request.seed, 0, _MOST_SEED + 1 - request.tries)
    if request.video is not None:
        Video(request.video)
        if request.tries > 1:
            raise InputError("--video videos one plan, and --tries makes several; leave one of them out")
    if request.canvas is not None and parse_colour(request.paper) != (1.0, 1.0, 1.0):
        raise InputError("--background shows the sheet as it is, and --paper its colour; leave one of them out")


def _refuse_other_words(context: typer.Context) -> None:
    for word in context.command.params:
        asked = str(context.get_parameter_source(word.name or "")).endswith("COMMANDLINE")
        if asked and word.name != "resume":
            raise InputError(f"--resume goes on with what was asked then; leave out {word.opts[0]}")


def _picture_path(photo: Path | None, demo: bool, text: str | None) -> Path | None:
    if photo is not None and demo:
        raise InputError("name one picture to paint, or --demo for the portrait that comes along")
    if photo is None and not demo:
        if text is None:
            raise InputError("name one picture to paint, --demo for the portrait that comes along, or a --text")
        return None
    return _whole(photo or Path(str(files("skimage.data").joinpath("astronaut.png"))))


def _a_text(text: str | None) -> str | None:
    if text is not None and not text.strip():
        raise InputError("--text is empty; say what the painting should show, as in 'a sailing boat at dusk'")
    return text


def _whole(path: Path | None) -> Path | None:
    return path.absolute() if path is not None else None


def _name_or_file(word: str) -> str:
    return str(Path(word).absolute()) if Path(word).suffix == ".json" else word


def _weights(words: list[str]) -> dict[str, float]:
    weights: dict[str, float] = {}
    for word in words:
        name, _, weight = word.partition("=")
        if name in weights:
            raise InputError(f"--weight names {name} twice; leave one of them out")
        try:
            weights[name] = float(weight)
        except ValueError:
            raise InputError(f"--weight is {word!r}; it must be a term and a number, as in edges=0.5") from None
    return weights


def _layers(words: str | None) -> tuple[int, ...] | None:
    if words is None:
        return None
    try:
        return tuple(int(word) for word in words.split(","))
    except ValueError:
        raise InputError(f"--clip-layers is {words!r}; it must be numbers from 0, as in 2,3") from None


def _how_many_paints(paints: int | None, ink: str | None, paints_from: Path | None, strokes: int) -> int | None:
    """How many to mix, or None."""
    given = {"--paints": paints, "--ink": ink, "--paints-from": paints_from}
    ways = [name for name, value in given.items() if value is not None]
    if len(ways) > 1:
        raise InputError(f"{ways[0]} and {ways[1]} are two ways to say what to paint with; leave one of them out")
    if paints is not None and not 1 <= paints <= strokes:
        raise InputError.of_range("--paints", paints, f"from 1 to the {strokes} strokes")
    return None if ways not in ([], ["--paints"]) else paints or min(_PAINTS, strokes)


def _check(name: str, number: int | None, least: int, most: int) -> None:
    if number is not None and not least <= number <= most:
        raise InputError.of_range(name, number, f"from {least} to {most}")
