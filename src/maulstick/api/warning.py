"""Warnings that name the line of the program that called Maulstick."""

import os
import sys
import warnings
from pathlib import Path
from types import FrameType

_OURS = f"{Path(__file__).parents[1]}{os.sep}"


def warn(sentence: str) -> None:
    """Warn of what may be other than the caller expects, however deep in Maulstick that is found."""
    level = 1
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_code.co_filename.startswith(_OURS):
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, stacklevel=level)
