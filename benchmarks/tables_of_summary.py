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
    "hand_distance": ("from a hand learned from 20 strokes to its other strokes: 0 the hand, 1 other people", ""),
    "brush_error_ratio": (
        "error of a brush fitted to 60 strokes of acrylic, over that of the paper's seven numbers",
        "",
    ),
    "time_error_percent": ("the worst error of an estimated time beside the real Grbl's four dialogues", "%"),
    "export_ms": ("to order the gallery's boat and write it as G-code, of a processor", "ms"),
    "export_kb": ("that G-code", "kB"),
    "help_ms": ("`maulstick --help`, of a processor", "ms"),
    "studio_mb": ("memory of the studio's server after its first page", "MB"),
}


def summary_table() -> str:
    """Return the table, a row per figure; each has its meaning here."""
    figures = json.loads((ROOT / "benchmarks" / "summary.json").read_text(encoding="utf-8"))
    rows = [
        f"| `{name}` | {MEANS[name][0]} | {value:,g} {MEANS[name][1]}".rstrip() + " |"
        for name, value in figures.items()
    ]
    return "\n".join(["| figure | what it is | value |", "| --- | --- | --- |", *rows]) + "\n"
