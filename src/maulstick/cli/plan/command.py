"""Options of ``maulstick plan``, and checks of them before anything is read."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from maulstick.cli.folder import check_free
from maulstick.cli.lengths import with_unit
from maulstick.cli.loading import no_garbage
from maulstick.cli.plan.values import crop_of, layers_of, picture_path, strokes_of, weights_of
from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan.before import picture_near, planned_before
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.painting.brush import load_pen_brush
from maulstick.painting.edit import WHOLE
from maulstick.painting.painting_file import read_painting

_OPTION_OF = {"weights": "weight"}  # options of planning that have another name here

_painting = partial(typer.Option, rich_help_panel="The painting")
_picture = partial(typer.Option, rich_help_panel="The picture")
_objectives = partial(typer.Option, rich_help_panel="What it should be like")
_planning = partial(typer.Option, rich_help_panel="How it is planned")
_writing = partial(typer.Option, rich_help_panel="What is written")


def plan(
    context: typer.Context,
    picture: Annotated[
        Path | None, typer.Argument(metavar="[PICTURE]", help="The picture to paint: JPEG, PNG, TIFF, WebP and others.")
    ] = None,
    demo: Annotated[bool, typer.Option("--demo", metavar="", help="Paint the portrait that comes along.")] = False,
    strokes: Annotated[
        str,
        _painting(
            metavar="N|auto",
            help="Number of strokes, at most. Strokes that do nothing are left out. auto: as many as ink needs.",
        ),
    ] = str(PlanOptions.strokes),
    exact: Annotated[bool, _painting("--exact", metavar="", help="Paint exactly that many strokes.")] = False,
    style: Annotated[
        str,
        _painting(metavar="STYLE", help="Style of the strokes: a name from `maulstick style list`, or a JSON file."),
    ] = PlanOptions.style,
    hand_size: Annotated[
        float, _painting(metavar="TIMES", help="Draw the whole hand so many times as large: 0.5 on a small sheet.")
    ] = PlanOptions.hand_size,
    drawing: Annotated[
        str,
        _painting(metavar="WHAT", help="Draw contours and tones in ink (both), lines alone, or tones alone."),
    ] = PlanOptions.drawing,
    arrange: Annotated[
        float,
        _painting(metavar="SHARE", help="Arrange strokes of ink as the hand arranges them: 0, not at all, to 1."),
    ] = PlanOptions.arrange,
    brush: Annotated[
        str,
        _painting(
            metavar="BRUSH",
            help="The brush: round, marker, fineliner, wash, one of your own, or a JSON file; several in colours, "
            "as in wash,marker, the broadest first.",
        ),
    ] = PlanOptions.brush,
    pen: Annotated[
        str | None,
        _painting(metavar="PEN", help="Pen of the catalogue, for its width and colour: see `maulstick brush pens`."),
    ] = None,
    pressure: Annotated[
        float | None,
        _painting(metavar="P", show_default="varied", help="Hold the brush at one pressure, 0 to 1, for a plotter."),
    ] = None,
    robot: Annotated[
        str | None,
        _painting(
            metavar="MACHINE",
            help="Machine that will paint: one that only lifts its pen (axidraw, grbl, hpgl) holds the brush at one "
            "pressure.",
        ),
    ] = None,
    paints: Annotated[
        int | None,
        _painting(metavar="N", show_default="12", help="Number of paints to mix from the picture's colours."),
    ] = None,
    paints_from: Annotated[
        Path | None, _painting(metavar="FILE", help="Use these paints unmixed: a CSV file with lines name,#rrggbb.")
    ] = None,
    ink: Annotated[
        str | None,
        _painting(
            metavar="COLOUR", help="Draw in ink instead of paints: black, or #rrggbb; several as in black,#a04020."
        ),
    ] = None,
    size: Annotated[
        str,
        _painting(metavar="SIZE", help="Size of the sheet: 200x160mm, 8x10in, A4-landscape; A4-auto turns it to fit."),
    ] = PlanOptions.size,
    fit: Annotated[
        str, _painting(metavar="FIT", help="Show all of the picture (contain), or fill all of the sheet (cover).")
    ] = PlanOptions.fit,
    margin: Annotated[
        str,
        _painting(metavar="LENGTH", help="Leave paper bare around the picture, at each edge of the sheet: 10mm."),
    ] = PlanOptions.margin,
    rotate: Annotated[
        int, _picture(metavar="DEGREES", help="Turn the picture clockwise: 90, 180 or 270.")
    ] = PlanOptions.rotate,
    straighten: Annotated[
        float, _picture(metavar="DEGREES", help="Turn it clockwise by up to 15, and cut off its empty corners.")
    ] = PlanOptions.straighten,
    crop: Annotated[
        str | None,
        _picture(
            metavar="L,T,R,B",
            show_default="all of it",
            help="Keep what lies between these edges, left, top, right and bottom, in shares of the picture as it is "
            "turned: 0.1,0,0.9,1.",
        ),
    ] = None,
    exposure: Annotated[
        float, _picture(metavar="STOPS", help="Make it lighter, or below 0 darker: each stop doubles its light.")
    ] = PlanOptions.exposure,
    contrast: Annotated[
        float, _picture(metavar="TIMES", help="Strengthen its contrast about mid grey, or below 1 weaken it.")
    ] = PlanOptions.contrast,
    paper: Annotated[
        str, _painting(metavar="COLOUR", help="Colour of the sheet: white, or #rrggbb.")
    ] = PlanOptions.paper,
    background: Annotated[
        Path | None, _painting(metavar="PHOTO", help="A photograph of the sheet, with what is painted on it so far.")
    ] = None,
    again: Annotated[
        Path | None,
        _painting(
            metavar="PAINTING",
            help="Plan a painting.json again, with its options: its locked strokes, its sheet and its paints stay, the "
            "other strokes are planned on from where they are. With --background, what is painted is left out.",
        ),
    ] = None,
    regions: Annotated[
        Path | None,
        _painting(metavar="FILE", help="Map of the picture in colours, a PNG or an SVG: see --say."),
    ] = None,
    say: Annotated[
        Path | None,
        _painting(metavar="FILE", help="TOML file: the hand, brushes, colours and more where the map has each colour."),
    ] = None,
    guides: Annotated[
        Path | None,
        _painting(
            metavar="SVG",
            help="Lines over the picture that strokes near them follow; those on its layer 'paint' are painted as "
            "they are.",
        ),
    ] = None,
    pin: Annotated[
        list[str] | None,
        _painting(metavar="COLOUR", help="Use this colour as it is, among the paints to mix. May be repeated."),
    ] = None,
    text: Annotated[
        str | None,
        _objectives(metavar="TEXT", help="Paint what this text says, beside a picture or alone. Needs CLIP."),
    ] = None,
    look: Annotated[
        Path | None, _objectives(metavar="PICTURE", help="Paint in the look of this picture, whatever it shows.")
    ] = None,
    weight: Annotated[
        list[str] | None,
        _objectives(
            metavar="TERM=WEIGHT",
            help="Weight of one term of the loss, 1 for the usual: tone, edges, likeness, sketch, text, look. "
            "faces=0 lets faces count no more than the rest of the picture.",
        ),
    ] = None,
    clip: Annotated[
        str | None,
        _objectives(
            metavar="MODEL", show_default="RN101 with --text", help="Compare by a CLIP model, as RN101 or ViT-B-32."
        ),
    ] = None,
    clip_weights: Annotated[
        Path | None, _objectives(metavar="FILE", help="Read the weights of CLIP from this file.")
    ] = None,
    clip_layers: Annotated[
        str | None,
        _objectives(metavar="N,N", show_default="four, spread evenly", help="Layers of CLIP to compare by."),
    ] = None,
    steps: Annotated[
        int, _planning(metavar="N", help="Steps of the optimiser. More are finer, and take longer.")
    ] = PlanOptions.steps,
    ask_every: Annotated[
        int, _planning(metavar="N", help="Steps between two evaluations of a network.")
    ] = PlanOptions.ask_every,
    px: Annotated[
        int | None,
        _planning(
            metavar="N",
            show_default="as the brush needs",
            help="Pixels over the picture's height. A canvas of more than 2048 is planned in windows.",
        ),
    ] = None,
    seed: Annotated[
        int, _planning(metavar="N", help="Number that the plan starts from. The same one repeats the plan.")
    ] = PlanOptions.seed,
    device: Annotated[
        str,
        _planning(metavar="DEVICE", help="Device that computes: cpu, cuda, or auto: a GPU that draws as the CPU does."),
    ] = PlanOptions.device,
    tries: Annotated[
        int, _planning(metavar="N", help="Plan from this many seeds, in parallel, and keep the best plan.")
    ] = 1,
    workers: Annotated[
        int | None,
        _planning(
            metavar="N",
            show_default="one per core, at most 32",
            help="Processes that plan windows of a large canvas at the same time. Any number gives the same plan.",
        ),
    ] = None,
    out: Annotated[Path, _writing(metavar="FOLDER", help="Folder for the results.")] = Path("painting"),
    overwrite: Annotated[bool, _writing("--overwrite", metavar="", help="Replace earlier results there.")] = False,
    video: Annotated[str | None, _writing(metavar="FORMAT", help="Record the planning too: mp4 or gif.")] = None,
    resume: Annotated[
        Path | None, _writing(metavar="FOLDER", help="Go on with a plan that was cut off, or stopped with Ctrl-C.")
    ] = None,
) -> None:
    """Plan a painting of a picture or a text.

    Writes painting.json (the plan itself), painting.svg (for plotters: real millimetres, one layer per paint),
    preview.png and palette.png. Ctrl-C stops early and saves the plan so far; a second one leaves without it. While it
    works, the plan is saved as plan-SEED.npz now and then; --resume goes on from there with the same result.

    Example: maulstick plan photo.jpg --out cat --style hatching --brush marker --strokes 800
    """
    if resume is not None:
        _refuse_other_options(context)
        with no_garbage():
            from maulstick.cli.plan.run import go_on  # loads torch

        go_on(resume, workers)
        return
    if pen is not None:
        if _is_given(context, "brush"):
            raise InputError("--pen and --brush both say what to draw with; leave out one")
        brush, colour = pen, load_pen_brush(pen)[1]
        ink = colour if (ink, paints, paints_from) == (None, None, None) else ink
    asked: dict[str, Any] = {
        "strokes": strokes_of(strokes),
        "exact": exact,
        "style": style,
        "hand_size": hand_size,
        "drawing": drawing,
        "arrange": arrange,
        "brush": brush,
        "pressure": pressure,
        "robot": robot,
        "paints": paints,
        "ink": ink,
        "paints_from": paints_from,
        "size": size,
        "fit": fit,
        "margin": with_unit(margin),
        "rotate": rotate,
        "straighten": straighten,
        "crop": WHOLE if crop is None else crop_of(crop),
        "exposure": exposure,
        "contrast": contrast,
        "paper": paper,
        "background": background,
        "regions": regions,
        "say": say,
        "guides": guides,
        "pin": tuple(pin or ()),
        "text": text,
        "look": look,
        "weights": weights_of(weight or []),
        "clip": clip,
        "clip_weights": clip_weights,
        "clip_layers": layers_of(clip_layers),
        "steps": steps,
        "ask_every": ask_every,
        "px": px,
        "seed": seed,
        "device": device,
    }
    if again is None:
        options, path = PlanOptions(**asked), picture_path(picture, demo, text)
    else:
        given = {name: value for name, value in asked.items() if _is_given(context, _OPTION_OF.get(name, name))}
        if pen is not None:
            given["brush"] = brush
        before = read_painting(again)
        options = planned_before(before, {**given, "again": again})
        path = picture_path(picture, demo, text, is_needed=False) or picture_near(before, again)
    request = PlanRequest(path, options, tries, video, workers)
    if state_files(out) and not overwrite:
        raise OutputError(
            f"the folder {out} holds a plan that was cut off; go on with maulstick plan --resume {out}, "
            "or add --overwrite"
        )
    check_free(out, overwrite)
    with no_garbage():
        from maulstick.cli.plan.run import begin  # loads torch

    begin(request, out)


def _refuse_other_options(context: typer.Context) -> None:
    for parameter in context.command.params:
        if _is_given(context, parameter.name or "") and parameter.name not in ("resume", "workers"):
            raise InputError(f"--resume goes on with what was asked then; leave out {parameter.opts[0]}")


def _is_given(context: typer.Context, parameter: str) -> bool:
    return str(context.get_parameter_source(parameter)).endswith("COMMANDLINE")
