"""Camera loop: photographs of the sheet on the way, from which the strokes that are left are planned again.

The only place where planning and machines meet.
"""

from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

import numpy as np

from maulstick.errors import InputError
from maulstick.jobs.plan.again import is_in_ink, neighbours_of, palette_of, parameters_of, with_locked
from maulstick.jobs.plan.device import choose_device
from maulstick.painting.brush import finest_of
from maulstick.painting.edit import PictureEdit
from maulstick.painting.painting import Paint, Painting, Sheet, Stroke
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas, parse_margin
from maulstick.planning.from_picture import as_painting, problem_of
from maulstick.planning.layout import HEIGHT_PX, LONGEST_PX, canvas_for, lay_out_for
from maulstick.planning.lines import lines_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.schedule import REPLAN
from maulstick.planning.tones import InkSupply, draw_light
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal
from maulstick.robot.room import check_accepted
from maulstick.robot.routine import NOTHING, PaintLoad, ways_of
from maulstick.robot.workplace import Workplace, home_of
from maulstick.storage.arrays import Image
from maulstick.style import Style, load_style

_STEPS = 400  # steps of planning again: few, since the machine waits and the strokes are nearly in place


def check_replannable(painting: Painting) -> None:
    """Raise InputError where the strokes of a painting cannot be planned again.

    That is so for no style, several styles or a changed one, and for plans by a text, a look, regions or guides.
    """
    for what in ("regions", "guides"):
        if painting.provenance.options.get(what):
            raise InputError(
                f"it was planned with {what}, which planning again on the way does not know; do not replan, but stop, "
                "and plan the rest again with a photograph as the background"
            )
    _weights(painting)
    if strokes := [stroke for stroke in painting.strokes if not stroke.locked]:
        _style_of(strokes, painting)


def replanned(
    painting: Painting,
    painted: Collection[int],
    photograph: Image,
    picture: Image,
    *,
    steps: int = _STEPS,
) -> Painting:
    """Return the painting with the unpainted strokes planned again, in their style, on the sheet as it is.

    Locked strokes stay as they are.
    painted: ids of the strokes that are on the sheet.  photograph: (h, w, 3) of the flat sheet, sRGB in [0, 1].
    picture: (H, W, 3), the one that was planned, as it was before the plan's corrections.  steps: of the optimiser.
    Strokes that are planned again get new ids; some may be left out, unless the plan had an exact number. Paints stay.
    Raises InputError as `check_replannable` does.
    """
    unpainted = [stroke for stroke in painting.strokes if stroke.id not in painted]
    left = [stroke for stroke in unpainted if not stroke.locked]
    locked = [stroke for stroke in unpainted if stroke.locked]
    if not left:
        return painting
    brushes, style, weights = tuple(painting.brushes.values()), _style_of(left, painting), _weights(painting)
    size = {"width": painting.sheet.width, "height": painting.sheet.height, "paper": painting.sheet.paper}
    sheet = Sheet.model_validate({**size, "picture": encode_png(photograph)})
    options = painting.provenance.options
    fit, pixels = str(options.get("fit", "contain")), options.get("px")
    pixels = pixels if isinstance(pixels, int) else HEIGHT_PX
    margin = parse_margin(str(options.get("margin", "0mm")), (sheet.width, sheet.height))
    picture = PictureEdit.of(options).applied(picture)
    finest = finest_of(brushes)
    if options.get("drawing") == "lines":
        light = draw_light(palette_of(painting), sheet.paper)
        picture = lines_for(picture, sheet, finest, fit, margin, light=light)
    canvas = canvas_for(picture, sheet, finest, fit, pixels, margin)
    in_one_piece = pixels * LONGEST_PX // max(canvas.width_px, canvas.height_px)
    pixels = max(1, min(pixels, in_one_piece))
    layout = lay_out_for(picture, sheet, finest, fit, pixels, margin)
    exact = options.get("exact") is True
    seed, arrange = painting.provenance.seed, options.get("arrange")
    settings = PlannerSettings(
        len(left),
        exact=exact,
        paints=None,
        palette=palette_of(painting),
        steps=steps,
        seed=seed,
        arrange=arrange if isinstance(arrange, int | float) else PlannerSettings.arrange,
        in_colours=not is_in_ink(painting),
    )
    bare, drawing = lay_out_for(picture, painting.sheet, finest, fit, pixels, margin), options.get("drawing", "both")
    with_lines = drawing == "both"
    supply = InkSupply.of(bare, finest, style, settings.palette, with_lines=with_lines) if settings.in_ink else None
    asked = options.get("strokes")  # tones are those of all, also where some were left out in the end
    count = max(len(painting.strokes), asked if isinstance(asked, int) else 0)
    problem = problem_of(
        layout,
        brushes,
        style,
        settings,
        LossOptions(weights=weights, contours=drawing != "tones"),
        device=choose_device("auto").device,
        tones=None if supply is None else supply.tones(count),
        bare=bare.under,
    )
    problem = replace(problem, neighbours=neighbours_of(locked, painting, brushes))
    start = parameters_of(left, painting, problem)
    planned = plan(problem, settings, schedule=REPLAN, start=start)
    again = as_painting(planned, layout, brushes, style, painting.provenance)
    return _joined(painting, painted, with_locked(again, locked, painting, planned))


