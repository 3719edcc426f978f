"""What tells a machine's calls to stop, from any thread or signal handler."""

import time
from typing import final

_GLANCE = 0.02  # seconds


@final
class Stopping:
    """As `threading.Event`, which a signal handler must not set: it would wait for a lock that its own thread holds."""

    def __init__(self) -> None:
        self._set = False

    def is_set(self) -> bool:
        """Whether to stop."""
        return self._set

    def set(self) -> None:
        """From now on, stop."""
        self._set = True

    def clear(self) -> None:
        """From now on, go on."""
        self._set = False

    def wait(self, seconds: float) -> bool:
        """Return after so many seconds, or soon after it is set: whether it is."""
        until = time.monotonic() + seconds
        while not self._set and (left := until - time.monotonic()) > 0:
            time.sleep(min(left, _GLANCE))
        return self._set
