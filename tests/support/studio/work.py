"""Work for processes of the studio in tests; spawned processes import it from here."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import NoReturn

from maulstick.errors import InputError
from maulstick.studio.workers.process import Line


def count(line: Line, most: int) -> None:
    """Send the numbers below `most`."""
    for number in range(most):
        line.say(number)


def echo(line: Line) -> None:
    """Send back each message, until the studio is gone."""
    for word in line.hear():
        line.say(word)


def wait_until_alone(line: Line, ready: Path, alone: Path) -> None:
    """Write a file once the studio is gone, or once it was answered."""

    def answer(word: object) -> None:
        line.say(word)
        alone.touch()

    line.heard_by(answer, alone.touch)
    ready.write_text(str(os.getpid()))
    while not alone.exists():
        time.sleep(0.02)


def refuse(line: Line) -> NoReturn:
    """Raise an error that a person can mend."""
    raise InputError("there is no such brush")


def break_down(line: Line) -> NoReturn:
    """Raise an error that is a defect of Maulstick."""
    raise ZeroDivisionError("no\nreason")


def swell(line: Line) -> NoReturn:
    """Raise MemoryError."""
    raise MemoryError


def die(line: Line) -> None:
    """Kill this process, as the system does where memory runs out."""
    os.kill(os.getpid(), signal.SIGKILL)


def leave(line: Line) -> NoReturn:
    """End the process without a message."""
    os._exit(0)


def double(number: int) -> int:
    """Return the double."""
    return 2 * number


def length(content: bytes) -> int:
    """Return the length of the content."""
    return len(content)


def same(content: bytes) -> bytes:
    """Return the content."""
    return content


def who() -> int:
    """Return the id of this process."""
    return os.getpid()


def sleep(seconds: float) -> None:
    """Sleep so long."""
    time.sleep(seconds)


def task_refused() -> NoReturn:
    """Raise an error that a person can mend."""
    raise InputError("there is no such brush")


def task_broken() -> NoReturn:
    """Raise an error that is a defect of Maulstick."""
    raise ZeroDivisionError("no reason")


def task_died() -> None:
    """Kill this process, as the system does where memory runs out."""
    os.kill(os.getpid(), signal.SIGKILL)


def task_left() -> NoReturn:
    """End the process without a message."""
    os._exit(0)


def task_swelled() -> int:
    """Allocate more memory than is allowed."""
    return len(bytearray(64 * 2**30))


def task_of_no_answer() -> object:
    """Return an object that cannot be sent to another process."""
    return lambda: None


def task_that_leaves() -> NoReturn:
    """Exit, as a careless library would."""
    sys.exit(0)


def never_stop(line: Line, *request: object) -> None:
    """Ignore every command, as a driver that hangs does."""
    from maulstick.jobs.paint.estimate import Estimate

    line.say(Estimate(1, 1.0, 1.0, 0, 1))
    for _ in line.hear():
        pass


def say_loaded(line: Line, module: str) -> None:
    """Say which process this is, and whether it has loaded a module."""
    line.say((os.getpid(), module in sys.modules))
