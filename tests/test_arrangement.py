"""What the arrangement of strokes is measured with (benchmarks/arrangement.py), on drawings made for it."""

import json
import sys
from collections.abc import Generator
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.strokes.strokes import Strokes, standardise

ROOT = Path(__file__).resolve().parents[1]
MODULES = ("arrangement", "copies", "descriptors", "drawings", "judge", "kept", "succession", "tables_of_arrangement")
Floats = NDArray[np.float64]


@pytest.fixture(scope="module")
def bench() -> Generator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        yield SimpleNamespace(**{name: import_module(name) for name in MODULES})


def line(start: tuple[float, float], end: tuple[float, float]) -> Floats:
    return np.linspace(start, end, 32)


def hatching(patches: int, seed: int, spacing: float = 0.15, each: int = 8) -> Floats:
    """Patches of parallel strokes of any direction, side by side in rows of four, drawn one after another."""
    rng = np.random.default_rng(seed)
    found = []
    for patch in range(patches):
        lengths = rng.normal(1, 0.1, each)
        strokes = np.array([line((0, spacing * i), (length, spacing * i)) for i, length in enumerate(lengths)])
        strokes += rng.normal(0, 0.02, (each, 1, 2)) - strokes.mean(axis=(0, 1))
        angle, at = rng.uniform(0, 2 * np.pi), 4.5 * np.array(divmod(patch, 4))
        found.append(strokes @ rotation(angle) + at)
    return 0.02 * np.concatenate(found)


def rotation(angle: float) -> Floats:
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def scattered(count: int, seed: int) -> Floats:
    """Strokes of any direction anywhere."""
    rng = np.random.default_rng(seed)
    angles, lengths = rng.uniform(0, 2 * np.pi, count), rng.normal(1, 0.3, count).clip(0.2)
    ends = lengths[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    starts = rng.uniform(0, 8, (count, 2))
    return 0.02 * np.linspace(starts, starts + ends, 32, axis=1)


def as_strokes(paths: Floats) -> Strokes:
    standard, poses = standardise(paths)
    unknown = np.full((*paths.shape[:2], 1), np.nan)
    return Strokes(np.concatenate([standard, unknown], axis=2), unknown[..., 0], poses)


# Descriptors


def test_no_motion_and_no_scale_of_a_drawing_changes_a_number(bench: Any) -> None:
    paths = scattered(40, seed=1)
    moved = 3 * paths @ rotation(2) + np.array([5, -7])
    assert bench.descriptors.describe(moved) == pytest.approx(bench.descriptors.describe(paths), abs=1e-6)


def test_even_hatching_has_the_numbers_worked_out_by_hand(bench: Any) -> None:
    paths = np.array([line((0, 0.2 * i), (1, 0.2 * i)) for i in range(7)])
    third = dict(zip(bench.descriptors.NAMES, bench.descriptors.describe(paths)[3], strict=True))
    assert third["median gap"] == pytest.approx(np.log(0.2), abs=1e-3)
    assert third["least gap"] == pytest.approx(np.log(0.2), abs=1e-3)
    assert third["gap share"] == 0
    assert third["parallel"] == pytest.approx(1)
    assert third["oblique"] == pytest.approx(0, abs=1e-9)
    assert third["centre distance"] == pytest.approx(np.log(0.3))  # two at 0.2 and two at 0.4
    assert third["end to end"] == pytest.approx(-1)
    assert third["length ratio"] == pytest.approx(0)
    assert third["spread"] == pytest.approx(0.1 / 0.3)
    assert third["crossing"] == 0
    assert third["rank distance"] == pytest.approx(np.log(2))
    assert third["jump"] == pytest.approx(np.log(np.hypot(1, 0.2)))
    assert third["same direction"] == pytest.approx(1)
    assert third["goes on along"] == pytest.approx(-1)


def test_a_row_of_strokes_end_to_end_is_told_from_strokes_side_by_side(bench: Any) -> None:
    paths = np.array([line((1.1 * i, 0), (1.1 * i + 1, 0)) for i in range(7)])
    third = dict(zip(bench.descriptors.NAMES, bench.descriptors.describe(paths)[3], strict=True))
    assert third["end to end"] == third["goes on along"] == pytest.approx(1)
    assert third["jump"] == pytest.approx(np.log(0.1))
    assert third["least gap"] == pytest.approx(np.log(0.1))
    assert third["median gap"] == pytest.approx(np.log(0.1 + 8 / 31), abs=0.08)  # at a quarter of the stroke


def test_crossings_directions_and_near_points_are_counted_as_they_are(bench: Any) -> None:
    horizontal = line((0, 0), (1, 0))
    across = [line((x, -0.6), (x, 0.4)) for x in (0.2, 0.8)]
    beside = [line((0, y), (1, y)) for y in (0.02, 0.7)]
    first = bench.descriptors.describe(np.array([horizontal, *across, *beside]))[0]
    found = dict(zip(bench.descriptors.NAMES, first, strict=True))
    assert found["crossing"] == 2 / 4
    assert found["parallel"] == pytest.approx((-1 - 1 + 1 + 1) / 4)
    assert found["oblique"] == pytest.approx(0, abs=1e-9)
    assert found["gap share"] == 1


def test_a_bent_stroke_has_less_of_a_direction_than_a_straight_one(bench: Any) -> None:
    around = np.linspace(0, 2 * np.pi, 32)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1) / 6
    paths = np.array([circle, *(line((0, 0.3 * i), (1, 0.3 * i)) for i in range(1, 5))])
    parallel = bench.descriptors.describe(paths)[:, bench.descriptors.NAMES.index("parallel")]
    assert abs(parallel[0]) < 0.1
    assert parallel[3] > 0.7


