"""Lines of documents, as their readers type them."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def blocks(text: str, language: str) -> list[str]:
    """Blocks of code of one language, in order."""
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def lines(text: str) -> list[str]:
    """Lines of all blocks of commands, in order."""
    return [line for block in blocks(text, "sh") for line in block.splitlines()]


def typed(words: list[str], folder: Path) -> None:
    """Run ``maulstick`` with these words in a folder, as a command of its own. Fails where that does."""
    command = [Path(sys.executable).parent / "maulstick", *words]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, f"{' '.join(words)}: {ran.stderr}"
