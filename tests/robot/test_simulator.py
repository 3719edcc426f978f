import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.raster import Canvas
from maulstick.robot.duration import seconds_of
from maulstick.robot.easel import Easel
from maulstick.robot.execute import execute
from maulstick.robot.journal import Journal
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import Draw, Prompt, routine
from maulstick.robot.simulated.easel import ARM, WEIGHTLESS, SimulatedEasel
from maulstick.robot.simulated.sheets import Colour, InkedSheet
from maulstick.storage.arrays import Floats, Image
from tests.support.nominal import nominal
from tests.support.robot.small_paintings import BLUE, RED, SIX, line, painting_of
from tests.support.robot.trays import TRAY
from tests.support.tolerances import FLOAT64_METRES_NEAR

PATH = np.array([[0.01, -0.01, 0.0], [0.05, -0.01, 0.0]])
STOPPING = 0.2  # seconds: what is asked for


class Notes(InkedSheet):
    """Sheet that records the strokes drawn on it."""

    def __init__(self) -> None:
        self.canvas, self.depth, self.deepest = Canvas(0.06, 0.04, 1000), 0.004, 0.004
        self.drawn: list[tuple[Floats, Colour]] = []

    def take(self, brush: Brush) -> None:
        pass

    def lay(self, picture: Image) -> None:
        pass

    def draw(self, trajectory: Floats, colour: Colour) -> None:
        self.drawn.append((trajectory, colour))

    def image(self) -> Image:
        return np.ones((40, 60, 3), dtype=np.float32)


@pytest.fixture
def sheet() -> Notes:
    return Notes()


def stroke(robot: SimulatedEasel, path: Floats = PATH, speed: float = 0.1) -> None:
    with robot:
        robot.move(np.array([*path[0, :2], 0.02]))
        robot.stroke(path, np.full(len(path), speed))
        robot.lift(0.02)


def paint(robot: SimulatedEasel, folder: Path, tray: Any = None, painting: Any = SIX) -> None:
    """Paint as maulstick paint does."""
    easel = robot.easel(0.06, 0.04)
    with Journal.open(folder / f"{len(list(folder.iterdir()))}.log.jsonl") as journal, robot:
        actions = routine(painting, easel, robot.limits, tray)

        def ask(action: Prompt) -> None:
            robot.hold(painting.paints[action.paint].colour)

        execute(actions, robot, journal, ask)


# Ink.


def test_strokes_leave_their_ink_at_their_places_in_the_colour_that_is_held(sheet: Notes, tmp_path: Path) -> None:
    paint(SimulatedEasel(sheet), tmp_path)
    assert [colour for _, colour in sheet.drawn] == [RED] * 3 + [BLUE] * 3
    for planned, (drawn, _) in zip(SIX.strokes, sheet.drawn, strict=True):
        assert np.abs(drawn[[0, -1], :2] - np.array(planned.trajectory)[[0, -1], :2]).max() < FLOAT64_METRES_NEAR


def test_pressure_is_how_deep_the_tip_is_in_the_truth(sheet: Notes) -> None:
    stroke(SimulatedEasel(sheet), PATH - (0, 0, 0.001))
    assert np.allclose(sheet.drawn[0][0][:, 2], 0.25)
    stroke(SimulatedEasel(sheet), PATH - (0, 0, 0.006))
    assert np.allclose(sheet.drawn[1][0][:, 2], 1.0)


def test_above_the_paper_nothing_is_drawn(sheet: Notes) -> None:
    stroke(SimulatedEasel(sheet), PATH + np.array([0, 0, 1e-4]))
    assert sheet.drawn == []


