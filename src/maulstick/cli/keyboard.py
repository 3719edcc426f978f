"""Keys that are pressed in a terminal."""

import select
import sys
from collections.abc import Iterator

_ENTER = ("c-m", "c-j")  # names of Enter, which terminals send as either


def pressed_keys() -> Iterator[str]:
    """Yield the names of the keys that are pressed; Ctrl-C interrupts, also while something else is done."""
    from prompt_toolkit.input import create_input
    from prompt_toolkit.keys import Keys

    terminal = create_input(sys.stdin)
    while not terminal.closed:
        with terminal.raw_mode():  # in which Ctrl-C is a key like any other: so only while keys are waited for
            select.select([terminal.fileno()], [], [])
            keys = [*terminal.read_keys(), *terminal.flush_keys()]
        for pressed in keys:
            if pressed.key == Keys.ControlC:
                raise KeyboardInterrupt
            name = pressed.key.value if isinstance(pressed.key, Keys) else pressed.key
            yield "enter" if name in _ENTER else name
