"""Work of every kind, as processes of the studio do it; spawned processes find it here."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import NoReturn

from maulstick.errors import InputError
from maulstick.studio.workers.process import Line


def count(line: Line, most: int) -> None:
    """Say the numbers below `most`."""
    for number in range(most):
        line.say(number)


def echo(line: Line) -> None:
    """Say what is heard, until the studio is gone."""
    for word in line.hear():
        line.say(word)


def wait_until_alone(line: Line, ready: Path, alone: Path) -> None:
    """Leave a file once nobody is there any more."""
    line.heard_by(line.say, lambda: alone.touch())
    ready.write_text(str(os.getpid()))
    while not alone.exists():
        time.sleep(0.02)


def refuse(line: Line) -> NoReturn:
    """As work does that a person can mend."""
    raise InputError("there is no such brush")


def break_down(line: Line) -> NoReturn:
    """As work of ours does that is broken."""
    raise ZeroDivisionError("no\nreason")


def swell(line: Line) -> NoReturn:
    """As work does that needs too much."""
    raise MemoryError


def die(line: Line) -> None:
    """As the system ends what takes too much memory."""
    os.kill(os.getpid(), signal.SIGKILL)


def leave(line: Line) -> NoReturn:
    """End at once and say nothing."""
    os._exit(0)


def double(number: int) -> int:
    """Twice as much."""
    return 2 * number


def length(content: bytes) -> int:
    """How much came."""
    return len(content)


def same(content: bytes) -> bytes:
    """What came."""
    return content


def who() -> int:
    """The process that works."""
    return os.getpid()


def sleep(seconds: float) -> None:
    """Take so long."""
    time.sleep(seconds)


def task_refused() -> NoReturn:
    """As work does that a person can mend."""
    raise InputError("there is no such brush")


def task_broken() -> NoReturn:
    """As work of ours does that is broken."""
    raise ZeroDivisionError("no reason")


def task_died() -> None:
    """As the system ends what takes too much memory."""
    os.kill(os.getpid(), signal.SIGKILL)


def task_left() -> NoReturn:
    """End the process and say nothing."""
    os._exit(0)


def task_swelled() -> int:
    """Ask for more memory than there may be."""
    return len(bytearray(64 * 2**30))


def task_of_no_answer() -> object:
    """What no process can tell another."""
    return lambda: None


def task_that_leaves() -> NoReturn:
    """As a library would that thinks the program is its own."""
    sys.exit(0)


def never_stop(line: Line, *request: object) -> None:
    """As a driver does that hangs."""
    from maulstick.jobs.paint.estimate import Estimate

    line.say(Estimate(1, 1.0, 1.0, 0, 1))
    for _ in line.hear():
        pass