def test_where_a_tilted_paper_falls_away_the_tip_loses_it(sheet: Notes) -> None:
    falling = Easel(corner=(0, 0, 0.001), right=(np.cos(0.05), 0, -np.sin(0.05)), down=(0, -1, 0))
    path = np.linspace([0.01, -0.01, 0.0], [0.05, -0.01, 0.0], 41)
    stroke(SimulatedEasel(sheet, falling), path)
    ((drawn, _),) = sheet.drawn
    assert drawn[-1, 0] == pytest.approx(0.02, abs=0.0011)  # 1 mm of paper, at a slope of 5 %


def test_a_sheet_that_lies_elsewhere_than_was_told_has_its_marks_displaced(sheet: Notes, tmp_path: Path) -> None:
    paint(SimulatedEasel(sheet), tmp_path)
    elsewhere = Notes()
    robot = SimulatedEasel(elsewhere)
    robot = SimulatedEasel(elsewhere, robot.easel(0.06, 0.04).shifted(0.003, -0.002))
    paint(robot, tmp_path)
    for (there, _), (here, _) in zip(elsewhere.drawn, sheet.drawn, strict=True):
        assert np.allclose(there[:, :2] - here[:, :2], (-0.003, 0.002), atol=FLOAT64_METRES_NEAR)


def test_strokes_land_beside_their_places_by_an_offset_and_a_scatter_that_can_be_repeated(tmp_path: Path) -> None:
    def shifts(seed: int) -> Floats:
        sheet = Notes()
        rng = np.random.default_rng(seed)
        paint(SimulatedEasel(sheet, offset=(1e-3, -2e-3), scatter=1e-4, rng=rng), tmp_path)
        return np.array(
            [
                drawn[0, :2] - planned.trajectory[0][:2]
                for planned, (drawn, _) in zip(SIX.strokes, sheet.drawn, strict=True)
            ]
        )

    first = shifts(1)
    assert np.array_equal(first, shifts(1))
    assert not np.array_equal(first, shifts(2))
    assert np.abs(first - (1e-3, -2e-3)).max() < 5e-4
    assert first.std(axis=0).min() > 1e-5


def test_in_a_well_the_brush_takes_its_colour(sheet: Notes, tmp_path: Path) -> None:
    wells = [(well.x, well.y, paint.colour) for well, paint in zip(TRAY.wells_of(SIX), SIX.paints, strict=True)]
    robot = SimulatedEasel(sheet, wells=wells)
    paint(robot, tmp_path, TRAY)
    on_sheet = [colour for drawn, colour in sheet.drawn if drawn[:, 0].max() < 0.06]
    assert on_sheet == [RED] * 3 + [BLUE] * 3


# Limits and time.


def test_it_refuses_what_its_limits_do_not_allow(sheet: Notes) -> None:
    with SimulatedEasel(sheet, limits=ARM) as robot:
        for call in (
            lambda: robot.move(np.array([0.9, 0.0, 0.05])),
            lambda: robot.move(np.array([0.1, 0.0, -0.03])),
            lambda: robot.stroke(np.array([robot.place, robot.place]), np.array([0.1, 0.3])),
        ):
            with pytest.raises(InputError):
                call()
    assert sheet.drawn == []
    assert robot.seconds == 0


@pytest.mark.parametrize("limits", [ARM, WEIGHTLESS])
@pytest.mark.parametrize("tray", [None, TRAY])
def test_its_clock_agrees_with_the_estimate(sheet: Notes, tmp_path: Path, limits: Any, tray: Any) -> None:
    robot = SimulatedEasel(sheet, limits=limits)
    with robot:
        expected = seconds_of(routine(SIX, robot.easel(0.06, 0.04), limits, tray), limits, robot.place).sum()
    paint(robot, tmp_path, tray)
    assert robot.seconds == pytest.approx(expected)
    assert robot.seconds > 0.1


def test_in_real_time_it_takes_its_time(sheet: Notes) -> None:
    robot = SimulatedEasel(sheet, limits=ARM, pace=4)
    began = time.monotonic()
    stroke(robot)
    assert robot.seconds > 0.4
    assert time.monotonic() - began >= robot.seconds / 4


