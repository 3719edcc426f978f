"""A process that is kept for what comes next, and let go where nothing comes."""

import asyncio
from typing import Final

from maulstick.studio.workers.process import Process

SETTLED: Final = 3.0
"""Seconds for a page to load and settle, before a process gets ready beside it."""


class Kept:
    """Owner of a process, or of none. Made and used in the studio's event loop.

    idle: seconds without anything to do after which the process is let go.
    """

    def __init__(self, idle: float) -> None:
        self._idle = idle
        self._process: Process | None = None
        self._letting_go: asyncio.TimerHandle | None = None

    def close(self) -> None:
        """End the process, if there is one."""
        self._stay()
        if self._process is not None:
            self._process.forget()
            self._process.kill()
            self._process = None

    def _stay(self) -> None:
        """Forget that the process was to be let go."""
        if self._letting_go is not None:
            self._letting_go.cancel()
            self._letting_go = None

    def _let_go_when_idle(self) -> None:
        self._letting_go = asyncio.get_running_loop().call_later(self._idle, self.close)
