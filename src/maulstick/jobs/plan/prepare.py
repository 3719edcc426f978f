"""Preparation of a plan: the files of a request are read and checked; nothing is planned yet."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.metadata import version

import numpy as np

from maulstick.colour.palette import parse_colour
from maulstick.colour.tubes import NamedPaint, read_paints
from maulstick.errors import InputError, option
from maulstick.jobs.plan.device import Choice, choose_device
from maulstick.jobs.plan.options import AUTO, MOST_AUTO, PlanOptions
from maulstick.jobs.plan.request import PlanRequest, sum_of
from maulstick.painting.brush import Brush, finest_of, load_brushes, names_of
from maulstick.painting.edit import NO_EDIT
from maulstick.painting.painting import Painting, Provenance, Sheet, hex_colour
from maulstick.painting.picture import READ_PX, canvas_photograph, encode_png, read_picture
from maulstick.painting.raster import Canvas, parse_margin, parse_sheet
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of, with_metrics
from maulstick.planning.layout import LONGEST_PX, Layout, canvas_for, lay_out_for
from maulstick.planning.lines import lines_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import PlanProgress, PlanResult, plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.room import check_room, surface_of
from maulstick.planning.state import State
from maulstick.planning.tones import InkSupply, Tones
from maulstick.robot.sheet_reach import sheet_fault
from maulstick.storage.arrays import Image
from maulstick.style import Style, load_style

_CROWDED = 0.7  # times a hand's size, below which strokes lie more than twice as densely as the hand draws them
_SHEET_PX, _WIDEST_SHEET_PX = 1024, 2048  # a background over the sheet's height and width: finer than plans need


@dataclass(frozen=True)
class Prepared:
    """All that planning and its file need.

    names: names of the paints by their colours as ``#rrggbb``.  mural: set where the picture is planned in windows.
    device: what plans, and a note on it for people.  supply: of one ink, in a hand.
    is_held: whether the brush is held at one pressure since the machine only lifts its pen.
    """

    request: PlanRequest
    layout: Layout
    brushes: tuple[Brush, ...]
    style: Style
    settings: PlannerSettings
    problem: PlanningProblem
    provenance: Provenance
    names: dict[str, str]
    mural: Mural | None
    loss_options: LossOptions
    network: Callable[[], Network]
    device: Choice
    supply: InkSupply | None
    is_held: bool

    @property
    def tones(self) -> Tones | None:
        """Tones that the picture is planned in; None where any can be reached."""
        return None if self.supply is None else self.supply.tones(self.settings.strokes)

    @property
    def notes(self) -> list[str]:
        """Sentences for people on what may be other than they expect."""
        notes = [self.device.note]
        if self.is_held:
            widths = " and ".join(f"{2e3 * brush.widest:.2g}" for brush in self.brushes)
            notes.append(
                f"this machine only lifts its pen, so the brush {names_of(self.brushes)} is held at one pressure, "
                f"{self.request.options.held_pressure:g}, and draws lines of {widths} mm"
            )
        if self.request.options.robot is not None:
            canvas = self.layout.canvas
            notes.append(sheet_fault(self.request.options.robot, canvas.width, canvas.height) or None)
        if self.supply is not None:
            if self.request.options.strokes == AUTO:
                notes.append(f"{self.settings.strokes:,} strokes, chosen for the picture's ink")
            notes.append(self.supply.note(self.settings.strokes))
        if self.settings.one_ink:
            notes.append(self._crowded())
        return [note for note in notes if note is not None]

    def _crowded(self) -> str | None:
        """Return a sentence where so many strokes must lie much nearer each other than the hand's."""
        arrangement = self.style.arrangement
        if arrangement is None or not self.settings.arrange:
            return None
        size = arrangement.size_for(self.settings.strokes, surface_of(self.layout.room, self.layout.canvas))
        if size >= _CROWDED:
            return None
        options, times = self.request.options, size**-2
        smaller = 1 / times if options.strokes == AUTO else size  # as many more strokes as they are shorter
        return (
            f"{self.settings.strokes:,} strokes lie {times:.0f} times as densely on this sheet as the hand draws them; "
            f"a hand size of {smaller * options.hand_size:.2g} would leave them the room they have there"
        )

    def plan(self, watch: Callable[[PlanProgress], bool], resume: State | None) -> PlanResult:
        """Return the plan; a mural is planned in windows. Arguments are those of `plan`."""
        if self.mural is None:
            return plan(self.problem, self.settings, watch, resume=resume)
        return plan_mural(
            self.mural,
            self.brushes,
            self.style,
            self.settings,
            watch,
            loss_options=self.loss_options,
            network=self.network,
            resume=resume,
            device=self.device.device,
            tones=self.tones,
        )

    def painting(self, planned: PlanResult) -> Painting:
        """Return the painting that was planned, with its metrics."""
        painting = as_painting(planned, self.layout, self.brushes, self.style, self.provenance, self.names)
        arrangement = self.style.arrangement
        if arrangement is not None and self.settings.one_ink and self.settings.arrange:
            painting = painting.model_copy(update={"succession": arrangement.succession})
        return with_metrics(painting, self.layout, self.problem, self.tones)

    def weighed(self, weights: Mapping[str, float]) -> "Prepared":
        """Return the same with other weights of the terms. Raises InputError for weights that cannot be used."""
        loss_options = replace(self.loss_options, weights=weights)
        used = loss_options.weights_to_keep(has_picture=self.layout.target is not None)
        provenance = self.provenance.model_copy(update={"options": {**self.provenance.options, "weights": used}})
        problem = problem_of(
            self.layout,
            self.brushes,
            self.style,
            self.settings,
            loss_options,
            self.network,
            device=self.device.device,
            tones=self.tones,
        )
        return replace(self, loss_options=loss_options, provenance=provenance, problem=problem)


