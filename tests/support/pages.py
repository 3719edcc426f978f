"""Pages of the documentation: what they tell to type, and a reader who types it."""

import io
import os
import re
import runpy
import shlex
import sys
import tty
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from unittest.mock import patch

from tests.cli.conftest import Ran, run

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def blocks_of(page: Path, *languages: str) -> list[tuple[str, str]]:
    """Fenced blocks of some languages, in order: the language, and the block."""
    found = re.findall(r"```(\w+)\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    return [(language, block) for language, block in found if language in languages]


def blocks(page: Path, language: str) -> list[str]:
    """Fenced blocks of one language, in order."""
    return [block for _, block in blocks_of(page, language)]


def lines(page: Path) -> list[str]:
    """What a page tells to type in a shell, in order."""
    return [line for block in blocks(page, "sh") for line in block.splitlines()]


def typed(line: str, folder: Path, *more: str, stdin: io.IOBase | None = None) -> Ran:
    """Run a line of a shell in a folder, with some more words; stdin: what the reader types meanwhile, if anything."""
    command, *words = shlex.split(line)
    if command == "maulstick":
        with chdir(folder), patch("sys.stdin", stdin or io.StringIO()):
            return run(*words, *more)
    assert command == "python", line
    python(words, folder)
    return Ran(0, "", "")


def python(words: list[str], folder: Path) -> None:
    """Run Python in a folder, ``-c`` and code, or a script and its words, as from a folder in the checkout."""
    with chdir(folder), patch.object(sys, "argv", words):
        if words[0] == "-c":
            exec(compile(words[1], "the page", "exec"), {"__name__": "__main__"})
            return
        runpy.run_path(str((ROOT / "folder" / words[0]).resolve()), run_name="__main__")


@contextmanager
def keys(pressed: str) -> Iterator[io.TextIOWrapper]:
    """A keyboard on which these keys were pressed."""
    keyboard, theirs = os.openpty()
    tty.setraw(theirs)
    os.write(keyboard, pressed.encode())
    with open(theirs) as stdin:
        yield stdin
    os.close(keyboard)
