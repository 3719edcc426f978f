import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.distance import cdist
from scipy.stats import ks_2samp

from maulstick.strokes.strokes import path_lengths, place, standardise
from maulstick.style import compare
from maulstick.style.compare import (
    CURVINESS,
    Comparison,
    describe,
    distance_to_nearest,
    energy_distance,
    kolmogorov_smirnov,
    nearest_neighbour_accuracy,
)
from tests.support.style.synthetic_hands import arc, circle, drawn, line, zigzag
from tests.support.tolerances import DESCRIPTION

PATHS = np.concatenate([drawn(one, 8) for one in (circle, zigzag, arc)])
LENGTH, CHORD, TURNING, TURN, WIDTH, HEIGHT, ROUGHNESS, INFLECTIONS = 0, 1, 2, 3, 4, 5, 12, 13
PARTS, PLACES = slice(6, 12), slice(14, 24)


def of(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The description (24,) of one path."""
    return describe(np.stack([x, y], axis=1)[None])[0]


@settings(max_examples=30)
@given(st.floats(-4, 4), st.floats(-1, 1), st.floats(-1, 1))
def test_a_description_is_the_same_wherever_and_however_a_stroke_lies(angle: float, dx: float, dy: float) -> None:
    poses = np.broadcast_to([dx, dy, angle], (len(PATHS), 3))
    assert describe(place(PATHS, poses)) == pytest.approx(describe(PATHS), abs=DESCRIPTION)


@settings(max_examples=30)
@given(st.floats(1e-3, 1e3))
def test_only_the_length_of_a_description_depends_on_size(size: float) -> None:
    apart = describe(size * PATHS) - describe(PATHS)
    assert apart[:, LENGTH] == pytest.approx(np.log(size), abs=DESCRIPTION)
    assert apart[:, 1:] == pytest.approx(0, abs=DESCRIPTION)


def test_a_straight_stroke_is_described_by_hand() -> None:
    found = of(np.linspace(0, 0.05, 32), np.zeros(32))
    assert found[LENGTH] == pytest.approx(np.log(0.05))
    assert found[[CHORD, WIDTH]] == pytest.approx(1)
    assert found[[TURNING, TURN, HEIGHT, INFLECTIONS]] == pytest.approx(0, abs=DESCRIPTION)
    assert found[PARTS] == pytest.approx(0, abs=DESCRIPTION)
    places = found[PLACES].reshape(5, 2)
    assert places[:, 0] == pytest.approx(np.array([5, 10, 16, 21, 26]) / 31)
    assert places[:, 1] == pytest.approx(0)


def test_half_a_circle_is_described_by_hand() -> None:
    angle = np.linspace(0, np.pi, 32)
    found = of(1 - np.cos(angle), np.sin(angle))
    assert found[CHORD] == pytest.approx(2 / np.pi, rel=1e-3)
    assert found[[WIDTH, HEIGHT]] == pytest.approx([2 / np.pi, 1 / np.pi], rel=3e-3)
    turn = np.pi * 30 / 31  # between its 31 pieces
    assert found[[TURNING, TURN]] == pytest.approx([turn, -turn])
    assert found[PARTS] == pytest.approx(-turn / 6)
    assert found[ROUGHNESS] == pytest.approx(np.log(np.pi / 31**2), abs=0.01)
    assert found[INFLECTIONS] == 0


def test_a_wave_changes_its_turning_as_often_as_it_swings() -> None:
    x = np.linspace(0, 1, 32)
    found = of(x, 0.1 * np.sin(4 * np.pi * x))
    assert found[INFLECTIONS] == pytest.approx(3 / 29)
    assert abs(found[TURN]) < 0.2
    assert found[TURNING] > 3
    ripple = of(x, 1e-4 * np.sin(20 * np.pi * x))
    assert ripple[INFLECTIONS] == 0, "nearly straight is straight"


def test_a_mirrored_stroke_turns_the_other_way() -> None:
    one, two = describe(PATHS), describe(PATHS * (1, -1))
    same = [LENGTH, CHORD, TURNING, WIDTH, HEIGHT, ROUGHNESS, INFLECTIONS]
    assert two[:, same] == pytest.approx(one[:, same], abs=DESCRIPTION)
    assert two[:, TURN] == pytest.approx(-one[:, TURN], abs=DESCRIPTION)
    assert two[:, PARTS] == pytest.approx(-one[:, PARTS], abs=DESCRIPTION)


def test_curviness_tells_trembling_from_smooth_and_bent_from_straight() -> None:
    bend, rough, wavy = (describe(drawn(line, 40, tremor=0.01))[:, i].mean() for i in CURVINESS)
    smooth_bend, smooth, even = (describe(drawn(line, 40, tremor=0.0))[:, i].mean() for i in CURVINESS)
    assert (rough - smooth > 1, wavy > even, bend > smooth_bend) == (True, True, True)
    assert describe(drawn(circle, 40, tremor=0.0))[:, CURVINESS[0]].mean() > smooth_bend + 3


def test_a_stroke_of_no_length_has_a_description() -> None:
    found = of(np.full(32, 0.1), np.full(32, 0.2))
    assert np.isfinite(found).all()


def test_no_strokes_have_no_descriptions() -> None:
    assert describe(np.zeros((0, 32, 2))).shape == (0, 24)


def clouds(n: int, m: int, shift: float = 0.0, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, 3)), rng.normal(size=(m, 3)) + shift


def test_energy_distance_is_the_sum_over_all_pairs() -> None:
    a, b = clouds(7, 11, 0.5)
    between = np.mean([np.linalg.norm(x - y) for x in a for y in b])
    within = [
        np.mean([np.linalg.norm(x - y) for i, x in enumerate(c) for j, y in enumerate(c) if i != j]) for c in (a, b)
    ]
    assert energy_distance(a, b) == pytest.approx(2 * between - sum(within))
    assert energy_distance(b, a) == pytest.approx(energy_distance(a, b))


def test_energy_distance_is_as_often_below_as_above_0_for_the_same_distribution() -> None:
    found = np.array([energy_distance(*clouds(20, 30, seed=seed)) for seed in range(400)])
    assert abs(found.mean()) < 3 * found.std() / 20
    assert 0.4 < (found < 0).mean() < 0.75, "its distribution has a tail to the right"
    assert found.std() < 0.1


def test_energy_distance_grows_with_how_far_apart_two_are() -> None:
    found = [energy_distance(*clouds(200, 200, shift)) for shift in (0.0, 0.3, 1.0, 5.0)]
    assert found == sorted(found)
    assert found[0] < 0.03
    assert found[3] > 10


def test_nearest_neighbours_cannot_tell_the_same_distribution_and_always_tell_another() -> None:
    rng = np.random.default_rng(0)
    alike = [nearest_neighbour_accuracy(*clouds(100, 60, seed=seed), rng, rounds=3) for seed in range(30)]
    assert np.mean(alike) == pytest.approx(0.5, abs=0.03)
    assert nearest_neighbour_accuracy(*clouds(100, 60, 50.0), rng) == 1.0


def test_nearest_neighbours_repeat_with_their_chance() -> None:
    a, b = clouds(90, 30, 0.7)
    one, two = (nearest_neighbour_accuracy(a, b, np.random.default_rng(3)) for _ in range(2))
    assert one == two
    assert 0.5 < one < 0.95


def test_a_copy_is_nearer_than_its_own_kind_to_all_of_its_neighbours() -> None:
    a, _ = clouds(50, 0)
    assert nearest_neighbour_accuracy(a, a + 1e-9, np.random.default_rng(0)) < 0.02


def test_the_distance_to_the_nearest_is_0_for_copies_and_grows_with_what_is_new() -> None:
    a, b = clouds(40, 30)
    expected = np.mean([min(np.linalg.norm(x - y) for y in b) for x in a])
    assert distance_to_nearest(a, b) == pytest.approx(expected)
    assert distance_to_nearest(a[:5], a) == 0
    assert distance_to_nearest(a + 10, b) > 10


@pytest.mark.parametrize("decimals", [0, 9], ids=["ties", "no ties"])
def test_the_distance_of_two_distributions_is_the_one_that_scipy_finds(decimals: int) -> None:
    rng = np.random.default_rng(0)
    for apart, size in ((0.0, 7), (0.5, 60), (9.0, 200)):
        a, b = rng.normal(0, 1, 90).round(decimals), rng.normal(apart, 1, size).round(decimals)
        assert kolmogorov_smirnov(a, b) == pytest.approx(ks_2samp(a, b).statistic)


def test_a_comparison_says_what_the_second_hand_does_otherwise() -> None:
    circles, lines = drawn(circle, 20), drawn(line, 20)
    apart = Comparison.of(circles, lines, np.random.default_rng(0))
    assert apart.distance > 1 > apart.of_halves
    assert (apart.shared, apart.accuracy) == (0, 1)
    assert "bend less" in apart.told
    assert "bend more" in Comparison.of(lines, circles, np.random.default_rng(0)).told


def test_a_comparison_says_how_many_strokes_are_both_hands() -> None:
    strokes = drawn(circle, 20)
    for first, second, shared in (
        (strokes, strokes, 1),
        (strokes[:10], strokes, 1 / 2),
        (strokes[:10], strokes[5:15], 1 / 3),
    ):
        assert Comparison.of(first, second, np.random.default_rng(0)).shared == pytest.approx(shared)


def test_of_very_many_strokes_some_are_compared_with_much_the_same_result(monkeypatch: pytest.MonkeyPatch) -> None:
    circles, zigzags = drawn(circle, 400), drawn(zigzag, 400)
    of_all = Comparison.of(circles, zigzags, np.random.default_rng(0))
    monkeypatch.setattr(compare, "_MOST", 100)
    sizes = []
    monkeypatch.setattr(compare, "cdist", lambda a, b: sizes.append(max(len(a), len(b))) or cdist(a, b))
    of_some = Comparison.of(circles, zigzags, np.random.default_rng(0))
    assert max(sizes) == 200, "both hands of the nearest neighbours"
    assert of_some.distance == pytest.approx(of_all.distance, rel=0.1)
    assert of_some.told.partition(",")[0] == of_all.told.partition(",")[0]


def test_a_ratio_of_lengths_is_told_in_plain_figures() -> None:
    strokes = drawn(circle, 20)
    assert Comparison.of(strokes, 123 * strokes, np.random.default_rng(0)).told == "are 120 times as long"
    assert Comparison.of(strokes, 0.0456 * strokes, np.random.default_rng(0)).told == "are 0.046 times as long"


def test_a_length_that_rounding_hides_is_not_told_of() -> None:
    strokes = drawn(circle, 20)
    strokes *= 0.03 / path_lengths(strokes)[:, None, None]
    told = Comparison.of(strokes, 1.001 * strokes, np.random.default_rng(0)).told
    assert told == "are as long, as bent and as rough"


def test_strokes_that_are_as_long_and_as_bent_are_told_of_as_such() -> None:
    same = Comparison.of(drawn(circle, 40, seed=1), drawn(circle, 40, seed=2), np.random.default_rng(0))
    assert same.told == "are as long, as bent and as rough"
    assert abs(same.distance) < 1


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_ruled_lines_of_two_lengths_differ_in_length_alone(kind: type) -> None:
    rng = np.random.default_rng(0)

    def ruled(shortest: float) -> np.ndarray:
        ends = rng.uniform(shortest, 2 * shortest, 40)[:, None] * np.exp(1j * rng.uniform(0, 2 * np.pi, (40, 1)))
        along = (0.1 + 0.1j) + ends * np.linspace(0, 1, 32)
        return standardise(np.stack([along.real, along.imag], axis=-1))[0].astype(kind).astype(np.float64)

    told = Comparison.of(ruled(0.01), ruled(0.02), rng).told
    assert told.endswith(" times as long")
    assert "bend" not in told
