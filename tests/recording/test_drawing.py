"""From simulated takes of real strokes back to the strokes (what the simulation does: see simulated_take.py)."""

from dataclasses import replace

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.mocap.contact import ContactOptions
from maulstick.recording.mocap.drawing import TakeInk, drawing_of
from maulstick.recording.mocap.frames import CORNERS
from maulstick.recording.mocap.pivot import calibrate_pivot
from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Floats
from tests.support.recording.simulated_take import (
    NONE,
    SESSIONS,
    SHEET,
    TIP,
    Faults,
    Simulated,
    distances,
    loops_and_lines,
    mocap_strokes,
    pivot_take,
    simulate,
    wacom_strokes,
    way_of,
)
from tests.support.tolerances import DRAWN_END, DRAWN_MEDIAN, DRAWN_MEDIAN_ASKED, DRAWN_P95

STROKES = loops_and_lines()


def compared(drawing: TakeInk, strokes: list[Floats]) -> tuple[Floats, Floats]:
    """Distances of all samples, and of the ends, from what was drawn: stroke for stroke, in the order drawn."""
    found = [stroke[:, 1:3] for stroke in drawing.ink.strokes()]
    assert len(found) == len(strokes)
    apart = np.concatenate([distances(*pair) for pair in zip(found, strokes, strict=True)])
    ends = [there[end] - drawn[end] for there, drawn in zip(found, strokes, strict=True) for end in (0, -1)]
    return apart, np.linalg.norm(ends, axis=1)


def is_recovered(simulated: Simulated) -> None:
    """No stroke lost, none invented, and all where they were drawn."""
    apart, ends = compared(drawing_of(simulated.take, TIP), simulated.strokes)
    assert np.median(apart) < DRAWN_MEDIAN < DRAWN_MEDIAN_ASKED
    assert np.percentile(apart, 95) < DRAWN_P95
    assert np.median(ends) < DRAWN_END


@pytest.mark.parametrize("session", SESSIONS)
def test_the_strokes_of_a_session_are_recovered(session: str) -> None:
    is_recovered(simulate(mocap_strokes(session), 1))


@pytest.mark.parametrize("name", ["elephant", "sydney_opera"])
def test_the_strokes_of_a_wacom_drawing_are_recovered(name: str) -> None:
    is_recovered(simulate(wacom_strokes(f"will/{name}.will"), 2))


@pytest.mark.parametrize("seed", range(5))
def test_made_up_strokes_are_recovered(seed: int) -> None:
    is_recovered(simulate(STROKES, seed))


@pytest.mark.parametrize("corner", range(4))
def test_the_right_angle_may_be_at_any_corner(corner: int) -> None:
    simulated = simulate(STROKES, 3, corner=corner)
    drawing = drawing_of(simulated.take, TIP, corner=CORNERS[corner])
    assert np.median(compared(drawing, simulated.strokes)[0]) < DRAWN_MEDIAN
    assert drawing.ink.size == pytest.approx(SHEET, abs=1e-4)


def test_markers_that_stand_above_the_paper_at_different_heights_do_not_matter() -> None:
    is_recovered(simulate(STROKES, 1, marker_heights=(4e-3, 2e-3, 3e-3)))


@pytest.mark.parametrize("wrong", [-2e-3, 2e-3])
def test_a_pen_length_that_is_wrong_by_2_mm_loses_and_invents_nothing(wrong: float) -> None:
    drawing = drawing_of(simulate(STROKES, 1).take, TIP + np.array([0, wrong, 0]))
    apart, _ = compared(drawing, STROKES)
    assert np.median(apart) < 1.5e-3  # the tip is then beside its place by that much times the sine of the lean


def test_a_board_that_is_pushed_between_strokes_does_not_matter() -> None:
    is_recovered(simulate(STROKES, 2, bump=0.01))


def test_a_take_without_noise_is_recovered_nearly_exactly() -> None:
    apart, ends = compared(drawing_of(simulate(STROKES, 1, NONE).take, TIP), STROKES)
    assert np.percentile(apart, 95) < 0.02e-3
    assert np.median(ends) < 0.3e-3


def test_ink_knows_its_times_and_size_and_not_its_pressure() -> None:
    simulated = simulate(STROKES, 1)
    drawing = drawing_of(replace(simulated.take, times=simulated.take.times + 100), TIP, source="take.csv")
    ink = drawing.ink
    assert ink.source == "take.csv"
    assert ink.size == pytest.approx(SHEET, abs=1e-4)
    assert np.isnan(ink.samples[:, 3]).all()
    assert 0 < ink.samples[0, 0] < 1
    assert (np.diff(ink.samples[:, 0]) > 0).all()
    assert drawing.times[0] == 0
    assert len(drawing.heights) == len(drawing.times) == len(simulated.take)


def test_each_decision_is_in_the_summary() -> None:
    take = simulate(STROKES, 1, marker_heights=(4e-3, 4e-3, 4e-3)).take
    drawing = drawing_of(take, TIP, ContactOptions(0.4e-3, merge=0.16, shortest=0.45))
    merged, dropped = len(drawing.contact.merged), len(drawing.contact.dropped)
    assert merged > 1
    assert dropped > 1
    starts = (
        f"{len(take):,} frames in {take.times[-1]:.1f} s; the pen was in the wrong place in ",
        "canvas 240.0 x 190.0 mm, with an angle of 90.0 degrees; its markers swapped names in ",
        "the tip trembled by 0.3",
        "the paper lies 4.0 mm under the plane of the markers, leaning by 0.0 degrees: is the pen's length",
        "threshold 0.40 mm over the paper, as you set it; a stroke ends above 0.80 mm",
        f"merged {merged} lifts of at most 160 ms",
        f"dropped {dropped} touches shorter than 450 ms",
        f"{len(drawing.ink)} strokes, 0.",
    )
    assert len(drawing.summary) == len(starts)
    for line, opening in zip(drawing.summary, starts, strict=True):
        assert line.startswith(opening)