def prepare(
    request: PlanRequest, image: Image | None = None, *, brushes: tuple[Brush, ...] = (), style: Style | None = None
) -> Prepared:
    """Return what planning needs, from the files of a request.

    image: the picture, (H, W, 3), sRGB in [0, 1], where it is in memory and not in a file that the request names.
    brushes, style: replace those that the options name.
    Raises InputError for the first file that cannot be used, and for contradictions.
    """
    options, device = request.options, choose_device(request.options.device)
    whole, picture = brushes or load_brushes(options.brush), _picture(request, image)
    brushes, sheet = tuple(_held(brush, options) for brush in whole), _sheet(options, picture)
    finest = finest_of(brushes)
    margin = parse_margin(options.margin, (sheet.width, sheet.height))
    tubes = read_paints(options.paints_from) if options.paints_from is not None else ()
    if options.strokes != AUTO and len(tubes) > options.strokes:
        raise InputError.of_range("the number of paints", len(tubes), f"at most the {options.strokes} strokes")
    if options.drawing == "lines":
        if picture is None:
            raise InputError(f"{option('drawing')} lines draws those of a picture; name one, or leave it out")
        picture = lines_for(picture, sheet, finest, options.fit, margin)
    mural = _mural(options, picture, sheet, finest, margin)
    if mural is None:
        layout = lay_out_for(picture, sheet, finest, options.fit, options.px, margin)
    else:
        layout = mural.overview(LONGEST_PX)
    check_room(layout.room, brushes)
    style = (style or load_style(options.style, layout.canvas)).scaled(options.hand_size)
    settings, supply = _settings(options, tubes), None
    if settings.one_ink:
        if len(brushes) > 1:
            raise InputError(
                f"{option('brush')} {names_of(brushes)} names several, and one ink is drawn with one; name one, or "
                "paint in colours"
            )
        supply = InkSupply.of(layout, finest, style, settings.palette[0], with_lines=options.drawing == "both")
    if options.strokes == AUTO:
        settings = replace(settings, strokes=_enough(supply))
    look = read_picture(options.look, longest_px=_SHEET_PX) if options.look is not None else None
    clip_weights = {"likeness": 1.0} if options.names_clip and picture is not None else {}
    loss_options = LossOptions(options.text, look, {**clip_weights, **options.weights}, options.drawing != "tones")
    sums = {
        "Maulstick": version("maulstick"),
        "the brush": sum_of([brush.model_dump(mode="json") for brush in brushes]),
    }
    request = request.with_sums({**sums, "the style": style.hash})
    network = cache(partial(_network, options))
    tones = None if supply is None else supply.tones(settings.strokes)
    if tones is not None and tones.compressed:  # none can be spared
        settings = replace(settings, exact=True)
    problem = problem_of(layout, brushes, style, settings, loss_options, network, device=device.device, tones=tones)
    if options.names_clip and not problem.network_losses:
        clip = option("clip")
        raise InputError(f"{clip} says which network to ask, and no term asks one; leave it out, or weigh likeness")
    weights = loss_options.weights_to_keep(has_picture=picture is not None)
    used = {"brush": names_of(brushes), "style": style.name, "weights": weights, "device": device.device.type}
    name = request.picture.name if request.picture is not None else None
    sha256 = request.sums[str(request.picture)] if request.picture is not None else None
    provenance = provenance_of(settings, name, sha256, {**request.provenance_options, **used})
    names = {hex_colour(tube.colour): tube.name for tube in tubes}
    return Prepared(
        request,
        layout,
        brushes,
        style,
        settings,
        problem,
        provenance,
        names,
        mural,
        loss_options,
        network,
        device,
        supply,
        is_held=options.pressure is None
        and any(was.pressure_matters != brush.pressure_matters for was, brush in zip(whole, brushes, strict=True)),
    )


