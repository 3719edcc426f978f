"""Preparation of a plan: the files of a request are read and checked; nothing is planned yet."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version

from maulstick.colour.tubes import NamedPaint, read_paints
from maulstick.errors import InputError, option
from maulstick.jobs.plan.again import Again, locked_in, neighbours_of, with_locked
from maulstick.jobs.plan.device import Choice, choose_device
from maulstick.jobs.plan.directing import Directing
from maulstick.jobs.plan.inputs import SHEET_PX, enough, held, mural_of, network_of, picture_of, settings_of, sheet_of
from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.request import PlanRequest, sum_of
from maulstick.jobs.plan.window_pool import windows_at_once, workers_for
from maulstick.painting.brush import Brush, finest_of, load_brushes, names_of
from maulstick.painting.painting import Painting, Provenance, hex_colour
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import parse_margin
from maulstick.planning.features.network import LoadedOnce, Network
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of, with_metrics
from maulstick.planning.layout import LONGEST_PX, Layout, lay_out_for
from maulstick.planning.lines import lines_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.room import check_room, surface_of
from maulstick.planning.schedule import REPLAN
from maulstick.planning.state import State
from maulstick.planning.tones import InkSupply, Tones
from maulstick.robot.sheet_reach import sheet_fault
from maulstick.storage.arrays import Image
from maulstick.style import Style, load_style

_CROWDED = 0.7  # times a hand's size, below which strokes lie more than twice as densely as the hand draws them


@dataclass(frozen=True)
class Prepared:
    """All that planning and its file need.

    names: names of the paints by their colours as ``#rrggbb``.  mural: set where the picture is planned in windows.
    workers: processes that plan windows at the same time.
    device: what plans, and a note on it for people.  supply: of one ink, in a hand.
    is_held: whether the brush is held at one pressure since the machine only lifts its pen.
    again: what is planned again, None for a new plan.  kept: painting whose locked strokes stay among those planned.
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
    workers: int
    loss_options: LossOptions
    network: Callable[[], Network]
    device: Choice
    supply: InkSupply | None
    is_held: bool
    again: Again | None
    kept: Painting | None

    @property
    def tones(self) -> Tones | None:
        """Tones that the picture is planned in; None where any can be reached."""
        return None if self.supply is None else self.supply.tones(self.strokes)

    @property
    def strokes(self) -> int:
        """Number of strokes, at most, that the painting will have."""
        return self.settings.strokes + (0 if self.kept is None else len(locked_in(self.kept)))

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
        arrangement = self.problem.style.arrangement
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
            if self.again is not None:
                start = self.again.start(self.problem)
                return plan(self.problem, self.settings, watch, schedule=REPLAN, start=start, resume=resume)
            return plan(self.problem, self.settings, watch, resume=resume)
        with windows_at_once(self.workers) as plan_windows:
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
                plan_windows=plan_windows,
            )

    def painting(self, planned: PlanResult) -> Painting:
        """Return the painting that was planned, with its metrics."""
        painting = as_painting(
            planned,
            self.layout,
            self.brushes,
            self.problem.style,
            self.provenance,
            self.names,
            self.problem.regions,
        )
        if self.kept is not None:
            painting = with_locked(painting, locked_in(self.kept), self.kept, planned)
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
            regions=self.problem.regions,
        )
        problem = replace(problem, neighbours=self.problem.neighbours, guides=self.problem.guides)
        return replace(self, loss_options=loss_options, provenance=provenance, problem=problem)


