"""Plan that is prepared: all that planning and its file need, and what is said of it before."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from maulstick.jobs.plan.again import Again, in_paints_of, locked_in, with_locked
from maulstick.jobs.plan.device import Choice
from maulstick.jobs.plan.options import AUTO, LEAST_HAND, MOST_AUTO
from maulstick.jobs.plan.request import PlanRequest
from maulstick.jobs.plan.window_pool import windows_at_once
from maulstick.painting.brush import Brush, names_of
from maulstick.painting.painting import Painting, Provenance
from maulstick.painting.succession import Succession
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import as_painting, problem_of, with_metrics
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.room import surface_of
from maulstick.planning.schedule import REPLAN
from maulstick.planning.state import State
from maulstick.planning.tones import InkSupply, Tones
from maulstick.robot.sheet_reach import sheet_fault
from maulstick.storage.text import counted
from maulstick.style import Style
from maulstick.style.regional import RegionalStyle

_CROWDED = 0.7  # times a hand's size, below which strokes lie more than twice as densely as the hand draws them
_NO_STROKE = 1e-9  # strokes that a picture without ink needs


@dataclass(frozen=True)
class Prepared:
    """All that planning and its file need.

    names: names of the paints by their colours as ``#rrggbb``.  mural: set where the picture is planned in windows.
    workers: processes that plan windows at the same time.
    device: what plans, and a note on it for people.  supply: of inks, in a hand.
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
                notes.append(f"{counted(self.settings.strokes, 'stroke')}, chosen for the picture's ink")
            notes.append(self.supply.note(self.strokes))
        if self.settings.in_ink:
            notes.append(self._crowded())
        if self.kept is None and self.provenance.options.get("painted_guides") is not None:
            notes.append("no guide is painted: none lies on the picture and off bare paper")
        return [note for note in notes if note is not None]

    def _crowded(self) -> str | None:
        """Return a sentence where so many strokes must lie much nearer each other than the hand's."""
        arrangement = self.problem.style.arrangement
        if arrangement is None or not self.settings.arrange:
            return None
        size = arrangement.size_for(self.settings.strokes, surface_of(self.layout.room, self.layout.canvas))
        if size >= _CROWDED:
            return None
        strokes, times, smaller = self.settings.strokes, size**-2, size
        if self.supply is not None and self.request.options.strokes == AUTO and strokes < MOST_AUTO:
            needed = self.supply.needed / self.supply.per_line  # as many more strokes as they are shorter
            smaller *= min(1.0, size * strokes / max(needed, _NO_STROKE))
        hand_size = f"{smaller * self.request.options.hand_size:.2g}"
        one = f"a hand size of {hand_size}" if float(hand_size) >= LEAST_HAND else "no hand size"
        return (
            f"{counted(strokes, 'stroke lies', 'strokes lie')} {times:.0f} times as densely on this "
            f"sheet as the hand draws them; {one} would leave them the room they have there"
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
        if self.again is not None:
            painting = in_paints_of(painting, self.again.painting)
        if self.settings.in_ink and self.settings.arrange:
            painting = painting.model_copy(update={"succession": self._succession(painting)})
        return with_metrics(painting, self.layout, self.problem, self.tones)

    def _succession(self, painting: Painting) -> Succession | None:
        """Return how the hand goes on from stroke to stroke that draws most of them; None where that is unknown."""
        style = self.problem.style
        hands = style.hands if isinstance(style, RegionalStyle) else (style,)
        drawn = Counter(stroke.style.name for stroke in painting.strokes if stroke.style is not None)
        arrangement = max(hands, key=lambda hand: drawn[hand.name]).arrangement
        return None if arrangement is None else arrangement.succession

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
