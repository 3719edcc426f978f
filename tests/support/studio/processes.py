"""Checks of processes that are no children of this one."""

import time
from collections.abc import Iterable
from pathlib import Path

PATIENCE = 60.0  # seconds, for a machine that does much else


def have_ended(processes: Iterable[int]) -> bool:
    """Whether all of the processes end soon."""
    until = time.monotonic() + PATIENCE
    while any(_is_running(process) for process in processes):
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def _is_running(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):  # the latter where it ends while it is read
        return False
