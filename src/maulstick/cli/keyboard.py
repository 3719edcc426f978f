"""Keys that are pressed in a terminal."""

import select
import signal
import sys
import termios
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import groupby
from typing import Final

_HELD: Final = ("left", "right", "up", "down", "pageup", "pagedown")  # keys that move a tip
_ENTER = ("c-m", "c-j")  # names of Enter, which terminals send as either


def pressed_keys() -> Iterator[str]:
    """Yield the names of the keys that are pressed; Ctrl-C interrupts, also while something else is done.

    An arrow or page key that comes several times at once counts once: a key that is held repeats faster than a machine
    moves, which would go on long after it is released.
    """
    from prompt_toolkit.input import create_input
    from prompt_toolkit.keys import Keys

    terminal = create_input(sys.stdin)
    while not terminal.closed:
        with terminal.raw_mode():  # in which Ctrl-C is a key like any other: so only while keys are waited for
            select.select([terminal.fileno()], [], [])
            keys = [*terminal.read_keys(), *terminal.flush_keys()]
        names = [pressed.key.value if isinstance(pressed.key, Keys) else pressed.key for pressed in keys]
        for name, run in groupby(names):
            for _ in range(1 if name in _HELD else len([*run])):
                if name == Keys.ControlC.value:
                    raise KeyboardInterrupt
                yield "enter" if name in _ENTER else name


@contextmanager
def hang_up_as_ctrl_c() -> Iterator[None]:
    """Let a terminal that is closed, and a kill, interrupt as Ctrl-C does, so that the pen is lifted."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def unechoed() -> Iterator[None]:
    """Let the terminal show no keys that are pressed while something else is done."""
    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    quiet = [*before]
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(terminal, termios.TCSADRAIN, quiet)
    try:
        yield
    finally:
        with suppress(termios.error):  # of a terminal that is closed
            termios.tcsetattr(terminal, termios.TCSADRAIN, before)
