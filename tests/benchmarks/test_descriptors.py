"""Strokes among their neighbours, as numbers (benchmarks/descriptors.py)."""

from typing import Any

import numpy as np
import pytest

from tests.support.drawn import hatching, line, rotation, scattered


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
