"""Plan a drawing for a pen plotter: one pen, one pressure, an SVG in millimetres; and draw it with Grbl.

python examples/04_pen_plotter.py photo.jpg --out drawing
python examples/04_pen_plotter.py photo.jpg --out drawing --port /dev/ttyUSB0

Any program for plotters takes drawing.svg. With a port, the machine draws at once; `maulstick doctor` lists the ports.
"""

from argparse import ArgumentParser
from importlib.resources import files
from pathlib import Path

import maulstick as ms

parser = ArgumentParser(description=__doc__)
parser.add_argument("picture", nargs="?", default=str(files("skimage.data") / "astronaut.png"))
parser.add_argument("--out", type=Path, default=Path("example-plotter"), help="folder for the results")
parser.add_argument("--port", help="serial port of a plotter that Grbl drives")
parser.add_argument("--size", default="A5", help="size of the sheet")
parser.add_argument("--strokes", type=int, default=1000)
parser.add_argument("--steps", type=int, default=500, help="steps of the optimiser; more are finer")


def main() -> None:
    """Plan, write the SVG, and draw."""
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    painting = ms.plan(
        arguments.picture,
        brush="fineliner",
        ink="black",
        pressure=0.5,  # a plotter only lifts its pen and lowers it
        size=arguments.size,
        strokes=arguments.strokes,
        steps=arguments.steps,
    )
    painting.save(arguments.out / "drawing.svg")
    painting.save(arguments.out / "painting.json")
    if arguments.port is not None:
        result = ms.paint(arguments.out / "painting.json", robot=f"grbl:{arguments.port}", restart=True)
        print(f"{result.painted} of {result.strokes} strokes are drawn")


if __name__ == "__main__":
    main()
