from collections.abc import Callable
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.ordering.sequence import sequenced
from maulstick.painting import painting as paintings
from maulstick.painting.brush import Brush
from maulstick.painting.fields import Point
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.raster import Canvas
from maulstick.painting.succession import Succession
from maulstick.rendering.preview import preview
from tests.support.tolerances import CREASED, MARK_METRES, SAME_PICTURE

HOME = (0.0, 0.0)
SIDE = 0.1
CANVAS = Canvas(SIDE, SIDE, 1000)
COLOURS = ((0.0, 0.0, 0.0), (0.8, 0.1, 0.2), (0.1, 0.3, 0.9))
# Wide and soft, so that pixels show its marks as they are: hard edges are drawn broader than they are.
SOFT = Brush(name="soft", source="for tests", alpha=0.002, beta=0.004, opacity=0.7, nib=(0.2, 0.1))
PEN = Brush(name="pen", source="for tests", alpha=0.0, beta=0.0005)
HATCHER = Succession(jump=-1.0, distance=-1.0, along=-2.0, parallel=3.0, same_way=3.0, unlike=-1.0)


def _painting(strokes: list[tuple[int, tuple[Point, ...]]], brush: Brush = PEN) -> Painting:
    """Strokes of (paint, trajectory), whose ids run backwards."""
    return Painting(
        sheet=Sheet(width=SIDE, height=SIDE),
        provenance=Provenance(version="0"),
        brushes={brush.name: brush},
        paints=tuple(Paint(colour=colour, brush=brush.name) for colour in COLOURS),
        strokes=tuple(
            Stroke(id=len(strokes) - i, paint=paint, trajectory=trajectory)
            for i, (paint, trajectory) in enumerate(strokes)
        ),
    )


def _line(x: float, y: float, to_x: float, to_y: float, pressure: float = 0.5) -> tuple[Point, ...]:
    return tuple((x + t * (to_x - x), y + t * (to_y - y), pressure) for t in (0.0, 0.5, 1.0))


def _order(painting: Painting) -> list[int]:
    return [stroke.id for stroke in painting.strokes]


def _travel(painting: Painting) -> float:
    ends = painting.trajectories()[:, [0, -1], :2]
    return float(np.linalg.norm(ends[1:, 0] - ends[:-1, 1], axis=1).sum())


def _random(count: int, rng: np.random.Generator, brush: Brush, length: float = 0.03) -> Painting:
    def stroke() -> tuple[Point, ...]:
        points = int(rng.integers(1, 6))
        places = 0.02 + 0.06 * rng.random(2) + length * np.cumsum(rng.random((points, 2)) - 0.5, axis=0)
        places = places.clip(0, SIDE)
        pressure = np.full(points, rng.random()) if rng.random() < 0.5 else rng.random(points)
        return tuple((x, y, p) for (x, y), p in zip(places.tolist(), pressure.tolist(), strict=True))

    return _painting([(int(rng.integers(len(COLOURS))), stroke()) for _ in range(count)], brush)


def _paintings(brush: Brush) -> st.SearchStrategy[Painting]:
    """Paintings whose hand is unknown, and of a hand whose order is known."""
    seeds = st.integers(0, 10**6).map(np.random.default_rng)
    unknown = st.builds(_random, st.integers(0, 30), seeds, st.just(brush))
    return unknown | unknown.map(lambda painting: painting.model_copy(update={"succession": HATCHER}))


@given(_paintings(SOFT))
@settings(max_examples=30, deadline=None, derandomize=True)  # of very many paintings one has a few creased pixels more
def test_the_painting_looks_the_same(painting: Painting) -> None:
    drawn = sequenced(painting, HOME)
    own = {stroke.id: stroke for stroke in painting.strokes}
    turned_back = drawn.model_copy(update={"strokes": tuple(own[stroke.id] for stroke in drawn.strokes)})
    before, reordered, after = (preview(each, CANVAS) for each in (painting, turned_back, drawn))
    assert np.abs(reordered - before).max() < SAME_PICTURE
    differs = np.abs(after - before).max(axis=2) >= SAME_PICTURE
    assert differs.mean() < CREASED, "backwards, a pixel may be nearer to the other of two steps that are as near"


