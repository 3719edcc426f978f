"""The ledger: a few figures of the whole, in benchmarks/summary.json, which a later change should not worsen.

    .venv/bin/python benchmarks/summary.py [demo] [size] [hands] [brushes] [machines] [exports] [command_line] [studio]
        [--ci-minutes MINUTES]

Parts that are not named keep their figures; without a name, all are measured.

demo_seconds, demo_steps: the plan of `make demo`, without loading; step_ms: one over the other.
demo_psnr_db, demo_ssim: of its painting beside the photograph, at the truth, as `psnr` and `ssim` in `plan.py`.
ci_minutes: a whole run of .ci/run in an empty clone, after its packages were downloaded; kept from before unless given.
wheel_mb, installed_mb: the wheel, and Maulstick with all that it needs without extras, in millions of bytes.
The others are of a room each: see summary_of_rooms.py.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

from summary_of_rooms import PARTS

import maulstick as ms
from maulstick.jobs.plan.request import demo_picture

ROOT = Path(__file__).resolve().parents[1]
SUMMARY = ROOT / "benchmarks" / "summary.json"
DEMO = {"style": "loops", "brush": "marker", "strokes": 1000, "size": "160x160mm"}  # as in the Makefile
PLACES = 3  # significant digits: the rest is the machine's noise


def demo() -> dict[str, float]:
    """Plan the demo in a process that has planned a little before."""
    ms.plan(demo_picture(), **{**DEMO, "strokes": 50}, steps=20)
    steps = 0

    def count(_: Any) -> None:
        nonlocal steps
        steps += 1

    started = time.perf_counter()
    painting = ms.plan(demo_picture(), **DEMO, progress=count)
    seconds = time.perf_counter() - started
    metrics = painting.provenance.metrics
    return {
        "demo_seconds": seconds,
        "demo_steps": steps,
        "step_ms": 1e3 * seconds / steps,
        "demo_psnr_db": metrics["psnr"],
        "demo_ssim": metrics["ssim"],
    }


def size() -> dict[str, float]:
    """Weigh the wheel, and what is installed with it."""
    return {"wheel_mb": wheel_mb(), "installed_mb": installed_mb()}


def wheel_mb() -> float:
    """Build the wheel."""
    with tempfile.TemporaryDirectory() as folder:
        build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, str(ROOT)]
        subprocess.run(build, check=True)
        return sum(wheel.stat().st_size for wheel in Path(folder).glob("maulstick-*.whl")) / 1e6


def installed_mb() -> float:
    """Add up the files of Maulstick's folder and of every package that it needs without extras."""
    own = sum(file.stat().st_size for file in (ROOT / "src").rglob("*") if file.is_file())
    return (own + sum(map(_size, _needed("maulstick", {})))) / 1e6


def _needed(name: str, found: dict[str, Distribution]) -> list[Distribution]:
    for line in distribution(name).requires or []:
        needed, _, marker = line.partition(";")
        key = re.match(r"[\w.-]+", needed)
        if key is None or "extra" in marker or key[0].lower() in found:
            continue
        try:
            found[key[0].lower()] = distribution(key[0])
        except PackageNotFoundError:  # for another system
            continue
        _needed(key[0], found)
    return list(found.values())


def _size(package: Distribution) -> int:
    files = (Path(str(package.locate_file(file))) for file in package.files or [])
    return sum(file.stat().st_size for file in files if file.is_file())


def main() -> None:
    """Measure all or some parts, and write the ledger."""
    parts = {"demo": demo, "size": size, **PARTS}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(parts)}; all by default")
    parser.add_argument("--ci-minutes", type=float, help="minutes of the last whole run of .ci/run")
    asked = parser.parse_args()
    if unknown := [name for name in asked.parts if name not in parts]:
        parser.error(f"{unknown[0]} is not one of {', '.join(parts)}")
    figures = json.loads(SUMMARY.read_text()) if SUMMARY.exists() else {}
    for name in asked.parts or parts:
        figures |= {figure: _rounded(value) for figure, value in parts[name]().items()}
    if asked.ci_minutes is not None:
        figures["ci_minutes"] = _rounded(asked.ci_minutes)
    SUMMARY.write_text(json.dumps(figures, indent=2) + "\n")
    print(SUMMARY.read_text(), end="")


def _rounded(value: float) -> float:
    return value if isinstance(value, int) else float(f"{value:.{PLACES}g}")


if __name__ == "__main__":
    main()
