"""The table of the README, from rows that were kept."""

import json
from collections.abc import Callable

import numpy as np
from drawings import HANDS
from intervals import Floats, interval, mean
from kept import ROOT, Row, rows_of, table, with_interval, with_range
from tables_of_arrangement import above_floor, normalised
from tables_of_plans import gain_of, more_than, plans_of, steps_of

FEW_SHOT = "`benchmarks/style.py few_shot`"
BRUSHES = "`experiments/stroke_models.py --models brushes`"
SAME = "the same"


def headlines_table() -> str:
    """The figures that a reader asks for first, the less favourable ones among them."""
    lines = [*_of_plans(), _of_steps(), _of_the_renderer(), *_of_hands(), *_of_brushes(), _of_arrangement(), _of_demo()]
    return table(["", "Maulstick", "beside it", "repeat it with"], lines)


def _of_plans() -> list[list[str]]:
    rows = [row for row in rows_of("plan") if "seed" in row]
    images = list(dict.fromkeys(row["image"] for row in rows))
    ours, published = ({image: plans_of(rows, image, name) for image in images} for name in ("plan", "paper"))
    psnr = [with_range([row["psnr"] for row in plans["astronaut"]], 1) for plans in (ours, published)]
    seconds = [[row["processor_seconds"] for each in plans.values() for row in each] for plans in (ours, published)]
    gains = more_than(ours, published)
    return [
        [
            "400 strokes, 256 px, 500 steps, a portrait, three seeds",
            f"{psnr[0]} dB",
            f"the published way in 1,500 steps, on our renderer and optimiser: {psnr[1]} dB",
            "`benchmarks/plan.py astronaut`",
        ],
        [
            "the same, six photographs: how much nearer than the published way in three times the steps",
            f"{_of_groups(gains, mean)} dB",
            f"the least of the six: {min(map(mean, gains)):.1f} dB",
            "`benchmarks/plan.py`",
        ],
        [
            "the same: how long they take one processor",
            _reach(seconds[0]),
            f"the published way: {_reach(seconds[1])}",
            SAME,
        ],
    ]


def _of_steps() -> list[str]:
    found = steps_of(rows_of("steps"))
    styles = list(dict.fromkeys(style for style, *_ in found))
    ours, before = ([found[style, *version] for style in styles] for version in (("here", 500), ("before", 1500)))
    more = [more_than(*each) for each in zip(ours, before, strict=True)]
    each_more = np.concatenate([gains for of_style in more for gains in of_style])
    seconds = [np.mean([row["seconds"] for rows in plans.values() for row in rows]) for plans in ours]
    return [
        "500 steps beside the 1,500 that were usual: six photographs, three seeds",
        ", ".join(f"{style} {gain_of(each)}" for style, each in zip(styles, more, strict=True))
        + f"; {_reach(seconds)} of one processor",
        f"the worst of the {len(each_more)}: {-each_more.min():.1f} dB less",
        "`benchmarks/steps.py` ([how](docs/planning.md#steps))",
    ]


def _of_the_renderer() -> list[str]:
    row = rows_of("kernel")[0]
    return [
        f"renderer, {row['strokes']} strokes at {row['px']} px, half-width {row['half_width_px']:.0f} px, "
        "forward and backward, median of eight runs",
        f"{row['ms_forward'] + row['ms_backward']:.1f} ms",
        f"dense PyTorch, one stroke: {row['dense_ms_per_stroke']:.0f} ms",
        "`benchmarks/kernel.py`",
    ]


