"""Processes that work for the one that hears the terminal."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def deaf_to_interrupts() -> Iterator[None]:
    """Start processes within that do not hear Ctrl-C, which the terminal sends to all of them; their parent acts on it.

    The parent hears afterwards what it was sent meanwhile.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
