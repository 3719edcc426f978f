"""The judge of whole drawings, and the table (benchmarks/judge.py, benchmarks/arrangement.py)."""

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from maulstick.strokes.strokes import Strokes
from tests.support.drawn import as_strokes, hatching, scattered


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


def test_one_half_judges_and_copies_are_sought_in_the_other(bench: Any, hands: dict[str, Strokes]) -> None:
    changing = np.concatenate([hatching(8, seed=40), scattered(64, seed=41) + np.array([1, 0])])
    judge = bench.judge.Judge(hands | {"changing": as_strokes(changing)})
    later, earlier = (judge.measure(scattered(64, seed=42), "changing", split) for split in (0, 1))
    assert later["energy"] < 0.2 * earlier["energy"]
    assert later["order_nats"] < earlier["order_nats"]
    [of_learned, of_judging] = (judge.measure(half, "changing", 1) for half in (changing[64:], changing[:64]))
    assert (of_learned["copied_groups"], of_judging["copied_groups"]) == (1, 0)


def test_quick_plans_are_among_all_plans(bench: Any) -> None:
    quick, every = (list(bench.arrangement.cases("arranged", quick=quick)) for quick in (True, False))
    assert (len(quick), len(every), len(set(every))) == (8, 256, 256)
    assert set(quick) < set(every)
    assert {case.hand for case in every} == set(bench.drawings.HANDS)
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


def test_seconds_are_those_of_the_last_seed(bench: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = {"energy": 0.5, "energy_judging": 0.25, "taken_for": "lia", "hand": "lia", "split": 0}
    people = figures | {"row": "people", "seed": None, "others_energy": 1.0, "others_energy_judging": 1.0}
    plans = [figures | {"row": "held", "seed": seed, "seconds": 10.0 * (seed + 1)} for seed in (0, 1, 1)]
    monkeypatch.setattr(bench.tables_of_arrangement, "rows_of", lambda name: [people, *plans])
    held = next(line for line in bench.tables_of_arrangement.arrangement_table().splitlines() if "| held | 3 |" in line)
    assert held.endswith("| 20 s |")


def test_an_interrupted_table_goes_on_where_it_stopped(
    bench: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "measured").mkdir()
    monkeypatch.setattr(bench.arrangement, "drawings", lambda: dict.fromkeys(bench.drawings.HANDS))
    stops = [case for row in ("people", "held") for case in bench.arrangement.cases(row, quick=True)][20:21]

    def measured(case: Any, judge: object) -> dict[str, object]:
        if case in stops:
            stops.remove(case)
            raise KeyboardInterrupt
        far = {"others_energy": 1.0, "others_energy_judging": 1.0} if case.row == "people" else {}
        return {"energy": 0.5, "energy_judging": 0.25, "taken_for": case.hand, **far}

    for module in (bench.arrangement, bench.kept):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(bench.arrangement, "measured", measured)
    monkeypatch.setattr(sys, "argv", ["arrangement.py", "held", "--quick"])
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
    assert "| held | 8 | 0.00 (0.00 to 0.00) |" in printed.err


def test_plans_of_today_are_printed_and_never_made_again(
    bench: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "measured").mkdir()
    monkeypatch.setattr(bench.arrangement, "drawings", lambda: dict.fromkeys(bench.drawings.HANDS))
    [kept, *_] = bench.arrangement.cases("today", quick=True)
    figures = {"energy": 0.5, "energy_judging": 0.25, "taken_for": kept.hand}
    people = [
        asdict(case) | figures | {"others_energy": 1.0, "others_energy_judging": 1.0}
        for case in bench.arrangement.cases("people", quick=True)
    ]
    lines = [json.dumps(row) for row in [*people, asdict(kept) | figures]]
    (tmp_path / "measured" / "arrangement.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
    for module in (bench.arrangement, bench.kept):
        monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(sys, "argv", ["arrangement.py", "today", "--quick"])
    bench.arrangement.main()
    assert capsys.readouterr().out.splitlines() == lines