def test_a_straightened_stroke_keeps_its_place_direction_and_extent(bench: Any) -> None:
    wave = np.stack([np.linspace(2, 4, 32), 5 + 0.1 * np.sin(np.linspace(0, 4 * np.pi, 32))], axis=1)
    [straight] = bench.descriptors.straightened(wave[None])
    [[_, axis], [start, end]] = bench.descriptors.principal(wave[None])[:2], (straight[0], straight[-1])
    assert np.abs((straight - wave.mean(axis=0)) @ (-axis[0][1], axis[0][0])) == pytest.approx(0, abs=1e-9)
    assert np.linalg.norm(end - start) == pytest.approx(2, rel=0.01)
    assert (start + end) / 2 == pytest.approx((3, 5), abs=0.02)


def test_another_order_changes_the_numbers_of_order_alone(bench: Any) -> None:
    paths, order = hatching(10, seed=2), np.random.default_rng(0).permutation(80)
    before, after = bench.descriptors.describe(paths)[order], bench.descriptors.describe(paths[order])
    known = bench.descriptors.ORDERLESS
    assert after[:, :known] == pytest.approx(before[:, :known])
    assert after[:, known].mean() > before[:, known].mean() + 1


def test_strokes_turned_about_their_centres_lose_their_directions_and_keep_their_distances(bench: Any) -> None:
    paths = hatching(10, seed=3)
    turned = bench.arrangement.turned(paths, np.random.default_rng(0).uniform(0, 2 * np.pi, len(paths)))
    before, after = (bench.descriptors.describe(each) for each in (paths, turned))
    kept = [bench.descriptors.NAMES.index(name) for name in ("centre distance", "length ratio", "spread")]
    parallel, crossing = (bench.descriptors.NAMES.index(name) for name in ("parallel", "crossing"))
    assert after[:, kept] == pytest.approx(before[:, kept])
    assert after[:, parallel].mean() < before[:, parallel].mean() - 0.5
    assert after[:, crossing].mean() > before[:, crossing].mean() + 0.2


# Copies


def test_runs_end_at_a_long_jump_and_after_ten_strokes(bench: Any) -> None:
    rows = [*range(12), *range(15, 18), 40]
    paths = np.array([line((0, 0.5 * i), (1, 0.5 * i)) for i in rows])
    assert [len(group) for group in bench.copies.groups(paths)] == [10, 2, 3, 1]


