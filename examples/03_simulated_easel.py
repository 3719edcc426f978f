"""Paint on the simulated easel, and save a photograph of the sheet beside what was planned.

python examples/03_simulated_easel.py photo.jpg --out easel
"""

from argparse import ArgumentParser
from importlib.resources import files
from pathlib import Path

import maulstick as ms

parser = ArgumentParser(description=__doc__)
parser.add_argument("picture", nargs="?", default=str(files("skimage.data") / "astronaut.png"))
parser.add_argument("--out", type=Path, default=Path("example-easel"), help="folder for the results")
parser.add_argument("--strokes", type=int, default=300)
parser.add_argument("--steps", type=int, default=300, help="steps of the optimiser; more are finer")


def main() -> None:
    """Plan, paint, and compare the plan with the sheet."""
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    painting = ms.plan(arguments.picture, style="hatching", strokes=arguments.strokes, steps=arguments.steps, paints=8)
    ms.render(painting, px=1024).save(arguments.out / "planned.png")
    result = ms.paint(
        painting,
        robot="sim",
        progress=lambda now: print(f"\r{1e3 * now.drawn:.0f} of {1e3 * now.metres:.0f} mm", end="", flush=True),
    )
    print(f"\n{result.painted} of {result.strokes} strokes are on the sheet")
    if result.photograph is not None:
        result.photograph.save(arguments.out / "painted.png")


if __name__ == "__main__":
    main()
