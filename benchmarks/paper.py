"""Figures of docs/paper.md and of the tables beside it: measure them again, and write the tables that documents have.

    .venv/bin/python benchmarks/paper.py [NAME ...] [--tables]

Each NAME is a benchmark whose rows, one JSON object per line, are kept in measured/NAME.jsonl; all of them by default,
which takes hours. A file changes only when its benchmark has run to its end; measured/commits.json says with which
code. --tables measures nothing. Tables stand in README.md and docs/*.md between `<!-- measured NAME -->` and
`<!-- end -->`, and a test compares them with the files.
"""

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Callable

import tables_of_arrangement as arrangement
import tables_of_brushes as brushes
import tables_of_easel as easel
import tables_of_headlines as headlines
import tables_of_held as held
import tables_of_likeness as likeness
import tables_of_plans as plans
import tables_of_styles as styles
import tables_of_summary as summary
import tables_of_terms as terms
from kept import ROOT, commits, table

COMMANDS = {
    "plan": ["benchmarks/plan.py"],
    "horse": ["benchmarks/plan.py", "horse"],
    "faces": ["benchmarks/faces.py"],
    "removal": ["benchmarks/removal.py"],
    "few_calls": ["benchmarks/plan.py", "--objective", "network", "astronaut", "--seeds", "1"],
    "frida": ["experiments/frida_baseline.py"],
    "kernel": ["benchmarks/kernel.py"],
    "scaling": ["benchmarks/plan.py", "--scaling"],
    "large": ["benchmarks/plan.py", "--large", "--seeds", "1"],
    "startup": ["benchmarks/startup.py"],
    "step_cost": ["benchmarks/plan.py", "--step-cost"],
    "steps": ["benchmarks/steps.py"],
    "known_start": ["benchmarks/known_start.py"],
    "several_brushes": ["benchmarks/several_brushes.py"],
    "clip_size": ["benchmarks/clip_size.py"],
    "stroke_models": ["experiments/stroke_models.py", "--models", "brushes"],
    "stroke_networks": ["experiments/stroke_models.py", "--models", "networks"],
    "brush": ["benchmarks/brush.py", "fit", "photographs"],
    "published": ["benchmarks/published.py"],
    "reconstruction": ["benchmarks/style.py", "reconstruction"],
    "few_shot": ["benchmarks/style.py", "few_shot"],
    "kinds": ["benchmarks/style.py", "kinds"],
    "recognition": ["benchmarks/style.py", "recognition"],
    "plans": ["benchmarks/style.py", "plans"],
    "splines": ["benchmarks/splines.py"],
    "held": ["benchmarks/held.py"],
    "arrangement": ["benchmarks/arrangement.py"],
    "inks": ["benchmarks/inks.py"],
    "order": ["benchmarks/order.py"],
    "sim_to_real": ["experiments/sim_to_real.py"],
    "other_renderer": ["experiments/other_renderer.py"],  # last: splender may be missing
}
CODE = ("*.py", "*.cpp", "*.hpp")
MARKED = re.compile(r"(<!-- measured (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def commits_table() -> str:
    """Benchmarks, and the commit of the code that their rows were measured with."""
    lines = [[f"`{name}`", f"`{' '.join(COMMANDS[name])}`", f"`{commit}`"] for name, commit in commits().items()]
    return table(["rows", "made by", "commit"], lines)


TABLES: dict[str, Callable[[], str]] = {
    "plan": plans.plan_table,
    "likeness": plans.likeness_table,
    "horse": terms.horse_table,
    "faces": terms.faces_table,
    "removal": terms.removal_table,
    "few_calls": terms.few_calls_table,
    "frida": terms.frida_table,
    "kernel": plans.kernel_table,
    "scaling": plans.scaling_table,
    "large": plans.large_table,
    "startup": plans.startup_table,
    "step_cost": plans.step_cost_table,
    "steps": plans.steps_table,
    "known_start": plans.known_start_table,
    "several_brushes": plans.several_brushes_table,
    "clip_size": plans.clip_size_table,
    "other_renderer": plans.other_renderer_table,
    "stroke_models": brushes.stroke_models_table,
    "stroke_networks": brushes.stroke_networks_table,
    "brush": brushes.brush_table,
    "published": styles.published_table,
    "reconstruction": likeness.reconstruction_table,
    "few_shot": styles.few_shot_table,
    "kinds": likeness.kinds_table,
    "recognition": likeness.recognition_table,
    "plans": likeness.plans_table,
    "splines": styles.splines_table,
    "held": held.held_table,
    "held_elsewhere": held.held_elsewhere_table,
    "arrangement": arrangement.arrangement_table,
    "inks": arrangement.inks_table,
    "order": arrangement.order_table,
    "sim_to_real": easel.sim_to_real_table,
    "summary": summary.summary_table,
    "headlines": headlines.headlines_table,
    "commits": commits_table,
}
DOCUMENTS = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))


def filled(text: str) -> str:
    """A document with its tables as they were measured."""
    return MARKED.sub(lambda found: found[1] + TABLES[found[2]]() + found[3], text)


def measure(name: str) -> None:
    """Run a benchmark and keep its rows, and the commit of the code that it ran with."""
    commit = commit_of_code()
    ran = subprocess.run([sys.executable, *COMMANDS[name]], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if ran.returncode:
        sys.exit(f"{name} is kept as it was: its benchmark failed, see above")
    (ROOT / "measured" / f"{name}.jsonl").write_text(ran.stdout, encoding="utf-8")
    kept = json.dumps(commits() | {name: commit}, indent=2, sort_keys=True)
    (ROOT / "measured" / "commits.json").write_text(f"{kept}\n", encoding="utf-8")


def commit_of_code() -> str:
    """The commit of this checkout, with a + where its code has changed since; `unknown` where git knows of none."""
    ran = [
        subprocess.run(["git", "-C", ROOT, *asked], capture_output=True, text=True)
        for asked in (["rev-parse", "--short=7", "HEAD"], ["status", "--porcelain", "--", *CODE])
    ]
    if any(each.returncode for each in ran):
        return "unknown"
    head, changed = (each.stdout.strip() for each in ran)
    return f"{head}+" if changed else head


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
    for document in DOCUMENTS:
        document.write_text(filled(document.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
