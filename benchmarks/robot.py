"""How machines paint: one JSON object per line.

    .venv/bin/python benchmarks/robot.py [order] [time] [kills] [--quick]

order: of strokes, beside vpype's linesort; see robot_order.py.  --quick: 400 strokes only.
time: that painting takes, beside the real Grbl's; see robot_time.py.
kills: what is on the paper after 200 of them at random moments; see robot_kills.py.
"""

import argparse
import json
from importlib import import_module  # each kill starts a process, which loads this file again

NAMES = ("order", "time", "kills")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}; all by default")
    parser.add_argument("--quick", action="store_true")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in NAMES]:
        parser.error(f"{unknown[0]} is not one of {', '.join(NAMES)}")
    for name in asked.names or NAMES:
        for row in import_module(f"robot_{name}").rows(asked.quick):
            print(json.dumps({k: round(x, 3) if isinstance(x, float) else x for k, x in row.items()}), flush=True)


if __name__ == "__main__":
    main()
