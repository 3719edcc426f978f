"""Plan a painting of a picture, and write it as JSON, as SVG and as an image.

python examples/01_plan.py photo.jpg --out cat
"""

from argparse import ArgumentParser
from importlib.resources import files
from pathlib import Path

import maulstick as ms

parser = ArgumentParser(description=__doc__)
parser.add_argument("picture", nargs="?", default=str(files("skimage.data") / "astronaut.png"))
parser.add_argument("--out", type=Path, default=Path("example-plan"), help="folder for the results")
parser.add_argument("--strokes", type=int, default=400)
parser.add_argument("--steps", type=int, default=500, help="steps of the optimiser; more are finer")


def main() -> None:
    """Plan, save, and say how near the painting comes to the picture."""
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    painting = ms.plan(
        arguments.picture,
        style="loops",
        brush="marker",
        strokes=arguments.strokes,
        steps=arguments.steps,
        progress=lambda step: print(f"\rplanning: {step.done:4.0%}, loss {step.loss:.4f}", end="", flush=True),
    )
    painting.save(arguments.out / "painting.json")  # for machines
    painting.save(arguments.out / "painting.svg")  # for other programs
    ms.render(painting, px=1024).save(arguments.out / "painting.png")
    found = ms.compare(painting, arguments.picture)
    print(f"\n{len(painting.strokes)} strokes, {len(painting.paints)} paints, {found.psnr:.1f} dB beside the picture")


if __name__ == "__main__":
    main()