def _of_hands() -> list[list[str]]:
    found = {(row["kind"], row["model"]): row for row in rows_of("few_shot") if row["session"] == "all"}
    mocap, mouse, wacom = (found[kind, "exemplar"] for kind in ("mocap", "mouse", "wacom"))
    published, network, people = (found["mocap", model] for model in ("paper", "trajvae", "floor"))
    trainings = published["normalised_by_seed"]
    return [
        [
            "distance to the hand, 0 the hand, 1 other people: 5 mocap sessions",
            _within(mocap, "normalised"),
            f"the paper's recipe, the best of a sweep: {_within(published, 'normalised')}, "
            f"five trainings {min(trainings):.2f} to {max(trainings):.2f}; "
            f"in units of a stroke's length: {_within(network, 'normalised')}",
            f"{FEW_SHOT}, `benchmarks/published.py`",
        ],
        [
            "the same: 4 mouse drawings; 15 Wacom documents, chosen on",
            "; ".join(_within(row, "normalised") for row in (mouse, wacom)),
            "",
            FEW_SHOT,
        ],
        [
            "told from the hand's strokes (0.5: cannot be): mocap; mouse; Wacom",
            "; ".join(_within(row, "one_nn") for row in (mocap, mouse, wacom)),
            f"human strokes: {people['one_nn']:.2f}",
            FEW_SHOT,
        ],
    ]


def _of_brushes() -> list[list[str]]:
    ratios = [row for row in rows_of("stroke_models") if row["name"] == "extended_over_seven"]
    found = {(row["dataset"], row["metric"]): row for row in ratios}
    executed, registered = (found["sharpie", f"l1_out_of_distribution{protocol}"] for protocol in ("", "_registered"))
    painted = found["brush", "l1_out_of_distribution"]
    return [
        [
            "error of a stroke model as executed, a robot's Sharpie, strokes that bend more than those learned from",
            _error(executed, 3),
            f"the paper's seven numbers: {executed['seven']:.4f}",
            BRUSHES,
        ],
        [
            "the same, each stroke moved and inked alike first",
            _error(registered, 2),
            f"{registered['seven']:.4f}",
            SAME,
        ],
        [
            "as executed, libmypaint's brush, styles that it has not seen",
            f"{_error(painted, 2)}, in five splits {painted['splits'][0]:.2f} to {painted['splits'][1]:.2f}",
            f"{painted['seven']:.4f}",
            SAME,
        ],
    ]


def _of_arrangement() -> list[str]:
    rows = rows_of("arrangement")
    people = {(row["hand"], row["split"]): row for row in rows if row["row"] == "people"}
    figures, plans = {}, [row for row in rows if row["row"] == "arranged"]
    for name in ("arranged", "arranged_small", "held"):
        groups = [
            above_floor([row for row in rows if (row["row"], row["hand"]) == (name, hand)], people, "energy")
            for hand in HANDS
        ]
        figures[name] = _of_groups(groups, normalised)
    counts = [len({row[key] for row in plans}) for key in ("hand", "photograph", "seed")]
    return [
        "how strokes of one ink lie beside each other, 0 the hand's other half, 1 other people; "
        f"{len(plans)} plans, {counts[0]} hands, {counts[1]} photographs, {counts[2]} seeds",
        f"{figures['arranged']}; in a hand that draws smaller {figures['arranged_small']}",
        f"each placed alone: {figures['held']}",
        "`benchmarks/arrangement.py`",
    ]


def _of_demo() -> list[str]:
    ledger = json.loads((ROOT / "benchmarks" / "summary.json").read_text(encoding="utf-8"))
    return [
        f"the demo: 1,000 strokes, {ledger['demo_steps']} steps, seed 0, one run",
        f"{ledger['demo_seconds']:.0f} s; {ledger['demo_psnr_db']:.1f} dB",
        "all of the ledger: [summary.json](benchmarks/summary.json)",
        "`benchmarks/summary.py`",
    ]


def _reach(seconds: list[float]) -> str:
    return f"{min(seconds):.0f} to {max(seconds):.0f} s"


def _of_groups(groups: list[Floats], statistic: Callable[[Floats], float]) -> str:
    return with_interval(statistic(np.concatenate(groups)), interval(groups, statistic))


def _within(row: Row, key: str) -> str:
    return with_interval(row[key], row[f"{key}_interval"])


def _error(row: Row, digits: int) -> str:
    return f"{row['extended']:.4f}; ratio {with_interval(row['ratio'], row['interval'], digits)}"