def test_a_group_moved_turned_shuffled_and_drawn_backwards_is_a_copy(bench: Any) -> None:
    learned, rng = scattered(40, seed=4), np.random.default_rng(5)
    group = learned[7:13] @ rotation(2.2) + np.array([0.3, 0.1])
    group = rng.permutation(group)
    group[::2] = group[::2, ::-1]
    close = 0.05 * np.std(group.reshape(-1, 2), axis=0).mean()
    learned, exact, shaken = (
        bench.copies.as_complex(each) for each in (learned, group, group + rng.normal(0, close, group.shape))
    )
    assert bench.copies.is_copy(exact, learned)
    assert bench.copies.is_copy(shaken, learned)


def test_a_mirrored_group_other_places_and_another_hand_are_no_copies(bench: Any) -> None:
    learned = scattered(40, seed=4)
    group = learned[7:13]
    moved = group + np.random.default_rng(6).uniform(-0.05, 0.05, (6, 1, 2))
    learned, *others = (
        bench.copies.as_complex(each) for each in (learned, group * (1, -1), moved, scattered(6, seed=7))
    )
    assert not any(bench.copies.is_copy(other, learned) for other in others)


def test_the_share_of_copied_groups_counts_groups_of_three_and_more(bench: Any) -> None:
    learned = hatching(6, seed=8)
    fan = np.array([line((0, 0), 0.02 * np.array([np.cos(angle), np.sin(angle)])) for angle in (0, 1, 2)])
    lone, shift = np.array([line((-9, -9), (-9, -8.98))]), np.array([9, 9])
    assert bench.copies.copied_share(learned, learned) == 1
    drawing = np.concatenate([learned[:8] + shift, lone, learned[8:16] - shift, 2 * lone, fan])
    assert bench.copies.copied_share(drawing, learned) == pytest.approx(2 / 3)
    assert bench.copies.copied_share(lone.repeat(2, axis=0), learned) == 0


# Order


def test_an_order_that_was_drawn_foretells_its_like_and_not_another(bench: Any) -> None:
    succession = bench.succession.Succession.of(hatching(10, seed=10))
    other = hatching(10, seed=11)
    shuffled = np.random.default_rng(0).permutation(other)
    assert succession.foretold(other) > 0.7
    assert succession.nats(other) < 1
    assert succession.nats(shuffled) > 3 * succession.nats(other)
    assert bench.succession.travel(shuffled) > 2 * bench.succession.travel(other)


def test_an_order_at_random_is_as_hard_to_foretell_as_a_choice_at_random(bench: Any) -> None:
    succession = bench.succession.Succession.of(scattered(60, seed=12))
    left = np.minimum(
        np.arange(199, 1, -1), bench.succession.CHOICES
    )  # the next, and 49 others while there are so many
    assert succession.nats(scattered(200, seed=13)) == pytest.approx(np.log(left).mean(), abs=0.3)


def test_travel_is_the_mean_way_between_strokes_in_median_lengths(bench: Any) -> None:
    paths = np.array([line((0, 0), (2, 0)), line((2, 1), (4, 1)), line((4, 4), (6, 4))])
    assert bench.succession.travel(paths) == pytest.approx((1 + 3) / 2 / 2)


# The judge


@pytest.fixture(scope="module")
def hands(bench: Any) -> dict[str, Strokes]:
    drawn = {f"hatching {i}": hatching(16, 20 + i, spacing) for i, spacing in enumerate((0.08, 0.2, 0.5))}
    return {name: as_strokes(paths) for name, paths in (drawn | {"scattered": scattered(120, 30)}).items()}


def test_each_half_is_consecutive_and_both_are_all_strokes(bench: Any) -> None:
    for split, first in enumerate((0, 40, 20, 60)):
        learned, judging = bench.drawings.halves(81, split)
        assert learned.tolist() == [(first + i) % 81 for i in range(40)]
        assert sorted([*learned, *judging]) == list(range(81))


