"""Loading of large libraries."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def no_garbage() -> Iterator[None]:
    """Collect no garbage among what is imported meanwhile, neither now nor later: it takes a third of the time."""
    loaded = len(sys.modules)
    gc.disable()
    try:
        yield
    finally:
        if len(sys.modules) > loaded:  # or it would keep real garbage of a process that runs many commands
            gc.freeze()
        gc.enable()