def test_its_sheet_has_room_below_first_touch(sheet: Notes) -> None:
    robot = SimulatedEasel(sheet, limits=ARM)
    easel = robot.easel(0.8, 0.6)
    deep = painting_of(
        [line(1, pressure=(1, 1))], [nominal("round").model_copy(update={"depth": (0, sheet.depth)})], (0.8, 0.6)
    )
    assert len([a for a in routine(deep, easel, ARM) if isinstance(a, Draw)]) == 1


# Stopping.


def is_lifted(robot: SimulatedEasel) -> bool:
    with robot:
        return bool(robot.place[2] > 0.01)


def stops_in_time(robot: SimulatedEasel, sheet: Notes, call_stop: Callable[[Callable[[], None]], None]) -> None:
    """Stop a stroke of 4 s after a while; its ink tells how far it went on."""
    came: list[float] = []
    long = np.array([[0.0, -0.01, 0.0], [0.4, -0.01, 0.0]])

    def stop() -> None:
        came.append(time.monotonic())
        robot.stop()

    with robot:
        robot.move(np.array([0.0, -0.01, 0.02]))
        call_stop(stop)
        began = time.monotonic()
        with pytest.raises(StoppedError):
            robot.stroke(long, np.full(2, 0.1))
    ((drawn, _),) = sheet.drawn
    end = float(drawn[-1, 0])
    assert 0 < end < 0.4
    begun_after = came[0] - began
    assert end <= 0.1 * (begun_after + STOPPING)
    assert is_lifted(robot)


def test_another_thread_stops_a_stroke_at_once_with_its_ink_so_far_and_the_pen_lifted(sheet: Notes) -> None:
    robot = SimulatedEasel(sheet, pace=1)
    stops_in_time(robot, sheet, lambda stop: threading.Timer(0.5, stop).start())


def test_a_signal_handler_stops_a_stroke_at_once_with_its_ink_so_far_and_the_pen_lifted(sheet: Notes) -> None:
    robot = SimulatedEasel(sheet, pace=1)

    def call_stop(stop: Callable[[], None]) -> None:
        signal.signal(signal.SIGALRM, lambda *_: stop())
        signal.setitimer(signal.ITIMER_REAL, 0.5)

    before = signal.getsignal(signal.SIGALRM)
    try:
        stops_in_time(robot, sheet, call_stop)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_after_a_stop_it_goes_on_when_it_is_entered_again(sheet: Notes) -> None:
    robot = SimulatedEasel(sheet)
    with robot:
        robot.stop()
        with pytest.raises(StoppedError):
            robot.move(np.array([0.01, -0.01, 0.02]))
    stroke(robot)
    assert len(sheet.drawn) == 1


def test_a_stop_at_any_line_of_a_stroke_neither_hangs_nor_is_missed(sheet: Notes) -> None:
    """Check a stop from a signal handler, which runs between any two lines of Python, those of waiting included."""

    def lines_until_stop(at: int) -> int:
        robot, seen, stopped = SimulatedEasel(sheet, pace=40), 0, False

        def trace(frame: FrameType, event: str, _: object) -> Any:
            nonlocal seen
            if frame.f_code.co_filename.endswith("timing.py"):
                return None  # it knows nothing of stopping
            if event == "line":
                seen += 1
                if seen == at:
                    robot.stop()
            return trace

        def work() -> None:
            nonlocal stopped
            sys.settrace(trace)
            try:
                stroke(robot)
            except StoppedError:
                stopped = True
            finally:
                sys.settrace(None)

        worker = threading.Thread(target=work, daemon=True)
        worker.start()
        worker.join(20)
        assert not worker.is_alive(), f"a stop at line {at} waits for ever"
        assert is_lifted(robot), f"after a stop at line {at} the pen is down"
        return seen

    last = lines_until_stop(0)
    for at in range(1, last, 5):
        lines_until_stop(at)
