"""Make the pictures of docs/tutorials by the lines that stand there: a quarter of an hour.

    .venv/bin/python experiments/tutorials.py [--only plotter]

The lines and snippets of a page run one after another in a folder of their own in out/tutorials, which is emptied
before; those that speak to a machine on a port are left out. Styles and brushes are kept there, too.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PAGES = ROOT / "docs" / "tutorials"
KEPT = ROOT / "out" / "tutorials"
SHOWN = {
    "plotter": {"drawing/preview.png": "drawing", "three/preview.png": "three-pens", "boat-1024px.png": "boat"},
    "tablet": {"wine.png": "recorded", "mine.png": "hand", "three.png": "compared", "colours.png": "colours"},
    "mocap-arm": {
        "hand.png": "take",
        "bare.png": "photographed",
        "felt.png": "felt",
        "cat/preview.png": "cat",
        "cat/painting-painted.png": "painted",
    },
}
"""Per page, what its lines make, and the name of the picture on the page."""
BY_MACHINE = re.compile(r"maulstick (?:machine|doctor|studio|paint .*(?:--robot|--resume))")
WIDTH, QUALITY = 800, 72
"""Pixels at most, and quality of the JPEG."""


def follow(name: str, folder: Path) -> None:
    """Run the lines and snippets of a page, in order, with this environment's commands."""
    variables = {**os.environ, "XDG_DATA_HOME": str(folder / "data")}
    text = (PAGES / f"{name}.md").read_text(encoding="utf-8")
    for language, block in re.findall(r"```(sh|python)\n(.*?)```", text, re.DOTALL):
        for line in [block] if language == "python" else block.splitlines():
            if BY_MACHINE.match(line):
                continue
            words = ["python", "-c", block] if language == "python" else shlex.split(line)
            words = [str(ROOT / word) if word.startswith("experiments/") else word for word in words]
            subprocess.run([Path(sys.executable).parent / words[0], *words[1:]], cwd=folder, env=variables, check=True)


def main() -> None:
    """Make the pictures of all pages, or of one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=list(SHOWN), help="the one page to follow")
    only = parser.parse_args().only
    for name, pictures in SHOWN.items():
        if only not in (None, name):
            continue
        folder = KEPT / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for path in [*PAGES.iterdir(), ROOT / "docs" / "gallery" / "boat.svg"]:
            if path.suffix not in (".md", ".jpg"):
                shutil.copy(path, folder)
        follow(name, folder)
        for made, shown in pictures.items():
            with Image.open(folder / made) as image:
                picture = image.convert("RGB")
            picture.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
            picture.save(PAGES / f"{name}-{shown}.jpg", quality=QUALITY, optimize=True)


if __name__ == "__main__":
    main()