@given(_paintings(SOFT) | _paintings(PEN))
@settings(max_examples=30, deadline=None)
def test_the_strokes_are_the_same_but_for_their_direction(painting: Painting) -> None:
    strokes = {stroke.id: stroke for stroke in painting.strokes}
    after = sequenced(painting, HOME)
    assert sorted(_order(after)) == sorted(strokes)
    assert after.model_copy(update={"strokes": ()}) == painting.model_copy(update={"strokes": ()})
    for stroke in after.strokes:
        was = strokes[stroke.id]
        assert stroke.model_copy(update={"trajectory": was.trajectory}) == was
        assert stroke.trajectory in (was.trajectory, was.trajectory[::-1])


@given(_paintings(SOFT) | _paintings(PEN))
@settings(max_examples=30, deadline=None)
def test_paint_is_never_changed_more_often_than_before(painting: Painting) -> None:
    assert sequenced(painting, HOME).paint_changes() <= painting.paint_changes()


def test_strokes_apart_are_painted_a_paint_at_a_time() -> None:
    painting = _painting([(i % 2, _line(0.01 * i, 0.01, 0.01 * i, 0.02)) for i in range(1, 9)])
    assert painting.paint_changes() == 7
    assert sequenced(painting, HOME).paint_changes() == 1


def test_a_painting_of_several_parts_is_ordered_as_if_it_were_one(monkeypatch: pytest.MonkeyPatch) -> None:
    for brush in (SOFT, PEN):
        painting = _random(40, np.random.default_rng(3), brush)
        whole = sequenced(painting, HOME)
        with monkeypatch.context() as patch:
            patch.setattr(paintings, "_MOST_POINTS", 8)
            assert len(list(painting.parts())) > 10
            assert sequenced(painting, HOME) == whole


def test_what_lies_over_another_paint_stays_over_it() -> None:
    over = [(0, _line(0.02, 0.05, 0.08, 0.05)), (1, _line(0.05, 0.02, 0.05, 0.08)), (0, _line(0.04, 0.04, 0.06, 0.06))]
    assert _order(sequenced(_painting(over), HOME)) == [3, 2, 1]


@pytest.mark.parametrize(
    ("brush", "apart"),
    [
        (PEN, 0.0009),
        (PEN.model_copy(update={"nib": (0.0, 0.5)}), 0.0014),
        (PEN.model_copy(update={"alpha": 0.002}), 0.0029),
        (PEN.model_copy(update={"m_y": 0.5}), 0.0009),
    ],
)
def test_marks_that_touch_keep_their_order_though_their_paths_do_not(brush: Brush, apart: float) -> None:
    first, second = _line(0.02, 0.05, 0.08, 0.05), _line(0.02, 0.05 + apart, 0.08, 0.05 + apart)
    again = _line(0.02, 0.05 - apart, 0.08, 0.05 - apart)
    painting = _painting([(0, first), (1, second), (0, again), (1, first)], brush)
    ids = _order(sequenced(painting, HOME))
    assert ids.index(4) < ids.index(3)
    assert ids.index(2) < ids.index(1)


def test_paths_that_cross_do_not_bind_where_their_marks_lie_apart() -> None:
    shifted = PEN.model_copy(update={"name": "shifted", "b_x": 0.02})
    both = _painting([(i % 2, _line(0.05, 0.02, 0.05, 0.08)) for i in range(4)])
    paints = (both.paints[0], both.paints[1].model_copy(update={"brush": "shifted"}))
    apart = both.model_copy(update={"paints": paints, "brushes": {**both.brushes, "shifted": shifted}})
    assert sequenced(both, HOME).paint_changes() == 3
    assert sequenced(apart, HOME).paint_changes() == 1


def test_the_pen_goes_to_what_is_near() -> None:
    painting = _random(60, np.random.default_rng(0), PEN, length=0.01)
    one_ink = painting.model_copy(
        update={"strokes": tuple(s.model_copy(update={"paint": 0}) for s in painting.strokes)}
    )
    assert _travel(sequenced(one_ink, HOME)) < 0.3 * _travel(one_ink)


def test_a_known_hand_goes_out_of_its_way_to_draw_as_it_does() -> None:
    painting = _painting([(0, _line(0.01 * i, 0.01, 0.01 * i, 0.03)) for i in range(1, 10)])
    quick, by_hand = (sequenced(painting.model_copy(update={"succession": hand}), HOME) for hand in (None, HATCHER))
    assert [sum(s.trajectory[0] < s.trajectory[-1] for s in each.strokes) for each in (quick, by_hand)] == [5, 9]
    assert _travel(quick) < _travel(by_hand) < 3 * _travel(quick)