def test_strokes_that_were_cut_short_and_a_threshold_that_was_proposed_are_told() -> None:
    take = simulate(STROKES, 1).take
    start = np.flatnonzero(way_of(STROKES, 1)[:, 2] == 0)[0]
    take.pen_positions[start + 20 : start + 60] = np.nan
    drawing = drawing_of(take, TIP)
    assert drawing.summary[4].startswith(f"threshold {drawing.contact.threshold * 1e3:.2f} mm over the paper, proposed")
    assert "2 strokes cut short where the pen was lost" in drawing.summary
    assert len(drawing.ink) == len(STROKES) + 1


def test_no_stroke_goes_on_over_frames_that_never_came() -> None:
    take = simulate(STROKES, 1).take
    touches = drawing_of(take, TIP).contact.touches
    (start, stop), (next_start, next_stop) = touches[:2]
    came = np.ones(len(take), dtype=bool)
    came[(start + stop) // 2 : (next_start + next_stop) // 2] = False
    drawing = drawing_of(Take(*(values[came] for values in vars(take).values())), TIP)
    assert len(drawing.ink) == len(touches)
    assert max(np.hypot(*np.diff(stroke[:, 1:3], axis=0).T).max() for stroke in drawing.ink.strokes()) < 5e-3
    assert drawing.summary[0].startswith(f"{came.sum():,} frames in ")
    assert "2 strokes cut short where the pen was lost" in drawing.summary


def test_a_stroke_that_the_take_ends_in_is_not_said_to_be_cut_by_a_pen_that_was_lost() -> None:
    take = simulate(STROKES, 1).take
    start = np.flatnonzero(way_of(STROKES, 1)[:, 2] == 0)[0]
    kept = slice(start + 60)
    ended = Take(*(values[kept] for values in vars(take).values()))
    told = drawing_of(ended, TIP).summary
    assert "1 stroke cut short where the take begins or ends" in told
    assert not any("the pen was lost" in line for line in told)


def test_touches_beside_the_canvas_are_left_out_and_counted() -> None:
    beside = [STROKES[0] + (0.3, 0), *STROKES, STROKES[1] + (0.3, 0)]
    drawing = drawing_of(simulate(beside, 1).take, TIP)
    compared(drawing, STROKES)
    assert len(drawing.beside) == 2
    assert any(line.endswith("and 2 beside the canvas") for line in drawing.summary)


def test_a_tap_of_60_ms_is_a_stroke_and_one_of_20_ms_is_none() -> None:
    def tap(milliseconds: float) -> Floats:
        return np.tile([0.1, 0.1], (round(milliseconds * 0.24), 1))

    for milliseconds, number in ((60, 3), (20, 2)):
        strokes = [STROKES[0], tap(milliseconds), STROKES[1]]
        drawing = drawing_of(simulate(strokes, 1, Faults(1e-4, 0, 0, 0, 0)).take, TIP, ContactOptions(shortest=0.06))
        assert len(drawing.ink) == number


def test_a_longer_tip_that_is_out_by_centimetres_is_refused() -> None:
    with pytest.raises(InputError, match=r"the tip rests -?\d+\.\d mm over the canvas; .* measure the pen's length"):
        drawing_of(simulate(STROKES, 1).take, TIP * 1.3)


def test_the_wrong_axis_is_refused() -> None:
    for axis in np.eye(3)[[0, 2]] * 0.139, -TIP[None]:
        for tip in axis:
            with pytest.raises(InputError, match=r"the tip (rests|is never over the canvas)"):
                drawing_of(simulate(STROKES, 1).take, tip)


def test_a_take_without_strokes_is_refused_with_what_was_seen() -> None:
    with pytest.raises(InputError) as caught:
        drawing_of(simulate(STROKES, 1).take, TIP, ContactOptions(0.3e-3, shortest=9))
    text = str(caught.value)
    assert text.startswith("no stroke was found: the tip comes down to -0.")
    assert "mm over the paper, with a threshold of 0.30 mm, 12 touches were too short and 0 beside the canvas" in text


def test_a_take_without_pen_or_canvas_is_refused() -> None:
    take = simulate(STROKES, 1).take
    with pytest.raises(InputError, match="the pen and the canvas are never seen together"):
        drawing_of(replace(take, pen_positions=take.pen_positions * np.nan, pen_markers=take.pen_markers[:, :0]), TIP)
    with pytest.raises(InputError, match="the three markers of the canvas are never seen together"):
        drawing_of(replace(take, canvas_markers=take.canvas_markers * np.nan), TIP)
    with pytest.raises(InputError, match="the pen and the canvas are never seen together for long"):
        drawing_of(replace(take, pen_rotations=take.pen_rotations * np.nan), TIP)


def test_a_pivot_take_gives_the_tip_that_a_drawing_needs() -> None:
    simulated = simulate(STROKES, 1)
    apart, _ = compared(drawing_of(simulated.take, calibrate_pivot(pivot_take(7)).tip), simulated.strokes)
    assert np.median(apart) < 2 * DRAWN_MEDIAN


@pytest.mark.parametrize("frames", [1, 2, 3, 7])
def test_a_take_of_a_few_frames_is_one_sentence(frames: int) -> None:
    take = simulate(STROKES, 1, NONE).take
    few = type(take)(*(array[:frames] for array in vars(take).values()))
    with pytest.raises(InputError) as caught:
        drawing_of(few, TIP)
    assert "\n" not in str(caught.value)
