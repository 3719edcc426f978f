"""Make the pictures of the tutorials by the lines that stand there: some ten minutes.

    .venv/bin/python experiments/tutorials.py

Lines are typed in out/tutorials; what is there is kept, so that an interrupted run goes on with the next.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PAGES, KEPT = ROOT / "docs" / "tutorials", ROOT / "out" / "tutorials"
NEEDED = {  # what begins the lines that a picture needs, in order, and what each makes
    "plotter": [("python -c", "photo.jpg"), ("maulstick plan photo.jpg --robot axidraw --pen", "drawing/preview.png")],
    "tablet": [
        ("python -c", "photo.jpg"),
        ("maulstick record ink wine", "wine.ink.npz"),
        ("maulstick show wine", "wine.png"),
        ("maulstick style fit wine", "data/maulstick/styles/mine.json"),
        (
            "maulstick plan photo.jpg --style mine --hand-size 0.4 --pen micron-03 --strokes 1500",
            "small/preview.png",
        ),
    ],
    "mocap-arm": [
        ("python -c", "photo.jpg"),
        ("python experiments/take.py", "take.csv"),
        ("maulstick record motive", "hand.ink.npz"),
        ("maulstick style fit", "data/maulstick/styles/hand.json"),
        ("maulstick calibrate brush", "data/maulstick/brushes/felt.json"),
        ("maulstick plan", "cat/preview.png"),
        ("maulstick paint cat/painting.json --tray tray.json --replan", "cat/painting-painted.png"),
    ],
}
SHOWN = {
    "plotter": ["drawing/preview.png"],
    "tablet": ["wine.png", "small/preview.png"],
    "mocap-arm": ["cat/preview.png", "cat/painting-painted.png"],
}
HEIGHT, GAP, QUALITY = 560, 16, 78
"""Pixels of each picture, and between two; quality of the JPEG."""


def run(page: str) -> Path:
    """Type the lines that a page's picture needs; returns their folder."""
    folder = KEPT / page
    folder.mkdir(parents=True, exist_ok=True)
    for path in PAGES.iterdir():
        if path.suffix not in (".md", ".jpg"):
            shutil.copy(path, folder)
    blocks = re.findall(r"```sh\n(.*?)```", (PAGES / f"{page}.md").read_text(encoding="utf-8"), re.DOTALL)
    lines = [line for block in blocks for line in block.splitlines()]
    for begins, makes in NEEDED[page]:
        line = next(line for line in lines if line.startswith(begins))
        if not (folder / makes).exists():
            if makes.endswith("preview.png"):  # of a plan that was cut off
                shutil.rmtree((folder / makes).parent, ignore_errors=True)
            print(line, flush=True)
            command, *words = shlex.split(line.replace("experiments/", f"{ROOT}/experiments/"))
            environment = {**os.environ, "XDG_DATA_HOME": str(folder / "data")}
            subprocess.run([Path(sys.executable).parent / command, *words], cwd=folder, env=environment, check=True)
    return folder


def main() -> None:
    """Make all, side by side where there are two."""
    for page, names in SHOWN.items():
        folder = run(page)
        cells = []
        for name in names:
            with Image.open(folder / name) as image:
                size = (round(image.width * HEIGHT / image.height), HEIGHT)
                cells.append(image.convert("RGB").resize(size, Image.Resampling.LANCZOS))
        whole = Image.new("RGB", (sum(cell.width + GAP for cell in cells) - GAP, HEIGHT), "white")
        for number, cell in enumerate(cells):
            whole.paste(cell, (sum(before.width + GAP for before in cells[:number]), 0))
        whole.save(PAGES / f"{page}.jpg", quality=QUALITY, optimize=True)


if __name__ == "__main__":
    main()
