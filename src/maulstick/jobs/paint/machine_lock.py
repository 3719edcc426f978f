"""Machine lock: one machine is driven by one process at a time, whichever painting it paints."""

import hashlib
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from platformdirs import user_data_path

from maulstick.errors import machine
from maulstick.robot.machines import is_simulated, kind_of
from maulstick.storage.files import held


@contextmanager
def machine_lock(spec: str) -> Iterator[None]:
    """Lock the machine that the spec names against other processes while the context lasts; simulated ones are free.

    Raises InputError where another process drives it, OutputError where the lock cannot be written.
    """
    if is_simulated(spec) or kind_of(spec) == "own":  # nobody but its maker knows where a robot of one's own is
        yield
        return
    folder = user_data_path("maulstick", appauthor=False) / "machines"
    lock = folder / f"{hashlib.sha256(_place(spec).encode()).hexdigest()}.lock"
    taken = f"another maulstick drives {machine(spec)}; wait until it has finished, or stop it there"
    with held(lock, taken, f"cannot write into {folder}", "mend that, and try again"):
        yield


def _place(spec: str) -> str:
    """Return the same text for all names of a machine: its port, or its address in the network."""
    kind, _, address = spec.partition(":")
    if not address and kind == "axidraw":
        from maulstick.robot.adapters.ebb_board import port_of_the_board  # loads the serial port

        address = port_of_the_board()
    port = Path(address.partition("@")[0])
    if port.exists():
        return str(port.resolve())
    try:
        return socket.gethostbyname(address)
    except (OSError, UnicodeError):
        return address.lower()
