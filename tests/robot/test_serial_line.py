import os
import pty
import threading
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from maulstick.errors import MachineError
from maulstick.robot.adapters.axidraw import AxiDraw
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.robot import Robot

BETWEEN = 2e-3  # seconds between two lines of the device that never pauses
LINES = 3000  # after which it does, so that the test ends whatever happens


@contextmanager
def chatting() -> Iterator[tuple[str, threading.Thread]]:
    """Run a device that tells something else than a machine does all the time; yields its port and its thread."""
    master, slave = pty.openpty()
    tty.setraw(slave)
    over = threading.Event()

    def chat() -> None:
        for number in range(LINES):
            if over.wait(BETWEEN):
                return
            os.write(master, f"light={number}\r\n".encode())

    device = threading.Thread(target=chat, daemon=True)
    device.start()
    try:
        yield os.ttyname(slave), device
    finally:
        over.set()
        device.join()
        os.close(master)
        os.close(slave)


@pytest.mark.parametrize(
    ("machine", "sentence"),
    [
        (lambda port: Grbl(port, patience=0.5), "no Grbl answers on"),
        (lambda port: AxiDraw(port, patience=0.5), "no EiBotBoard answers on"),
    ],
    ids=["grbl", "axidraw"],
)
def test_a_device_that_is_another_and_never_pauses_is_not_waited_for(
    machine: Callable[[str], Robot], sentence: str
) -> None:
    with chatting() as (port, device):
        with pytest.raises(MachineError, match=sentence):
            machine(port).__enter__()
        assert device.is_alive(), "it was not waited for until it was quiet"
