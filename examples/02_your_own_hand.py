"""Learn a style from a drawing, and plan a painting in it.

python examples/02_your_own_hand.py photo.jpg --ink drawing.svg

The drawing is an SVG, InkML, Wacom's UIM or WILL 2, or an .ink.npz; without one, a small SVG of waves is written first.
"""

from argparse import ArgumentParser
from importlib.resources import files
from pathlib import Path

import maulstick as ms

parser = ArgumentParser(description=__doc__)
parser.add_argument("picture", nargs="?", default=str(files("skimage.data") / "astronaut.png"))
parser.add_argument("--ink", type=Path, help="a drawing of yours: twenty strokes or more")
parser.add_argument("--out", type=Path, default=Path("example-hand"), help="folder for the results")
parser.add_argument("--strokes", type=int, default=400)
parser.add_argument("--steps", type=int, default=500, help="steps of the optimiser; more are finer")


def drawing() -> str:
    """Return an SVG, 150 x 150 mm, of thirty waves that differ in length and height."""
    waves = (
        f"M{10 + 45 * (i % 3)} {10 + 13 * (i // 3)} q{4 + i / 4} {-3 - i / 5} {8 + i / 2} 0 t{8 + i / 2} 0"
        for i in range(30)
    )
    paths = "".join(f'<path d="{wave}"/>' for wave in waves)
    svg = '<svg xmlns="http://www.w3.org/2000/svg" width="150mm" height="150mm" viewBox="0 0 150 150" fill="none">'
    return f"{svg}{paths}</svg>"


def main() -> None:
    """Read ink, learn its style, and plan with it."""
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.ink is None:
        arguments.ink = arguments.out / "waves.svg"
        arguments.ink.write_text(drawing())
    ink = ms.read_ink(arguments.ink)
    print(ink.summary())
    style = ms.fit_style(ink, "me")  # with keep=True, `maulstick plan --style me` knows it too
    painting = ms.plan(arguments.picture, style=style, brush="marker", strokes=arguments.strokes, steps=arguments.steps)
    painting.save(arguments.out / "painting.json")
    ms.render(painting, px=1024).save(arguments.out / "painting.png")


if __name__ == "__main__":
    main()
