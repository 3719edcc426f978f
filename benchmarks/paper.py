"""Figures of docs/paper.md and of the tables beside it: measure them again, and write the tables that stand in docs.

    .venv/bin/python benchmarks/paper.py [NAME ...] [--tables]

Each NAME is a benchmark whose rows, one JSON object per line, are kept in measured/NAME.jsonl; all of them by default,
which takes hours. A file changes only when its benchmark has run to its end. --tables measures nothing. Tables stand in
docs/*.md between `<!-- measured NAME -->` and `<!-- end -->`, and a test compares them with the files.
"""

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Callable
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from intervals import interval, mean

ROOT = Path(__file__).resolve().parents[1]
COMMANDS = {
    "plan": ["benchmarks/plan.py"],
    "kernel": ["benchmarks/kernel.py"],
    "stroke_models": ["experiments/stroke_models.py", "--models", "brushes"],
    "published": ["benchmarks/published.py"],
    "few_shot": ["benchmarks/style.py", "few_shot"],
    "other_renderer": ["experiments/other_renderer.py"],  # last: splender may be missing
}
MARKED = re.compile(r"(<!-- measured (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)
Row = dict[str, Any]


def rows_of(name: str) -> list[Row]:
    """The rows that were kept."""
    return [json.loads(line) for line in (ROOT / "measured" / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()]


def with_range(values: list[float], digits: int) -> str:
    """Their mean, the least and the most."""
    return f"{np.mean(values):.{digits}f} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def table(head: list[str], lines: list[list[str]]) -> str:
    """A table in Markdown."""
    return "".join(f"| {' | '.join(line)} |\n" for line in (head, ["---"] * len(head), *lines))


def plan_table() -> str:
    """Photographs planned here and in the published way, over seeds; the mean of all."""
    rows = [row for row in rows_of("plan") if "seed" in row]
    lines, gains = [], []
    for image in dict.fromkeys(row["image"] for row in rows):
        plans, published = (
            [row for row in rows if (row["image"], row["name"]) == (image, name)] for name in ("plan", "paper")
        )
        of = {(key, i): [row[key] for row in each] for i, each in enumerate((plans, published)) for key in rows[0]}
        gains.append(np.array(of["psnr", 0]) - np.array(of["psnr", 1]))
        line = [image]
        for i in (0, 1):
            line += [f"{with_range(of['psnr', i], 1)} dB", f"{np.mean(of['psnr_planned', i]):.1f} dB"]
            line += [f"{np.mean(of['ssim', i]):.2f}", f"{np.mean(of['paint_changes', i]):.0f}"]
        lines.append([*line, f"{gains[-1].mean():.1f} dB"])
    low, high = interval(gains, mean)
    head = ["photograph", "PSNR", "as planned", "SSIM", "paint changes"]
    head += ["published: PSNR", "as planned", "SSIM", "paint changes", "gain"]
    overall = f"{np.concatenate(gains).mean():.2f} ({low:.2f} to {high:.2f}) dB"
    return table(head, [*lines, ["all", *[""] * 8, overall]])


def kernel_table() -> str:
    """The renderer, forward and backward."""
    lines = []
    for row in rows_of("kernel"):
        if row["name"] != "composite":
            continue
        dense = row["dense_ms_per_stroke"]
        lines.append(
            [
                f"{row['strokes']:,}",
                f"{row['px']}²",
                f"{row['half_width_px']:.2f} px",
                f"{row['ms_forward']:.1f} + {row['ms_backward']:.1f} ms",
                "not timed" if dense is None else f"{dense:.0f} ms",
                "" if dense is None else f"{row['speedup']:,.0f}",
                f"{row['extra_mib']:.0f} MiB",
            ]
        )
    return table(
        ["strokes", "canvas", "half-width", "forward + backward", "dense, one stroke", "times faster", "extra memory"],
        lines,
    )


def stroke_models_table() -> str:
    """Errors out of distribution, as executed and registered."""
    ratios = [row for row in rows_of("stroke_models") if row["name"] == "extended_over_seven"]
    lines = []
    for dataset in dict.fromkeys(row["dataset"] for row in ratios):
        line = [dataset]
        for metric in ("l1_out_of_distribution", "l1_out_of_distribution_registered"):
            (row,) = (row for row in ratios if (row["dataset"], row["metric"]) == (dataset, metric))
            low, high = row["interval"]
            line += [f"{row['seven']:.4f}", f"{row['extended']:.4f}", f"{row['ratio']:.3f} ({low:.3f} to {high:.3f})"]
        lines.append(line)
    head = ["", "seven, as executed", "extended", "ratio", "seven, registered", "extended", "ratio"]
    return table(head, lines)


def published_table() -> str:
    """The sweep of the paper's recipe: of each row the steps of fine-tuning that serve best; means over trainings."""
    rows = [row for row in rows_of("published") if row["name"] == "sweep"]
    sessions = [key for key in rows[0] if isinstance(rows[0][key], list)]
    lines, recipe = [], ("width", "rate", "weight")
    for number, each in groupby(rows, lambda row: [row[key] for key in recipe]):
        best = min(each, key=lambda row: np.mean([row[session] for session in sessions]))
        trainings = np.mean([best[session] for session in sessions], axis=0).tolist()
        line = [*(f"{value:g}" for value in number), f"{best['steps_fine']:,}"]
        lines.append([*line, *(f"{np.mean(best[session]):.2f}" for session in sessions), with_range(trainings, 2)])
    return table(
        ["width", "rate", "weight of the KL", "steps", *sessions, "all (least, most of five trainings)"], lines
    )


def few_shot_table() -> str:
    """Likeness of twenty strokes' styles, over sessions; then session by session."""
    rows = [row | {"model": row["model"].replace("_", " ")} for row in rows_of("few_shot")]
    hands = {"mocap": "5 mocap, pure test", "mouse": "4 mouse, pure test", "wacom": "15 Wacom, chosen on"}
    lines = []
    for row in sorted((row for row in rows if row["session"] == "all"), key=lambda row: list(hands).index(row["kind"])):
        line = [hands[row["kind"]], row["model"], f"{row['energy']:.2f}"]
        for key in ("normalised", "one_nn"):
            low, high = row[f"{key}_interval"]
            line.append(f"{row[key]:.2f} ({low:.2f} to {high:.2f})")
        by_seed = row["normalised_by_seed"]
        lines.append([*line, f"{min(by_seed):.2f} to {max(by_seed):.2f}", f"{row['novelty']:.2f}"])
    head = ["sessions", "drawn by", "energy", "normalised", "1-NN", "normalised, by seed", "novelty"]
    tested = {(row["session"], row["model"]): row for row in rows if row["kind"] != "wacom" and row["session"] != "all"}
    sessions = list(dict.fromkeys(session for session, _ in tested))
    each = [
        [f"{model}: {title}", *(f"{row[key]:.2f}" if (row := tested.get((at, model))) else "" for at in sessions)]
        for model in ("exemplar", "trajvae", "paper")
        for key, title in (("normalised", "normalised"), ("one_nn", "1-NN"), ("novelty", "novelty"))
    ]
    return table(head, lines) + "\nSession by session:\n\n" + table(["", *sessions], each)


def other_renderer_table() -> str:
    """Ours and splender, forward and backward."""
    lines = []
    for row in rows_of("other_renderer"):
        line = [f"{row['strokes']}", f"{row['px']}²", f"{row['half_width_px']:.2f} px"]
        line += [f"{row['ms_ours']:.2f} ms", f"{row['ms_splender']:,.1f} ms"]
        line += [f"{row['ms_splender'] / row['ms_ours']:.0f}", f"{row['compile_s']:.0f} s"]
        lines.append(line + [f"{row[f'mean_{name}']:.4f}, {row[f'worst_{name}']:.2f}" for name in ("ours", "splender")])
    head = ["strokes", "canvas", "half-width", "ours", "splender", "times faster", "splender compiles"]
    return table([*head, "off its truth (mean, worst): ours", "splender"], lines)


TABLES: dict[str, Callable[[], str]] = {
    "plan": plan_table,
    "kernel": kernel_table,
    "stroke_models": stroke_models_table,
    "published": published_table,
    "few_shot": few_shot_table,
    "other_renderer": other_renderer_table,
}


def filled(text: str) -> str:
    """A document with its tables as they were measured."""
    return MARKED.sub(lambda found: found[1] + TABLES[found[2]]() + found[3], text)


def measure(name: str) -> None:
    """Run a benchmark and keep its rows."""
    ran = subprocess.run([sys.executable, *COMMANDS[name]], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if ran.returncode:
        sys.exit(f"{name} is kept as it was: its benchmark failed, see above")
    (ROOT / "measured" / f"{name}.jsonl").write_text(ran.stdout, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(COMMANDS)}")
    parser.add_argument("--tables", action="store_true", help="measure nothing")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in COMMANDS]:
        parser.error(f"{unknown[0]} is not one of {', '.join(COMMANDS)}")
    for name in [] if asked.tables else asked.names or COMMANDS:
        print(f"{name}: {' '.join(COMMANDS[name])}", flush=True)
        measure(name)
    for document in (ROOT / "docs").glob("*.md"):
        document.write_text(filled(document.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
