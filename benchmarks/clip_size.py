"""How long a plan takes with a network of CLIP's size: one JSON object per line.

    .venv/bin/python benchmarks/clip_size.py [MODEL ...]

The weights are random: time does not depend on them, and CLIP's own cannot be had everywhere. What is planned is of no
worth, so that no likeness is told.

model: as open_clip names it.  parameters: of what sees pictures, in millions.
strokes, px: as published plans are made; px is the height of the planner's canvas.
ask_every: steps between two evaluations of the network; 1 is the published way.
steps: that were planned.  step_ms: of each of them after the first.
minutes: that 2,000 steps, as published, would take at that rate, with the command's start and end.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import open_clip
import torch

MODELS = ("RN101",)
STROKES, PX = 400, 256


def seconds_of(model: str, weights: Path, ask_every: int, steps: int) -> float:
    """Return how long the command takes."""
    with tempfile.TemporaryDirectory() as out:
        words = ["plan", "--demo", "--strokes", STROKES, "--steps", steps, "--px", PX, "--ask-every", ask_every]
        words += ["--weight", "likeness=1", "--clip", model, "--clip-weights", weights, "--out", Path(out) / "plan"]
        started = time.perf_counter()
        subprocess.run([Path(sys.executable).with_name("maulstick"), *map(str, words)], check=True, capture_output=True)
        return time.perf_counter() - started


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=MODELS)
    for model in parser.parse_args().models:
        torch.manual_seed(0)
        network = open_clip.create_model(model, pretrained=None)
        parameters = sum(each.numel() for each in network.visual.parameters())
        with tempfile.TemporaryDirectory() as folder:
            weights = Path(folder) / "random.pt"
            torch.save(network.state_dict(), weights)
            begun = seconds_of(model, weights, 1, 1)
            for ask_every, steps in ((10, 200), (1, 30)):
                step = (seconds_of(model, weights, ask_every, steps) - begun) / (steps - 1)
                row = {
                    "model": model,
                    "parameters": round(parameters / 1e6),
                    "strokes": STROKES,
                    "px": PX,
                    "ask_every": ask_every,
                    "steps": steps,
                    "step_ms": round(1e3 * step, 1),
                    "minutes": round((begun + 1999 * step) / 60, 1),
                }
                print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
