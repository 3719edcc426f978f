"""Whether a plan is arranged as the hand arranges its strokes, as one JSON object per line.

    .venv/bin/python benchmarks/arrangement.py [ROW ...] [--quick]

Each ROW is a way to plan: `held`, the hand's strokes each placed alone, or `arranged`, as it does; or `today`, how
plans were before, which is only printed; `arranged_small`, in a hand that draws so small that as many strokes lie no
denser than in its drawing; or a control, without a photograph: `people`, the hand itself; `copied_half`,
the strokes that were learned from as they are; `scrambled_places`, with their places exchanged; `scrambled_angles`,
with angles at random; `thrown_groups`, as many strokes as a plan has, in groups of them that lie anywhere on the sheet.
All of them by default.

A style is learned from one half of a drawing, a photograph is planned in it (one ink, fineliner, 800 strokes), and the
other half judges: see `judge.py`. Eight hands, four splits into halves, four photographs, two seeds: 256 plans.
--quick: 8 plans, of four hands and two photographs, with one seed; the first photograph is planned in the first half of
each drawing, the second in its second.

Rows are kept in measured/arrangement.jsonl as they are measured, plans beside it in a folder that git ignores, and an
interrupted run goes on where it stopped. What is kept is not measured again, and all that is kept of the rows is
printed. The table of docs/styles.md goes to stderr.

`energy`, to the half that judges; `energy_judging`, by numbers that no optimised price shares; of people, the same of
all others (`others_…`).  `taken_for`: the nearest of 42 drawings, strokes straightened.  `copied_groups`: `copies.py`.
`order_nats`: `succession.py`.  `travel`: of the lifted pen to the next stroke, median lengths.  `psnr_blurred`: dB,
after a blur of 4 pixels, which are 2 mm; `psnr_tones`, the same beside the picture in the tones that the strokes can
give.  `seconds`: of one processor, planning.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import torch
from copies import groups
from drawings import HANDS, QUICK, SPLITS, Floats, drawings, halves, placed
from judge import Judge, Measured
from kept import ROOT, rows_of
from photographs import load
from tables_of_arrangement import arrangement_table

import maulstick as ms
from maulstick.ordering.sequence import sequenced
from maulstick.strokes.strokes import Strokes

PHOTOGRAPHS = ("chelsea", "astronaut", "coffee", "camera")
SEEDS = 2

CONTROLS = ("people", "copied_half", "scrambled_places", "scrambled_angles", "thrown_groups")
SMALL = "arranged_small"
PLANS: dict[str, dict[str, Any]] = {"held": {"arrange": 0.0}, "arranged": {}, SMALL: {}}
"""Ways to plan: options of a plan that differ from JOB."""
KEPT = "today"
"""Plans of the commit before strokes were held and arranged: what was measured is kept, and no newer code makes it."""
STROKES, SHEET = 800, (0.24, 0.16)
JOB = {"brush": "fineliner", "ink": "black", "strokes": STROKES, "size": "240x160mm", "px": 320, "device": "cpu"}


@dataclass(frozen=True)
class Case:
    """What a row of the table is measured on; a control has no photograph, and people have no seed."""

    row: str
    hand: str
    split: int
    photograph: str | None = None
    seed: int | None = None


def cases(row: str, *, quick: bool = False) -> Iterator[Case]:
    """All cases of a row, those first that a run may be interrupted after, or the ones that are asked for."""
    splits = range(len(SPLITS))
    if row == "people":
        yield from (Case(row, hand, split) for hand in drawings() for split in splits)
    elif row == "copied_half":
        yield from (Case(row, hand, split) for hand in HANDS for split in splits)
    elif row in CONTROLS:
        yield from (Case(row, hand, split, None, seed) for hand in HANDS for split in splits for seed in range(SEEDS))
    elif quick:
        yield from (Case(row, hand, split, PHOTOGRAPHS[split], 0) for split in (0, 1) for hand in QUICK)
    else:
        for seed in range(SEEDS):
            for photograph in PHOTOGRAPHS:
                yield from (Case(row, hand, split, photograph, seed) for split in splits for hand in HANDS)


def measured(case: Case, judge: Judge) -> Measured:
    if case.row == "people":
        return judge.people(case.hand, case.split)
    if case.row in PLANS:
        painting = planned(case)
        found = painting.provenance.metrics
        return {
            **judge.measure(sequenced(painting, (0, 0)).trajectories()[..., :2], case.hand, case.split),
            "strokes": len(painting.strokes),
            "psnr": found["psnr"],
            "psnr_blurred": -10 * float(np.log10(found["tone_mse_sigma4"])),
            "psnr_tones": found["psnr_blurred"],
            "seconds": found["seconds"],
        }
    paths = placed(learned_by(case))
    rng = np.random.default_rng(case.seed)
    if case.row == "scrambled_places":
        centres = paths.mean(axis=1, keepdims=True)
        paths = paths - centres + rng.permutation(centres)
    elif case.row == "scrambled_angles":
        paths = turned(paths, rng.uniform(0, 2 * np.pi, len(paths)))
    elif case.row == "thrown_groups":
        paths = thrown(groups(paths), rng)
    return judge.measure(paths, case.hand, case.split)


def turned(paths: Floats, angles: Floats) -> Floats:
    """Strokes (N, n, 2) turned about their centres by angles (N,)."""
    centres = paths.mean(axis=1, keepdims=True)
    turns = np.stack([np.cos(angles), np.sin(angles), -np.sin(angles), np.cos(angles)], axis=1).reshape(-1, 2, 2)
    return centres + (paths - centres) @ turns


def thrown(pieces: list[Floats], rng: np.random.Generator) -> Floats:
    """As many strokes as a plan has, in groups of (k, n, 2), with their centres anywhere on the sheet."""
    found: list[Floats] = []
    while sum(map(len, found)) < STROKES:
        group = pieces[rng.integers(len(pieces))]
        found.append(group - group.mean(axis=(0, 1)) + rng.uniform((0, 0), SHEET))
    return np.concatenate(found)[:STROKES]


def learned_by(case: Case) -> Strokes:
    strokes = drawings()[case.hand]
    return strokes[halves(len(strokes), case.split)[0]]


def planned(case: Case) -> ms.Painting:
    """The plan of a case, made unless it is kept."""
    name = "-".join(str(part) for part in asdict(case).values())
    path = ROOT / "measured" / "arrangement" / f"{name}.json"
    if not path.exists():
        assert case.photograph is not None
        style = ms.fit_style(learned_by(case), case.hand.lower())
        options = JOB | PLANS[case.row]
        if case.row == SMALL and style.arrangement is not None:
            options["hand_size"] = style.arrangement.size_for(STROKES, SHEET[0] * SHEET[1])
        started = time.process_time()
        painting = ms.plan(load(case.photograph), style=style, seed=case.seed, **options)
        painting.provenance.metrics["seconds"] = time.process_time() - started
        path.parent.mkdir(exist_ok=True)
        painting.save(path)
    return ms.read_painting(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [*CONTROLS, KEPT, *PLANS]
    parser.add_argument("rows", nargs="*", metavar="ROW", help=f"of {', '.join(names)}")
    parser.add_argument("--quick", action="store_true", help="8 plans of each way instead of 256")
    asked = parser.parse_args()
    if unknown := [row for row in asked.rows if row not in names]:
        parser.error(f"there is no row {unknown[0]}; there are: {', '.join(names)}")
    rows = list(dict.fromkeys(["people", *asked.rows])) if asked.rows else names  # all is compared with people
    torch.set_num_threads(1)
    path, judge = ROOT / "measured" / "arrangement.jsonl", Judge(drawings())
    kept = {
        Case(**{field.name: row[field.name] for field in fields(Case)}): row
        for row in (rows_of("arrangement") if path.exists() else [])
    }
    wanted = [case for row in rows if row != KEPT for case in cases(row, quick=asked.quick)]
    for case in kept:
        if case.row in rows:
            print(json.dumps(kept[case]))
    for case in wanted:
        if case not in kept:
            found = {key: round(x, 4) if isinstance(x, float) else x for key, x in measured(case, judge).items()}
            line = json.dumps(asdict(case) | found)
            with path.open("a", encoding="utf-8") as file:
                file.write(line + "\n")
            print(line, flush=True)
    print(arrangement_table(), file=sys.stderr)


if __name__ == "__main__":
    main()