def test_a_stroke_of_many_points_changes_nothing_of_the_order_in_which_a_hand_draws_others() -> None:
    rng = np.random.default_rng(0)
    lines = [_line(*ends) for ends in (0.02 + 0.06 * rng.random((40, 4))).tolist()]
    (x, y, _), _, (to_x, to_y, _) = lines[0]
    shares = np.linspace(0, 1, 100).tolist()
    dense = tuple((x + t * (to_x - x), y + t * (to_y - y), 0.5) for t in shares)
    sparse, mixed = (_painting([(0, each) for each in (first, *lines[1:])]) for first in (lines[0], dense))
    orders = [_order(sequenced(each.model_copy(update={"succession": HATCHER}), HOME)) for each in (sparse, mixed)]
    assert orders[0] == orders[1]


def test_the_first_stroke_is_near_the_pen_and_the_next_run_near_the_last_stroke() -> None:
    rows = [
        (paint, _line(x, 0.01 + 0.02 * paint, x + 0.005, 0.01 + 0.02 * paint))
        for x in (0.01, 0.05, 0.09)
        for paint in (0, 1)
    ]
    xs = [stroke.trajectory[0][0] for stroke in sequenced(_painting(rows), (0.1, 0.01)).strokes]
    assert xs == pytest.approx([0.095, 0.055, 0.015, 0.01, 0.05, 0.09])


def _zigzag(pressure: Callable[[float], float] = lambda x: 0.5) -> tuple[Point, ...]:
    """Path from far to near, seen from home, and a little up."""
    return tuple(
        (x, round((0.05 if i % 2 else 0.06) + 0.1 * x, 6), pressure(x))
        for i, x in enumerate((0.09, 0.08, 0.07, 0.06, 0.05, 0.04, 0.03, 0.02, 0.01))
    )


@pytest.mark.parametrize(
    ("numbers", "turned"),
    [
        ({}, True),
        ({"alpha": 0.001, "b_x": 0.001, "b_y": -0.002, "nib": (0.3, 0.2), "faint": 0.3}, True),
        ({"m_x": 1.01}, False),
        ({"m_y": 1.01}, False),
        ({"lag": 0.001}, False),
        ({"touch": (0.001, 0.0)}, False),
    ],
)
def test_a_stroke_is_turned_around_only_where_its_mark_stays(numbers: dict[str, object], turned: bool) -> None:
    trajectory = _zigzag()
    brush = PEN.model_copy(update=numbers)
    drawn = sequenced(_painting([(0, trajectory)], brush), HOME).strokes[0].trajectory
    assert drawn == (trajectory[::-1] if turned else trajectory)
    marks = [brush.mark(np.array(path)[:, :2]) for path in (trajectory, drawn)]
    nearest = [[np.linalg.norm(one - point, axis=1).min() for point in other] for one, other in combinations(marks, 2)]
    assert np.max(nearest) < MARK_METRES


def test_a_stroke_with_a_hands_pressure_or_speed_keeps_its_direction() -> None:
    pressed = _painting([(0, _zigzag(lambda x: x))])
    even = _painting([(0, _zigzag())])
    hasty = even.strokes[0].model_copy(update={"speed": (0.1,) * 9})
    assert sequenced(pressed, HOME) == pressed
    assert sequenced(even.model_copy(update={"strokes": (hasty,)}), HOME).strokes == (hasty,)


def test_a_painting_without_strokes_stays_without() -> None:
    assert sequenced(_painting([]), HOME) == _painting([])


def test_dots_are_put_in_order_too() -> None:
    dots = _painting([(i % 2, ((x, 0.05, 0.5),)) for i, x in enumerate((0.09, 0.01, 0.05, 0.03))])
    assert _order(sequenced(dots, HOME)) == [2, 4, 1, 3]


def test_a_dot_upon_a_dot_of_another_paint_stays_there() -> None:
    dots = _painting([(i % 3, ((0.05, 0.05, 0.5),)) for i in (0, 2, 1, 0, 2)])
    assert _order(sequenced(dots, HOME)) == _order(dots)
