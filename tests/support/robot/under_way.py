"""What happens to a machine under way happens at a place of it, not at a time: a busy computer may be slow to start."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_PATIENCE = 60.0  # seconds


@contextmanager
def once(condition: Callable[[], bool], act: Callable[[], object]) -> Iterator[None]:
    """Act, in another thread, once the condition holds while the context lasts."""
    late = threading.Event()

    def watch() -> None:
        until = time.monotonic() + _PATIENCE
        while not condition():
            if late.wait(0.005) or time.monotonic() > until:
                return
        act()

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        yield
    finally:
        late.set()
        watching.join()
