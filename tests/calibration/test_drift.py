import numpy as np
import pytest

from maulstick.calibration.drift import MARGIN, Shift, sheet_place, shift_between
from maulstick.painting.raster import Canvas
from tests.support.calibration.photo_studio import CANVAS, Studio, bare, strokes
from tests.support.tolerances import MOVED, TURNED

MOVES = [(0.0, 0.0, 0.0), (0.008, 0.0, 0.0), (0.001, 0.0, 0.0), (-0.005, 0.006, 0.01)]


def _is(shift: Shift | None, move: tuple[float, float, float]) -> None:
    assert shift is not None
    assert (shift.dx, shift.dy) == pytest.approx(move[:2], abs=MOVED)
    assert shift.dtheta == pytest.approx(move[2], abs=TURNED)
    assert 0.8 < shift.confidence <= 1


@pytest.mark.parametrize("move", MOVES)
def test_a_move_of_a_blank_sheet_is_known_by_its_edges(move: tuple[float, float, float]) -> None:
    studio = Studio(bare())
    before = studio.look(MARGIN)[2]
    studio.camera.move_paper(*move)
    _is(shift_between(before, studio.look(MARGIN)[2], CANVAS), move)


def test_a_sheet_that_never_lay_quite_right_is_known_to_turn_about_its_own_middle() -> None:
    studio = Studio(bare())
    beside, move = np.array([0.003, -0.002]), np.array([0.001, 0.002])
    studio.camera.move_paper(*beside)
    before = studio.look(MARGIN)[2]
    studio.camera.move_paper(*move, 0.1)
    turn = np.array([[np.cos(0.1), -np.sin(0.1)], [np.sin(0.1), np.cos(0.1)]])
    dx, dy = move + beside - turn @ beside
    _is(shift_between(before, studio.look(MARGIN)[2], CANVAS), (dx, dy, 0.1))


def test_strokes_painted_meanwhile_do_no_harm() -> None:
    studio = Studio(strokes(1, 10))
    before = studio.look(MARGIN)[2]
    studio.sheet = np.minimum(studio.sheet, strokes(2, 10))
    studio.camera.move_paper(*MOVES[3])
    _is(shift_between(before, studio.look(MARGIN)[2], CANVAS), MOVES[3])


def test_a_stroke_as_dark_as_the_bed_along_an_edge_is_no_move_of_the_sheet() -> None:
    """It runs along the left edge, and others end in front of the right one."""
    studio = Studio(bare())
    before = studio.look(MARGIN)[2]
    wood = np.array([0.37, 0.30, 0.25], dtype=np.float32)
    studio.sheet[:, :14] = wood
    for row in range(CANVAS.height_px):
        studio.sheet[row, -20 - row % 80 :] = wood
    assert sheet_place(before, CANVAS) is not None
    assert sheet_place(studio.look(MARGIN)[2], CANVAS) is None


def test_a_knock_to_the_camera_is_no_move_of_the_sheet() -> None:
    studio = Studio(strokes(1, 10))
    before = studio.look(MARGIN)[2]
    studio.camera.bump(0.004, 0.003, 0.02)
    _is(shift_between(before, studio.look(MARGIN)[2], CANVAS), (0.0, 0.0, 0.0))


@pytest.mark.parametrize("move", MOVES[1::2])
def test_where_no_edge_is_seen_the_strokes_tell(move: tuple[float, float, float]) -> None:
    studio = Studio(strokes(1, 20))
    before = studio.look()[2]
    studio.sheet = np.minimum(studio.sheet, strokes(2, 5))
    studio.camera.move_paper(*move)
    _is(shift_between(before, studio.look()[2], CANVAS, margin=0.0), move)


def test_where_nothing_is_seen_or_everything_has_changed_the_move_is_unknown() -> None:
    studio = Studio(bare())
    blank = studio.look()[2]
    assert shift_between(blank, studio.look()[2], CANVAS, margin=0.0) is None
    studio.sheet = strokes(1, 20)
    painted = studio.look()[2]
    assert shift_between(blank, painted, CANVAS, margin=0.0) is None
    studio.sheet = strokes(2, 20)
    assert shift_between(painted, studio.look()[2], CANVAS, margin=0.0) is None
    white = np.ones((CANVAS.height_px + 60, CANVAS.width_px + 60, 3), dtype=np.float32)
    assert sheet_place(white, CANVAS) is None


def test_one_edge_that_is_not_seen_is_no_harm_and_two_are_too_many() -> None:
    studio = Studio(bare())
    studio.camera.move_paper(*MOVES[3])
    wide = studio.look(MARGIN)[2].copy()
    wide[:, -60:] = wide[:, -61:-60]
    _is(sheet_place(wide, CANVAS), MOVES[3])
    wide[:60] = wide[60:61]
    assert sheet_place(wide, CANVAS) is None


def test_the_corner_that_moved_most_counts() -> None:
    canvas = Canvas(0.3, 0.4, 1000)
    assert Shift(0.003, 0.004, 0.0, 1.0).furthest(canvas) == pytest.approx(0.005)
    assert Shift(0.0, 0.0, 0.01, 1.0).furthest(canvas) == pytest.approx(0.0025, rel=1e-4)
