import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.mocap.plane import find_paper
from maulstick.storage.arrays import Floats
from tests.support.recording.simulated_take import RATE, SHEET, loops_and_lines, way_of
from tests.support.tolerances import PAPER_METRES

WAY = way_of(loops_and_lines(20), 3)
TIMES = np.arange(len(WAY)) / RATE


def trembling() -> Floats:
    """Heights (F,) over the paper, as smoothing leaves them."""
    white = np.random.default_rng(1).normal(0, 1, len(WAY))
    slow = np.convolve(white, np.hanning(25), "same")
    return np.asarray(-WAY[:, 2] + 0.06e-3 * slow / slow.std())


@pytest.mark.parametrize("level", [-4e-3, 0.0, 2e-3])
@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.01, -0.02)])
def test_the_paper_is_found_at_any_height_and_slope(level: float, slope: tuple[float, float]) -> None:
    plane = level + (WAY[:, :2] - np.array(SHEET) / 2) @ slope
    paper = find_paper(TIMES, WAY[:, :2], trembling() + plane, SHEET)
    over = paper.heights_over(WAY[:, :2], trembling() + plane)
    assert np.abs(over - trembling()).max() < PAPER_METRES
    assert paper.slope == pytest.approx(slope, abs=5e-4)


def test_strokes_on_one_spot_say_nothing_of_a_slope() -> None:
    places = np.tile([0.1, 0.1], (len(WAY), 1))
    paper = find_paper(TIMES, places, trembling(), SHEET)
    assert np.abs(paper.slope).max() < 1e-6
    assert abs(paper.heights_over(places[:1], np.zeros(1))[0]) < PAPER_METRES


def test_a_pen_that_was_laid_down_beside_the_sheet_does_not_count() -> None:
    aside = np.concatenate([WAY[:, :2], np.tile([0.5, 0.1], (20_000, 1))])
    heights = np.concatenate([trembling(), np.full(20_000, -0.02)])
    paper = find_paper(np.arange(len(aside)) / RATE, aside, heights, SHEET)
    assert paper.level == pytest.approx(0, abs=PAPER_METRES)


def test_a_pen_that_is_held_still_in_the_air_does_not_count() -> None:
    held = np.concatenate([WAY[:, :2], np.tile([0.1, 0.1], (2000, 1))])
    heights = np.concatenate([trembling(), np.full(2000, 0.03)])
    paper = find_paper(np.arange(len(held)) / RATE, held, heights, SHEET)
    assert paper.level == pytest.approx(0, abs=PAPER_METRES)


def test_gaps_do_not_matter() -> None:
    heights, places = trembling(), WAY[:, :2].copy()
    heights[500:700], places[500:700] = np.nan, np.nan
    assert find_paper(TIMES, places, heights, SHEET).level == pytest.approx(0, abs=PAPER_METRES)


@pytest.mark.parametrize(
    ("moved", "text"),
    [
        (
            (0, 0, 0.0254),
            r"the tip rests 25\.\d mm over the canvas; it must rest within 10 mm of it: measure the pen's",
        ),
        ((0, 0, -0.1), r"the tip rests -\d+\.\d mm over the canvas"),
        ((1, 0, 0), "the tip is never over the canvas; check the pen's length and axis, and the corner"),
    ],
)
def test_a_tip_that_is_never_at_the_paper_is_refused(moved: tuple[float, float, float], text: str) -> None:
    with pytest.raises(InputError, match=text):
        find_paper(TIMES, WAY[:, :2] + moved[:2], trembling() + moved[2], SHEET)