def test_a_hands_other_half_is_near_and_other_people_are_far(bench: Any, hands: dict[str, Strokes]) -> None:
    judge = bench.judge.Judge(hands)
    found = [(hand, judge.people(hand, split)) for hand in hands for split in range(4)]
    floors = np.array([measured["energy"] for _, measured in found])
    assert floors.mean() == pytest.approx(0, abs=0.1)
    assert floors.min() < 0  # unbiased: as often below as above
    assert min(measured["others_energy"] for _, measured in found) > 10 * np.abs(floors).mean()
    assert [measured["taken_for"] for _, measured in found] == [hand for hand, _ in found]
    assert max(measured["copied_groups"] for hand, measured in found if hand == "scattered") == 0


def test_the_drawing_itself_scores_as_people_do_and_scrambled_ones_score_worse(
    bench: Any, hands: dict[str, Strokes]
) -> None:
    judge, hand = bench.judge.Judge(hands), "hatching 1"
    paths = bench.drawings.placed(hands[hand])
    angles = np.random.default_rng(0).uniform(0, 2 * np.pi, len(paths))
    itself, turned, people = (
        judge.measure(paths, hand, 0),
        *(judge.measure(bench.arrangement.turned(paths, angles), hand, 0), judge.people(hand, 0)),
    )
    for key in ("energy", "energy_judging"):
        far = people[f"others_{key}"] - people[key]
        assert itself[key] - people[key] == pytest.approx(0, abs=0.1 * far)
        assert turned[key] > people[key] + 0.3 * far
    assert itself["taken_for"] == hand
    assert itself["copied_groups"] >= 0.5


# The table


def test_quick_plans_are_among_all_plans(bench: Any) -> None:
    quick, every = (list(bench.arrangement.cases("today", short)) for short in (True, False))
    assert (len(quick), len(every), len(set(every))) == (8, 256, 256)
    assert set(quick) < set(every)
    assert not {case.hand for case in quick} & set(bench.drawings.TUNE_NOTHING)


def test_normalised_is_0_for_people_and_1_for_all_others(bench: Any) -> None:
    people = {("a", 0): {"energy": 0.25, "others_energy": 1.25}, ("a", 1): {"energy": 0.5, "others_energy": 3.5}}

    def of(*energies: float) -> float:
        rows = [{"hand": "a", "split": split, "energy": energy} for split, energy in enumerate(energies)]
        return float(
            bench.tables_of_arrangement.normalised(bench.tables_of_arrangement.above_floor(rows, people, "energy"))
        )

    assert of(0.25, 0.5) == 0
    assert of(1.25, 3.5) == 1
    assert of(0.75, 1) == pytest.approx((0.5 + 0.5) / (1 + 3))


def test_an_interrupted_table_goes_on_where_it_stopped(
    bench: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "measured").mkdir()
    monkeypatch.setattr(bench.arrangement, "drawings", lambda: dict.fromkeys(bench.drawings.HANDS))
    stops = [case for row in ("people", "today") for case in bench.arrangement.cases(row, True)][20:21]

    def measured(case: Any, judge: object) -> dict[str, object]:
        if case in stops:
            stops.remove(case)
            raise KeyboardInterrupt
        far = {"others_energy": 1.0, "others_energy_judging": 1.0} if case.row == "people" else {}
        return {"energy": 0.5, "energy_judging": 0.25, "taken_for": case.hand, **far}

    for module in (bench.arrangement, bench.kept):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(bench.arrangement, "measured", measured)
    monkeypatch.setattr(sys, "argv", ["arrangement.py", "today", "--quick"])
    with pytest.raises(KeyboardInterrupt):
        bench.arrangement.main()
    assert not stops
    before = capsys.readouterr().out
    bench.arrangement.main()
    printed = capsys.readouterr()
    rows = [json.loads(each) for each in printed.out.splitlines()]
    assert printed.out.startswith(before)
    assert len({(row["row"], row["hand"], row["split"], row["photograph"]) for row in rows}) == len(rows) == 32 + 8
    assert (tmp_path / "measured" / "arrangement.jsonl").read_text(encoding="utf-8") == printed.out
    assert "| today | 8 | 0.00 (0.00 to 0.00) |" in printed.err
