"""Plan one photograph in five of the built-in styles, side by side: the picture in the README.

.venv/bin/python experiments/five_hands.py five-hands.jpg
"""

import argparse
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

STYLES = ("hatching", "loops", "scribble", "contour", "marks")
OPTIONS = ("--brush", "marker", "--strokes", "1000", "--paints", "10", "--size", "160x160mm")
SIDE = 480


def main(out: str) -> None:
    """Plan all, one after another, and save them as one picture."""
    maulstick = Path(sys.executable).with_name("maulstick")
    together = Image.new("RGB", (SIDE * len(STYLES), SIDE), "white")
    with TemporaryDirectory() as folder:
        for column, style in enumerate(STYLES):
            painted = Path(folder) / style
            subprocess.run([maulstick, "plan", "--demo", "--style", style, *OPTIONS, "--out", painted], check=True)
            with Image.open(painted / "preview.png") as preview:
                together.paste(preview.resize((SIDE, SIDE), Image.Resampling.LANCZOS), (SIDE * column, 0))
    together.save(out, quality=88)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", help="the picture to write, as in five-hands.jpg")
    main(parser.parse_args().out)
