"""What is said of machines and runs, in the words of the page: elsewhere the same is said for the command line."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from maulstick.errors import InputError

MACHINES: Final = {
    "sim": "Simulated easel, as fast as it can",
    "sim:real": "Simulated easel, at an arm's pace",
    "grbl": "Pen plotter with Grbl",
    "axidraw": "AxiDraw",
    "lite6": "UFACTORY Lite 6",
    "xarm": "UFACTORY xArm",
    "franka": "Franka arm",
    "ur": "Universal Robots arm",
}
"""Names of machines for people, by spec without an address."""

FINER = "Speed, sheet and camera"
"""Where the finer points are asked for."""

ANEW = "Start again on a new sheet"
"""The button for that."""

_ON_THE_PAGE: Final = (
    (r"slow all strokes down with --speed (\S+)", rf"slow all strokes down: write \1 under “{FINER}”"),
    (r"begun on (\S+), and", lambda found: f"begun on another machine, {name_of(found[1])}, and"),
    (r"leave out --robot, or start on a new sheet with --restart", f"choose that machine, or “{ANEW}”"),
    (r"go on with --resume, or start on a new sheet with --restart", f"“Go on where it stopped”, or “{ANEW}”"),
    (r"start again with --restart", f"“{ANEW}”"),
    (r"nothing was begun, so leave out --resume", "nothing was begun, so start it"),
    (r"go on with --replan 0", "go on without a camera"),
    (r"name it with --picture", "choose a plan of a picture, or no camera"),
    (r"--replan goes by", "planning again goes by"),
    (r"--replan needs a camera over the sheet;.*", "planning again needs a camera over the sheet; choose one"),
    (r"leave out --camera", "choose that one, or none"),
    (r"--speed is (\S+);", r"the speed is \1 mm/s;"),
    (r"--replan is", "the number of strokes between two looks is"),
    (r"then go on with maulstick paint \.\.\. --resume", "then “Go on where it stopped”"),
    (r"and maulstick paint --resume goes on", "then “Go on where it stopped”"),
    (r"plan it again with maulstick plan --pressure 0\.5", "choose another machine, or a plan whose brush is a pen"),
    (r"; run: maulstick calibrate touch --robot \.\.\.", f"; bring its easel file under “{FINER}”"),
    (r"name its port: axidraw:PORT", "choose its port"),
    (r"another maulstick drives (\S+);", lambda found: f"another Maulstick drives {name_of(found[1])};"),
)
"""What a sentence says for the command line, and what it says here."""


def name_of(machine: str) -> str:
    """Return the name of the machine with this spec, for people."""
    kind, _, address = machine.partition(":")
    if machine in MACHINES:
        return MACHINES[machine]
    return f"{MACHINES.get(kind, kind)} at {address}"


def on_the_page(sentence: str) -> str:
    """The same in the words of the page."""
    for pattern, words in _ON_THE_PAGE:
        sentence = re.sub(pattern, words, sentence)
    return sentence


@contextmanager
def told_on_the_page() -> Iterator[None]:
    """While it lasts an InputError says the same in the words of the page."""
    try:
        yield
    except InputError as error:
        raise InputError(on_the_page(str(error))) from error
