"""Painting by eye, with a machine that records its commands."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import MachineError
from maulstick.jobs.paint.camera_loop import paint_by_eye, revision_of
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.robot.easel import Easel
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import NOTHING, Draw, PaintLoad, Prompt
from maulstick.robot.stops import UNKNOWN, Stops
from maulstick.robot.tray import Tray
from maulstick.robot.workplace import Workplace
from maulstick.storage.arrays import Floats, Image
from maulstick.storage.files import file_sum
from tests.support.robot.mortal_painter import row_of
from tests.support.robot.recorder import EASEL, Recorder
from tests.support.robot.small_paintings import SIX
from tests.support.robot.trays import TRAY
from tests.support.tolerances import FLOAT64_METRES_NEAR

WHITE = np.ones((4, 4, 3), dtype=np.float32)


class Day:
    """A painting with its journal, a machine and a camera. events: what happened, in order."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "painting.json"
        self.events: list[str] = []
        self.robot = Recorder(before=self.events.append)
        self.lies = EASEL
        write_painting(SIX, self.path)

    def look(self) -> tuple[Image, Easel]:
        self.events.append("look")
        return WHITE, self.lies

    def again(self, painting: Painting, photograph: Image) -> Painting:
        """Give the strokes that are left new ids, as the planner does."""
        self.events.append("plan")
        free = 1 + max(stroke.id for stroke in painting.strokes)
        kept = [stroke for stroke in painting.strokes if stroke.id in self.journal.painted]
        left = [stroke for stroke in painting.strokes if stroke.id not in self.journal.painted]
        rest = [stroke.model_copy(update={"id": free + number}) for number, stroke in enumerate(left)]
        return painting.model_copy(update={"strokes": (*kept, *rest)})

    def ask(self, prompt: Prompt) -> None:
        self.events.append(prompt.message)

    def paint(
        self,
        every: int,
        tray: Tray | None = None,
        watch: Callable[[PaintProgress], None] = lambda progress: None,
        load: PaintLoad = NOTHING,
        stops: Stops | None = None,
    ) -> None:
        with Journal.open(journal_of(self.path)) as self.journal, self.robot:
            if self.journal.revision is None:
                self.journal.revise(self.path)
            plan = read_painting(self.journal.painting())
            place = Workplace(self.robot, EASEL, self.journal, self.ask, watch, tray=tray, stops=stops or Stops())
            paint_by_eye(plan, place, self.look, self.again, lambda painted: painted == every, load)

    def drawn(self) -> list[Floats]:
        """Paths on the sheet, and not those of the tray to its right."""
        return [path for what, path in self.robot.commands if what == "stroke" and path[0, 0] < 0.08]


def rows_of(paths: list[Floats]) -> list[int]:
    return sorted(row_of(path) for path in paths)


def test_it_looks_after_every_so_many_strokes_and_not_at_the_end(tmp_path: Path) -> None:
    day = Day(tmp_path)
    day.paint(2)
    events = [what for what in day.events if what in ("stroke", "look", "plan")]
    assert events == ["stroke", "stroke", "look", "plan"] * 2 + ["stroke", "stroke"]
    assert rows_of(day.drawn()) == list(range(10, 16))


def test_it_steps_aside_before_it_looks(tmp_path: Path) -> None:
    day = Day(tmp_path)
    places: list[Floats] = []
    look = day.look
    day.look = lambda: (places.append(day.robot.place), look())[1]  # type: ignore[method-assign, func-returns-value]
    day.paint(3)
    with Recorder() as other:
        assert places == [pytest.approx(other.place)]


def test_each_revision_is_on_the_disk_and_in_the_journal_before_its_first_stroke(tmp_path: Path) -> None:
    day = Day(tmp_path)
    files: list[str] = []

    def watch(progress: PaintProgress) -> None:
        if isinstance(draw := progress.action, Draw):
            revision = day.journal.revision
            assert revision is not None
            assert revision.sha256 == file_sum(tmp_path / revision.file)
            assert draw.stroke in {stroke.id for stroke in read_painting(tmp_path / revision.file).strokes}
            files.append(revision.file)

    day.paint(2, watch=watch)
    assert files == [name for name in ("painting.json", "painting.r1.json", "painting.r2.json") for _ in range(2)]
    assert revision_of(day.journal, 2) == tmp_path / "painting.r2.json"


def test_it_goes_on_where_the_sheet_now_lies_and_dips_where_the_tray_still_stands(tmp_path: Path) -> None:
    day = Day(tmp_path)
    day.lies = EASEL.shifted(0.008, -0.003, 0.02)
    day.paint(3, TRAY)
    lines = SIX.trajectories()
    there = [*lines[:3], *lines[3:]]
    expected = [easel.canvas_to_machine(line) for easel, line in zip([EASEL] * 3 + [day.lies] * 3, there, strict=True)]
    for path, place in zip(sorted_by_row(day.drawn()), expected, strict=True):
        assert min(np.abs(way[:, :2] - place[:, :2]).max() for way in (path, path[::-1])) < FLOAT64_METRES_NEAR
    visits = [path for what, path in day.robot.commands if what == "stroke" and path[0, 0] >= 0.08]
    wells = np.array([(well.x, -well.y) for well in (*TRAY.paints.values(), TRAY.water, TRAY.cloth)])
    assert len(visits) >= 5
    for path in visits:
        assert np.abs(wells - path[0, :2]).max(axis=1).min() < FLOAT64_METRES_NEAR


def sorted_by_row(paths: list[Floats]) -> list[Floats]:
    return sorted(paths, key=lambda path: -path[:, 1].mean())


def test_when_it_goes_on_it_looks_first_for_the_sheet_may_have_moved(tmp_path: Path) -> None:
    day = Day(tmp_path)

    def cut(what: str) -> None:
        day.events.append(what)
        if day.events.count("stroke") == 5:
            raise MachineError("the cable is out")

    day.robot = Recorder(before=cut)
    with pytest.raises(MachineError, match="cable"):
        day.paint(2)
    day.events, day.robot = ["stroke"] * 6, Recorder(before=cut)
    with Journal.open(journal_of(day.path)) as journal:
        assert journal.unfinished is not None
        journal.again(journal.unfinished)
    day.lies = EASEL.shifted(0.008, 0.0)
    day.paint(2)
    assert [what for what in day.events[6:] if what in ("stroke", "look", "plan")] == [
        "look",
        "plan",
        "stroke",
        "stroke",
    ]
    assert [path[:, 0].min() for path in day.drawn()] == [pytest.approx(0.018)] * 2


def test_a_replan_that_leaves_nothing_ends_it(tmp_path: Path) -> None:
    day = Day(tmp_path)

    def nothing(painting: Painting, photograph: Image) -> Painting:
        kept = tuple(stroke for stroke in painting.strokes if stroke.id in day.journal.painted)
        return painting.model_copy(update={"strokes": kept})

    day.again = nothing  # type: ignore[method-assign]
    day.paint(4)
    assert len(day.drawn()) == 4


@pytest.mark.parametrize("load", [NOTHING, UNKNOWN])
def test_a_pen_of_which_nobody_knows_how_much_it_has_drawn_is_refilled_first(tmp_path: Path, load: PaintLoad) -> None:
    day = Day(tmp_path)
    one = tuple(stroke.model_copy(update={"paint": 0}) for stroke in SIX.strokes)
    write_painting(SIX.model_copy(update={"strokes": one, "paints": SIX.paints[:1]}), day.path)
    day.paint(9, load=load, stops=Stops(metres=10.0))
    refilled = [what for what in day.events if what.startswith("refill")]
    assert len(refilled) == (load is UNKNOWN)