def _picture(request: PlanRequest, image: Image | None) -> Image | None:
    """Return the picture as the options correct it, or None where there is only a text or a look."""
    picture = read_picture(request.picture, longest_px=READ_PX) if request.picture is not None else image
    if picture is not None:
        return request.options.edit.applied(picture)
    for name, value in vars(request.options.edit).items():
        if value != getattr(NO_EDIT, name):
            raise InputError(f"{option(name)} corrects a picture, and there is none; name one, or leave it out")
    return None


def _held(brush: Brush, options: PlanOptions) -> Brush:
    """Return the brush, held where the options or their machine say so. Raises InputError where it leaves no mark."""
    pressure = options.held_pressure
    if pressure is None or (options.pressure is None and not brush.pressure_matters):
        return brush
    return brush.held_at(pressure)


def _mural(options: PlanOptions, picture: Image | None, sheet: Sheet, brush: Brush, margin: float) -> Mural | None:
    """Return the mural of a canvas that is too large to be planned in one piece, or None."""
    canvas = canvas_for(picture, sheet, brush, options.fit, options.px, margin)
    if max(canvas.width_px, canvas.height_px) <= LONGEST_PX:
        return None
    if picture is None or options.text is not None:
        px = option("px")
        raise InputError(f"a text is planned in one piece, of at most {LONGEST_PX} pixels; choose a smaller {px}")
    return Mural(picture, sheet, canvas, options.fit, margin)


def _settings(options: PlanOptions, tubes: tuple[NamedPaint, ...]) -> PlannerSettings:
    palette = tuple(tube.colour for tube in tubes) or (parse_colour(options.ink or "black"),)
    paints = options.mixed_paints
    strokes = MOST_AUTO if options.strokes == AUTO else options.strokes
    return PlannerSettings(
        strokes, options.exact, paints, palette, options.steps, options.ask_every, options.seed, options.arrange
    )


def _enough(supply: InkSupply | None) -> int:
    """Return the number of strokes that give the ink of a picture, at most `MOST_AUTO`."""
    if supply is None:
        raise InputError(
            f"{option('strokes')} is {AUTO}, which counts strokes of a hand for one ink; give {option('style')} and "
            f"{option('ink')}, or a number"
        )
    return min(supply.enough, MOST_AUTO)


def _sheet(options: PlanOptions, picture: Image | None) -> Sheet:
    width, height = parse_sheet(options.size, None if picture is None else picture.shape)
    if options.background is None:
        return Sheet(width=width, height=height, paper=parse_colour(options.paper))
    canvas = Canvas(width, height, min(_SHEET_PX / height, _WIDEST_SHEET_PX / width))
    photograph = canvas_photograph(options.background, canvas)
    edge = np.concatenate([photograph[0], photograph[-1], photograph[:, 0], photograph[:, -1]])
    paper = tuple(np.median(edge, axis=0).tolist())
    return Sheet(width=width, height=height, paper=paper, picture=encode_png(photograph))


def _network(options: PlanOptions) -> Network:
    if not options.names_clip and options.text is None:
        return EfficientNetLite0()
    from maulstick.planning.features.clip import Clip  # takes seconds to load

    return Clip.load(options.clip or "RN101", options.clip_weights, layers=options.clip_layers)
