"""Make the pictures of docs/gallery.md by the commands that stand there: half an hour and more.

    .venv/bin/python experiments/gallery.py [--only cat] [--again]

Commands run one after another in out/gallery. What is there is kept, so that an interrupted run goes on.
"""

import argparse
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
PAGE, FILES = ROOT / "docs" / "gallery.md", ROOT / "docs" / "gallery"
KEPT = ROOT / "out" / "gallery"
WIDTH, QUALITY = 900, 82
"""Pixels at most, and quality of the JPEG."""


class Shown(NamedTuple):
    """Picture of the page; commands: what makes it, in order."""

    name: str
    commands: tuple[str, ...]

    @property
    def made(self) -> Path:
        """What the commands make, within their folder: a picture, or the preview of a plan."""
        words = shlex.split(self.commands[0])
        out = Path(words[words.index("--out") + 1])
        return out if out.suffix else out / "preview.png"


def preparation(text: str) -> str:
    """The line of the page's beginning that gets the photographs."""
    return next(line for block in _blocks(text.partition("\n## ")[0]) for line in block)


def pictures(text: str) -> list[Shown]:
    """Each section's picture, with its commands."""
    found = []
    for section in text.split("\n## ")[1:]:
        (name,) = re.findall(r"\]\(gallery/(\w+)\.jpg\)", section)
        found.append(Shown(name, tuple(line for block in _blocks(section) for line in block)))
    return found


def run(line: str) -> None:
    """Run a line of the page in the folder of the pictures, with this environment's commands."""
    command, *words = shlex.split(line)
    subprocess.run([Path(sys.executable).parent / command, *words], cwd=KEPT, check=True)


def make(shown: Shown, again: bool) -> None:
    """Run the commands of a picture unless it is kept, and write its JPEG beside the page."""
    made = KEPT / shown.made
    if again or not made.exists():
        if made.name == "preview.png":  # of a plan, perhaps one that was cut off
            shutil.rmtree(made.parent, ignore_errors=True)
        made.unlink(missing_ok=True)
        for line in shown.commands:
            run(line)
    with Image.open(made) as image:
        picture = image.convert("RGB")
    picture.thumbnail((WIDTH, WIDTH), Image.Resampling.LANCZOS)
    picture.save(FILES / f"{shown.name}.jpg", quality=QUALITY, optimize=True)


def _blocks(text: str) -> list[list[str]]:
    return [block.splitlines() for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)]


def main() -> None:
    """Make all pictures, or one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="name of the one picture to make, as in cat")
    parser.add_argument("--again", action="store_true", help="make it anew, even if it is kept")
    chosen = parser.parse_args()
    text = PAGE.read_text(encoding="utf-8")
    KEPT.mkdir(parents=True, exist_ok=True)
    for path in FILES.iterdir():
        if path.suffix != ".jpg":
            shutil.copy(path, KEPT)
    if not (KEPT / "astronaut.png").exists():
        run(preparation(text))
    for shown in pictures(text):
        if chosen.only in (None, shown.name):
            print(shown.name, flush=True)
            make(shown, chosen.again)


if __name__ == "__main__":
    main()
