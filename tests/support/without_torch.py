"""Processes that find no PyTorch, as where only painting is installed."""

from pathlib import Path

from maulstick.errors import how_to_add

TAUGHT = f"this needs PyTorch, which is not installed; {how_to_add('plan')}"

_FINDS_NONE = """
import sys


class NoTorch:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "torch":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


sys.meta_path.insert(0, NoTorch())
"""


def hide_torch(folder: Path) -> str:
    """Return a path for PYTHONPATH: Python reads a file there before anything else, and finds no torch from then on."""
    (folder / "sitecustomize.py").write_text(_FINDS_NONE)
    return str(folder)