def prepare(
    request: PlanRequest,
    image: Image | None = None,
    *,
    brushes: tuple[Brush, ...] = (),
    style: Style | None = None,
    again: Again | None = None,
) -> Prepared:
    """Return what planning needs, from the files of a request.

    image: the picture, (H, W, 3), sRGB in [0, 1], where it is in memory and not in a file that the request names.
    brushes, style, again: replace those that the options name.
    Raises InputError for the first file that cannot be used, and for contradictions.
    """
    options, device = request.options, choose_device(request.options.device)
    again, picture = again or Again.of(options), picture_of(request, image)
    sheet = sheet_of(options, picture)
    margin = parse_margin(options.margin, (sheet.width, sheet.height))
    directing = Directing(options, (sheet.height, sheet.width) if picture is None else picture.shape, margin)
    usual = brushes or load_brushes(options.brush)
    brushes, is_held = _held(directing.brushes(usual), options)
    if again is not None:
        brushes, sheet = again.brushes(brushes), again.sheet(sheet)
    finest = finest_of(brushes)
    if options.drawing == "lines":
        if picture is None:
            raise InputError(f"{option('drawing')} lines draws those of a picture; name one, or leave it out")
        picture = lines_for(picture, sheet, finest, options.fit, margin)
    mural = mural_of(options, picture, sheet, finest, margin)
    workers = workers_for(request.workers, device.device, has_windows=mural is not None)
    if mural is None:
        layout = lay_out_for(picture, sheet, finest, options.fit, options.px, margin)
    else:
        _check_windows(again, directing)
        layout = mural.overview(LONGEST_PX)
    check_room(layout.room, brushes)
    style = (style or load_style(options.style, layout.canvas)).scaled(options.hand_size)
    tubes = _tubes(options)
    settings = settings_of(options, tubes, directing.colours, directing.painted_colours)
    supply = _supply(options, settings, layout, brushes, style) if settings.one_ink else None
    if options.strokes == AUTO:
        settings = replace(settings, strokes=enough(supply))
    names = {hex_colour(tube.colour): tube.name for tube in tubes}
    if again is None:
        kept = directing.painted(layout, finest, settings.pinned or settings.palette)
    else:
        settings, names, kept = again.settings(settings), again.names, again.painting
    locked = [] if kept is None else locked_in(kept)
    tones = None if supply is None else supply.tones(settings.strokes + len(locked))
    regions = directing.regions(layout, style, brushes, usual)
    loss_options, network = _losses(options, picture), LoadedOnce(partial(network_of, options))
    problem = problem_of(
        layout,
        brushes,
        style,
        settings,
        loss_options,
        network,
        device=device.device,
        tones=tones,
        regions=regions,
    )
    problem = replace(problem, guides=directing.guides(layout, regions))
    if kept is not None:
        problem = replace(problem, neighbours=neighbours_of(locked, kept, brushes))
    if options.names_clip and not problem.network_losses:
        clip = option("clip")
        raise InputError(f"{clip} says which network to ask, and no term asks one; leave it out, or weigh likeness")
    request = request.with_sums(
        {
            "Maulstick": version("maulstick"),
            "the brush": sum_of([brush.model_dump(mode="json") for brush in brushes]),
            "the style": problem.style.hash,
        }
    )
    weights = loss_options.weights_to_keep(has_picture=picture is not None)
    used = {"brush": names_of(brushes), "style": style.name, "weights": weights, "device": device.device.type}
    name = request.picture.name if request.picture is not None else None
    sha256 = request.sums[str(request.picture)] if request.picture is not None else None
    provenance = provenance_of(settings, name, sha256, {**request.provenance_options, **used})
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
        workers,
        loss_options,
        network,
        device,
        supply,
        is_held,
        again,
        kept,
    )


def _held(brushes: tuple[Brush, ...], options: PlanOptions) -> tuple[tuple[Brush, ...], bool]:
    """Return the brushes, held where the options say so, and whether one is since its machine only lifts its pen."""
    kept = tuple(held(brush, options) for brush in brushes)
    changed = any(was.pressure_matters != now.pressure_matters for was, now in zip(brushes, kept, strict=True))
    return kept, options.pressure is None and changed


def _tubes(options: PlanOptions) -> tuple[NamedPaint, ...]:
    """Return the paints of a file. Raises InputError for more than there are strokes."""
    tubes = read_paints(options.paints_from) if options.paints_from is not None else ()
    if options.strokes != AUTO and len(tubes) > options.strokes:
        raise InputError.of_range("the number of paints", len(tubes), f"at most the {options.strokes} strokes")
    return tubes


def _losses(options: PlanOptions, picture: Image | None) -> LossOptions:
    look = read_picture(options.look, longest_px=SHEET_PX) if options.look is not None else None
    clip_weights = {"likeness": 1.0} if options.names_clip and picture is not None else {}
    return LossOptions(options.text, look, {**clip_weights, **options.weights}, options.drawing != "tones")


def _check_windows(again: Again | None, directing: Directing) -> None:
    """Raise InputError for what is not planned in windows."""
    if again is not None:
        raise InputError(f"{option('again')} plans in one piece; choose a smaller {option('px')}")
    directing.check_windows()


def _supply(
    options: PlanOptions, settings: PlannerSettings, layout: Layout, brushes: tuple[Brush, ...], style: Style
) -> InkSupply | None:
    """Return the supply of one ink. Raises InputError for several brushes."""
    if len(brushes) > 1:
        raise InputError(
            f"{option('brush')} {names_of(brushes)} names several, and one ink is drawn with one; name one, or "
            "paint in colours"
        )
    return InkSupply.of(layout, brushes[0], style, settings.palette[0], with_lines=options.drawing == "both")