def paint_by_eye(
    painting: Painting,
    workplace: Workplace,
    look: Callable[[], tuple[Image, Easel]],
    again: Callable[[Painting, Image], Painting],
    enough: Callable[[int], bool],
    load: PaintLoad = NOTHING,
) -> PaintLoad:
    """Paint the strokes that are left, and photograph the sheet and plan the rest again on the way.

    Where something is painted already, it begins with a look, since the sheet may have been moved meanwhile.
    look: returns a photograph, (h, w, 3) of the flat sheet, and the easel, which says where the sheet now lies.
    again: returns the painting with its unpainted strokes planned again on the photograph.
    enough: called after each stroke with the number painted since the last look; returns whether to look again.
    load: the paint that the machine holds at the beginning; the one at the end is returned.
    Each revision is on the disk, and in the journal, before its first stroke. Raises as `execute` and `look` do.
    """
    journal = workplace.journal
    home = home_of(workplace.robot, journal)
    while workplace.left_of(painting):
        if journal.painted:
            workplace.step_aside(home)
            photograph, easel = look()
            workplace = workplace.moved_to(easel)
            painting = again(painting, photograph)
            path = revision_of(journal, journal.revisions)
            write_painting(painting, path)
            journal.revise(path)
        painting = workplace.in_order(painting)
        actions = workplace.left_of(painting, load)
        check_accepted(ways_of(actions), workplace.easel, workplace.robot)
        load = workplace.do(actions, load, enough)
    return load


def revision_of(journal: Journal, number: int) -> Path:
    """Return the path that a revision of the painting of a journal is written to."""
    stem = journal.path.name.removesuffix(".log.jsonl")
    return journal.path.with_name(f"{stem}.r{number}.json")


def _weights(painting: Painting) -> dict[str, float]:
    """Return the weights by term that the painting was planned with. Raises InputError for a text or a look."""
    weights = painting.provenance.options.get("weights")
    found = {str(name): float(str(weight)) for name, weight in (weights if isinstance(weights, dict) else {}).items()}
    if missing := {"text", "look"} & set(found):
        raise InputError(
            f"{missing.pop()} was weighed when it was planned, which is not possible on the way; do not replan"
        )
    return found


def _style_of(strokes: list[Stroke], painting: Painting) -> Style:
    """Return the one style of the strokes. Raises InputError where it is not one, or it has changed."""
    uses = {(stroke.style.name, stroke.style.hash) for stroke in strokes if stroke.style is not None}
    if len(uses) != 1 or any(stroke.style is None for stroke in strokes):
        raise InputError("the strokes that are left are not all of one style; only those are planned again")
    name, known = uses.pop()
    sheet = painting.sheet
    options = painting.provenance.options
    style = load_style(str(options.get("style", name)), Canvas(sheet.width, sheet.height, 1.0))
    style = style.scaled(float(str(options.get("hand_size", 1.0))))
    if style.hash != known:
        raise InputError(f"the style {style.name} is not what it was when the painting was planned; plan it anew")
    return style


def _joined(painting: Painting, painted: Collection[int], again: Painting) -> Painting:
    """Return the painting with its painted strokes, followed by those planned `again`, in its own paints."""
    paint_of = [_nearest(painting.paints, paint) for paint in again.paints]
    rest = [stroke.model_copy(update={"paint": paint_of[stroke.paint]}) for stroke in again.strokes]
    kept = [stroke for stroke in painting.strokes if stroke.id in painted]
    return painting.model_copy(update={"strokes": (*kept, *rest)})


def _nearest(paints: tuple[Paint, ...], wanted: Paint) -> int:
    """Return the index of the paint of the wanted brush whose colour is nearest."""
    there = [number for number, paint in enumerate(paints) if paint.brush == wanted.brush]
    colours = np.array([paints[number].colour for number in there])
    return there[int(np.abs(colours - wanted.colour).sum(axis=1).argmin())]
