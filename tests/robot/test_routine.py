from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting
from maulstick.painting.refined import refined
from maulstick.robot.duration import drawn_metres, seconds_of
from maulstick.robot.easel import Easel
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Action, Draw, PaintLoad, Prompt, TrayVisit, routine
from maulstick.robot.tray import Well
from tests.support.nominal import nominal
from tests.support.robot.recorder import EASEL, LIMITS
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.robot.trays import TRAY

LIFTS = LIMITS.model_copy(update={"varies_pressure": False, "lifting": 0.2})
ROUND = nominal("round")
HARD = ROUND.model_copy(update={"depth": (0.001, 0.009)})


def in_short(actions: Sequence[Action]) -> list[str]:
    """Return the actions in short: ids of strokes, visits with their paints, and prompts."""
    names = []
    for action in actions:
        match action:
            case Draw(stroke=stroke):
                names.append(str(stroke))
            case TrayVisit(what=what, paint=paint):
                names.append(f"{what} {paint}")
            case Prompt(message=message):
                names.append(message)
    return names


def refused(painting: Painting, easel: Easel = EASEL, limits: Limits = LIMITS, **options: Any) -> str:
    with pytest.raises(InputError) as caught:
        routine(painting, easel, limits, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def draws(actions: Sequence[Action]) -> list[Draw]:
    return [action for action in actions if isinstance(action, Draw)]


# What does not fit is refused, with what and by how much.


def test_a_stroke_outside_the_workspace_is_refused_with_by_how_much_and_how_many_more() -> None:
    strokes = [line(1), line(2, (0.19, 0.01), (0.21, 0.01)), line(3, (0.01, 0.25), (0.02, 0.25))]
    assert refused(painting_of(strokes, size=(0.3, 0.3))) == (
        "stroke 2: the machine's x is 210 mm; it must be -100 to 200 mm: 10 mm less far (and 1 more like it); "
        "lay the sheet elsewhere, plan for a smaller one, or turn or scale an SVG with rotate or size"
    )


def test_a_well_outside_the_workspace_is_refused() -> None:
    far = TRAY.model_copy(update={"water": Well(x=0.25, y=0, height=0)})
    said = refused(SIX, tray=far)
    assert said.startswith(
        "the rinse for paint 1: the machine's x is 253 mm; it must be -100 to 200 mm: 53 mm less far"
    )
    told = "give the tray's file another place for that well, or a lower clearance, or lay sheet and tray elsewhere"
    assert said.endswith(f"; {told}")


def test_a_clearance_above_the_workspace_is_refused() -> None:
    high = TRAY.model_copy(update={"clearance": 0.11})
    assert "the machine's z is 110 mm; it must be -20 to 100 mm: 10 mm less far" in refused(SIX, tray=high)


def test_a_stroke_that_is_too_fast_is_refused_with_the_option_that_slows_it_down() -> None:
    fast = painting_of([line(4, speed=0.35)])
    assert refused(fast) == (
        "stroke 4 is drawn at 350 mm/s, and the machine's fastest is 200; slow all strokes down with speed=0.2"
    )
    assert draws(routine(fast, EASEL, LIMITS, speed=0.2))[0].motion.speed.max() == 0.2


@pytest.mark.parametrize("speed", [0.0, -0.1, np.nan])
def test_a_speed_that_is_none_is_refused(speed: float) -> None:
    assert refused(SIX, speed=speed).endswith("mm/s; it must be above 0")


def test_a_speed_beyond_the_machines_is_the_machines() -> None:
    (fast,) = routine(painting_of([line(1)]), EASEL, LIMITS, speed=2 * LIMITS.speed)
    assert isinstance(fast, Draw)
    assert fast.motion.speed.max() == LIMITS.speed


def test_pressure_that_varies_is_refused_where_the_machine_only_lifts_with_the_option_that_plans_it_again() -> None:
    soft = painting_of([line(1), line(2, pressure=(0.2, 0.7))])
    assert refused(soft, limits=LIFTS) == (
        "stroke 2 varies its pressure by 0.50, and this machine only lifts its pen; plan it again with pressure=0.5"
    )


def test_strokes_of_unlike_pressures_are_refused_where_the_machine_only_lifts_unless_each_brush_has_one() -> None:
    light, deep = line(1, pressure=(0.1, 0.1)), line(2, paint=1, pressure=(1, 1))
    assert refused(painting_of([light, deep]), limits=LIFTS) == (
        "stroke 2 has another pressure than those before, and this machine only lifts its pen; "
        "plan it again with pressure=0.5"
    )
    two = painting_of([light, deep], [nominal("marker"), nominal("round")])
    assert [draw.stroke for draw in draws(routine(two, EASEL, LIFTS))] == [1, 2]


def test_pressure_that_changes_no_mark_is_no_matter_for_a_machine_that_only_lifts() -> None:
    pens = painting_of([line(1, pressure=(0.2, 0.7))], [nominal("fineliner")])
    assert in_short(routine(pens, EASEL, LIFTS)) == ["1"]
    assert np.all(draws(routine(pens, EASEL, LIFTS))[0].motion.path[:, 2] == 0)


def test_a_brush_that_needs_more_depth_than_the_easel_allows_is_refused_with_by_how_much() -> None:
    assert refused(painting_of([line(1)], [HARD])) == (
        "the brush round is pressed 9 mm deep, and the easel allows 8 mm: 1 mm less; calibrate the touch again, or the "
        "brush for this easel"
    )


def test_a_brush_is_refused_with_how_to_measure_the_depth_where_no_easel_was_measured() -> None:
    assert refused(painting_of([line(1)], [HARD]), EASEL.model_copy(update={"deepest": 0.0})) == (
        "the brush round is pressed 9 mm deep, and no easel says how deep it may be; measure that with maulstick "
        "calibrate touch, or where a servo lifts the pen, set it up with maulstick machine"
    )


def test_a_brush_that_no_stroke_left_needs_is_not_refused() -> None:
    two = painting_of([line(1), line(2, paint=1)], [nominal("marker"), HARD])
    assert in_short(routine(two, EASEL, LIMITS, done={2}))[-1] == "1"
    assert "9 mm deep" in refused(two, done={1})


def test_a_depth_that_nobody_knows_is_refused_where_pressure_matters() -> None:
    flat = EASEL.model_copy(update={"deepest": 0.0})
    said = refused(painting_of([line(1)], [nominal("marker")]), flat)
    assert said == "neither the brush marker nor the easel says how deep it may be pressed; calibrate the touch again"
    assert in_short(routine(painting_of([line(1)], [nominal("fineliner")]), flat, LIMITS)) == ["1"]


def test_paper_that_is_tilted_too_far_is_refused() -> None:
    tilted = Easel(corner=(0, 0, 0), right=(np.cos(0.2), 0, np.sin(0.2)), down=(0, -1, 0), deepest=0.008)
    assert refused(SIX, tilted) == "the paper is tilted by 11 degrees; it must be at most 5.7: lay it flatter"


def test_a_tray_without_a_paint_is_refused() -> None:
    assert "no well for the paint #1a33b2" in refused(
        SIX, tray=TRAY.model_copy(update={"paints": {"#cc1a1a": TRAY.water}})
    )


def test_a_well_on_the_sheet_is_refused() -> None:
    """The tip would be lowered through the painting."""
    on_it = TRAY.model_copy(update={"water": Well(x=0.03, y=0.02, height=-0.004, radius=2e-3)})
    assert refused(SIX, tray=on_it) == (
        "the water of the tray is on the sheet of 60 x 40 mm, at x 30 and y 20 mm; move it beside the sheet"
    )
    on_its_rim = {**TRAY.paints, "#1a33b2": Well(x=0.03, y=-0.002, height=0.0)}
    assert "the well of #1a33b2 of the tray is on" in refused(SIX, tray=TRAY.model_copy(update={"paints": on_its_rim}))


def test_wells_that_overlap_are_refused() -> None:
    same = {**TRAY.paints, "#1a33b2": TRAY.paints["#cc1a1a"]}
    assert refused(SIX, tray=TRAY.model_copy(update={"paints": same})) == (
        "the well of #cc1a1a and the well of #1a33b2 of the tray are 0 mm apart, and the tip turns within 3 and 3 mm; "
        "move one, or make its radius smaller"
    )
    near = TRAY.model_copy(update={"cloth": Well(x=0.12, y=0.004, height=0)})
    assert "the water and the cloth of the tray are 4 mm apart" in refused(SIX, tray=near)


def test_wells_that_are_not_visited_may_be_anywhere() -> None:
    nowhere = Well(x=0.03, y=0.02, height=0)
    one_paint = painting_of([line(1)])
    tray = TRAY.model_copy(update={"water": nowhere, "cloth": nowhere})
    assert any(isinstance(action, TrayVisit) for action in routine(one_paint, EASEL, LIMITS, tray))


# Depth is in metres: the brush's own where it was fitted with some, or the easel's.


def depths(brush: Brush, easel: Easel = EASEL, pressure: tuple[float, float] = (0.0, 1.0)) -> list[float]:
    path = draws(routine(painting_of([line(1, pressure=pressure)], [brush]), easel, LIMITS))[0].motion.path
    return (-easel.machine_to_canvas(path)[[0, -1], 2]).tolist()


def test_pressure_is_the_depth_that_the_brush_was_fitted_with() -> None:
    assert depths(ROUND.model_copy(update={"depth": (0.001, 0.005)})) == pytest.approx([0.001, 0.005])


def test_pressure_is_a_share_of_the_easels_depth_where_the_brush_knows_none() -> None:
    assert depths(nominal("marker"), EASEL.model_copy(update={"deepest": 0.002})) == pytest.approx([0, 0.002])


def test_a_pen_of_unknown_depth_is_pressed_lightly_also_where_a_broad_brush_goes_deep() -> None:
    assert depths(nominal("fineliner"), EASEL) == pytest.approx([0.0005, 0.0005])
    assert depths(nominal("fineliner"), EASEL.model_copy(update={"deepest": 0.0004})) == pytest.approx([0.0002] * 2)


def test_a_brush_held_at_a_pressure_is_held_at_its_depth() -> None:
    assert depths(ROUND.held_at(0.5)) == pytest.approx([0.004, 0.004])


# Paint care.


def test_pens_are_changed_by_a_person_and_one_pen_is_not_asked_for() -> None:
    assert in_short(routine(SIX, EASEL, LIMITS)) == [
        "put in the marker with the paint #cc1a1a", "10", "11", "12",
        "put in the marker with the paint #1a33b2", "13", "14", "15",
    ]  # fmt: skip
    assert in_short(routine(painting_of([line(1), line(2)]), EASEL, LIMITS)) == ["1", "2"]


def test_a_pen_that_is_in_the_hand_is_not_asked_for_again() -> None:
    left = routine(SIX, EASEL, LIMITS, done={10, 11, 12, 13}, load=PaintLoad(1, 0.02))
    assert in_short(left) == ["14", "15"]


def test_a_brush_is_dipped_first_then_before_it_would_run_dry_and_is_cleaned_before_another_paint() -> None:
    # 5, 10, 15 mm of red; 20, 25, 30 mm of blue; 40 mm per dip
    assert in_short(routine(SIX, EASEL, LIMITS, TRAY)) == [
        "dip 0", "10", "11", "12", "rinse 1", "wipe 1", "dip 1", "13", "dip 1", "14", "dip 1", "15",
    ]  # fmt: skip
    thirsty = TRAY.model_copy(update={"reach": 0.004})
    assert in_short(routine(painting_of(SIX.strokes[:2]), EASEL, LIMITS, thirsty)) == ["dip 0", "10", "dip 0", "11"]


def test_what_the_hand_has_painted_counts() -> None:
    assert in_short(routine(SIX, EASEL, LIMITS, TRAY, done={10, 11, 12, 13}, load=PaintLoad(1, 0.01))) == [
        "14",
        "dip 1",
        "15",
    ]
    assert in_short(routine(SIX, EASEL, LIMITS, TRAY, done={10, 11, 12, 13}, load=PaintLoad(1, 0.02)))[0] == "dip 1"


def test_a_brush_that_somebody_left_halfway_is_cleaned_before_it_is_dipped() -> None:
    assert in_short(routine(SIX, EASEL, LIMITS, TRAY, done={10, 11})) == in_short(
        routine(SIX, EASEL, LIMITS, TRAY, done={10, 11}, load=PaintLoad(1))
    )
    assert in_short(routine(SIX, EASEL, LIMITS, TRAY, done={10, 11}))[:3] == ["rinse 0", "wipe 0", "dip 0"]


def test_with_a_tray_a_person_changes_the_brush_where_paints_need_different_ones() -> None:
    two = painting_of(SIX.strokes, [nominal("marker"), ROUND])
    assert in_short(routine(two, EASEL, LIMITS, TRAY)) == [
        "put in the marker, clean", "dip 0", "10", "11", "12",
        "put in the round, clean", "dip 1", "13", "dip 1", "14", "dip 1", "15",
    ]  # fmt: skip


def test_strokes_that_are_done_are_left_out() -> None:
    assert in_short(routine(SIX, EASEL, LIMITS, done=[10, 12, 14, 99])) == [
        "put in the marker with the paint #cc1a1a", "11", "put in the marker with the paint #1a33b2", "13", "15",
    ]  # fmt: skip
    assert routine(SIX, EASEL, LIMITS, done=range(10, 16)) == []


def test_the_metres_are_those_of_the_strokes_alone() -> None:
    assert drawn_metres(routine(SIX, EASEL, LIMITS, TRAY)) == pytest.approx(0.105)


def test_where_a_stroke_ends_and_begins_the_tip_is_right_above() -> None:
    for action in draws(routine(SIX, EASEL, LIMITS)):
        assert np.array_equal(action.motion.start[:2], action.motion.path[0, :2])
        assert (action.motion.above, action.motion.after) == pytest.approx((0.005, 0.005))


BOW = line(4, points=3).model_copy(
    update={"trajectory": ((0.01, 0.01, 0.2), (0.03, 0.02, 0.8), (0.05, 0.01, 0.4)), "speed": (0.05, 0.1, 0.02)}
)


def test_a_machine_follows_a_stroke_refined_through_all_its_points() -> None:
    (draw,) = draws(routine(painting_of([BOW]), EASEL, LIMITS))
    (finer,) = refined(painting_of([BOW])).strokes
    assert EASEL.machine_to_canvas(draw.motion.path)[:, :2] == pytest.approx(np.array(finer.trajectory)[:, :2])
    assert draw.motion.speed == pytest.approx(np.array(finer.speed))
    for point in BOW.trajectory:
        assert np.abs(np.array(finer.trajectory) - point).max(axis=1).min() == 0
    assert len(draw.motion.path) > len(BOW.trajectory)


def test_what_is_left_of_a_painting_is_driven_as_it_would_have_been_from_the_beginning() -> None:
    strokes = [line(1), BOW, line(3, (0.01, 0.03), (0.03, 0.03))]
    whole, left = (draws(routine(painting_of(strokes), EASEL, LIMITS, done=done)) for done in ((), (1,)))
    assert [draw.stroke for draw in left] == [4, 3]
    for one, other in zip(whole[1:], left, strict=True):
        assert one.motion.path == pytest.approx(other.motion.path, abs=1e-12)
        assert one.motion.speed == pytest.approx(other.motion.speed, abs=1e-12)


def test_a_point_that_is_repeated_is_sent_once() -> None:
    stroke = line(1).model_copy(update={"trajectory": ((0.01, 0.01, 0.5),) * 3 + ((0.02, 0.01, 0.5),) * 2})
    assert len(draws(routine(painting_of([stroke]), EASEL, LIMITS))[0].motion.path) == 2


# Time.


def test_time_is_counted_for_ways_strokes_and_lifting() -> None:
    easy = LIFTS.model_copy(update={"speed": 0.1, "acceleration": 1e6, "lifting": 0.2})
    one = painting_of([line(1, (0.0, 0.01), (0.05, 0.01), points=2)])
    seconds = seconds_of(routine(one, EASEL, easy), easy, np.array([0.1, -0.01, 0.1]))
    assert seconds == pytest.approx([0.1 / 0.1 + 0.05 / 0.1 + 2 * 0.2], rel=1e-3)


def test_a_person_takes_no_time() -> None:
    actions = routine(SIX, EASEL, LIMITS)
    seconds = seconds_of(actions, LIMITS, np.array([0, 0, 0.05]))
    assert [second == 0 for second in seconds] == [isinstance(action, Prompt) for action in actions]
