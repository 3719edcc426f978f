"""The ledger, benchmarks/summary.json, as a table."""

import json

from kept import ROOT

MEANS = {
    "demo_seconds": ("the plan of `make demo`, without loading", "s"),
    "demo_steps": ("its steps", ""),
    "step_ms": ("one of its steps", "ms"),
    "demo_psnr_db": ("PSNR of its painting beside the photograph, at the truth", "dB"),
    "demo_ssim": ("SSIM of the same", ""),
    "ci_minutes": ("a whole run of `.ci/run` in an empty clone, once its packages are there", "minutes"),
    "wheel_mb": ("the wheel", "MB"),
    "installed_mb": ("Maulstick with all that it needs without extras", "MB"),
}


def summary_table() -> str:
    """Return the table, a row per figure; each has its meaning here."""
    figures = json.loads((ROOT / "benchmarks" / "summary.json").read_text(encoding="utf-8"))
    rows = [
        f"| `{name}` | {MEANS[name][0]} | {value:,g} {MEANS[name][1]}".rstrip() + " |"
        for name, value in figures.items()
    ]
    return "\n".join(["| figure | what it is | value |", "| --- | --- | --- |", *rows]) + "\n"
