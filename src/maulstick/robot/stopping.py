"""A flag that tells a machine's calls to stop, from any thread or signal handler."""

import time
from typing import final

_GLANCE = 0.02  # seconds between two looks at the flag while waiting: bounds how late a stop is seen


@final
class Stopping:
    """Flag like `threading.Event`, which a signal handler must not set, as it may wait for a lock of its own thread."""

    def __init__(self) -> None:
        self._set = False

    def is_set(self) -> bool:
        """Return whether to stop."""
        return self._set

    def set(self) -> None:
        """Set the flag: from now on, stop."""
        self._set = True

    def clear(self) -> None:
        """Clear the flag: from now on, go on."""
        self._set = False

    def wait(self, seconds: float) -> bool:
        """Wait for so many seconds, or until the flag is set; returns whether it is set."""
        until = time.monotonic() + seconds
        while not self._set and (left := until - time.monotonic()) > 0:
            time.sleep(min(left, _GLANCE))
        return self._set
