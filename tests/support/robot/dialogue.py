"""Timed dialogues with the real Grbl 1.1h while it painted forty strokes: what it was sent, and when it had done it.

The firmware's own C code answered on a pseudo-terminal, its step interrupt simulated. A line of a file: seconds since
the start, `<` from the firmware or `>` to it, and the bytes as a literal of Python.
"""

import ast
import re
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from maulstick.robot.adapters.grbl_answers import own_limits, settings_of
from maulstick.robot.easel import Pen
from maulstick.robot.limits import Limits
from maulstick.robot.routine import Motion
from maulstick.storage.arrays import Floats

DIALOGUES = {"servo": Pen(up=300, down=900, seconds=0.2), "z": None, "z40": None, "slow": None}
"""Their names, and the servo of the pen, None where it is lifted by height."""

HEIGHT = 5e-3
"""Metres above the paper: of travel."""

START = np.array([0, 0, HEIGHT])
"""Place where they began, metres."""

_ENDS = "G4P0"  # after each command of ours, so that its answer tells that all has been done


@dataclass
class Command:
    """Lines that were sent together; `began` and `ended`: seconds of the first byte and of the last answer."""

    began: float
    lines: list[str] = field(default_factory=list)
    ended: float = 0.0

    @property
    def seconds(self) -> float:
        return self.ended - self.began

    def places(self, start: Floats) -> Floats:
        """Places (n, 3) that were commanded, metres; numbers that a line leaves out stay as they were."""
        at, places = start.copy(), []
        for words in map(_words, self.lines):
            if words.keys() & set("XYZ"):
                at = np.array([1e-3 * float(words[axis]) if axis in words else at[i] for i, axis in enumerate("XYZ")])
                places.append(at)
        return np.array(places).reshape(-1, 3)

    @property
    def speeds(self) -> Floats:
        """Speeds (n,) of the same, metres per second."""
        return np.array([float(words["F"]) / 60e3 for words in map(_words, self.lines) if "F" in words])


@dataclass(frozen=True)
class Dialogue:
    """What one machine said of itself, and the commands that painted: to each stroke a move, a stroke and a lift."""

    pen: Pen | None
    settings: dict[int, float]
    commands: list[Command]

    @property
    def seconds(self) -> float:
        """Time from the first move to the end of the last lift."""
        return self.commands[-1].ended - self.commands[0].began

    @property
    def limits(self) -> Limits:
        return own_limits(self.settings, np.zeros(3), self.pen)

    def strokes(self) -> Iterator[tuple[Command, Command, Command]]:
        yield from zip(self.commands[::3], self.commands[1::3], self.commands[2::3], strict=True)

    def motions(self) -> list[Motion]:
        """Motions that were commanded; a stroke that a servo draws begins where the move before it ended."""
        motions, place = [], START
        for move, stroke, _ in self.strokes():
            (above,) = move.places(place)
            path, speed = stroke.places(above), stroke.speeds
            if self.pen is not None:
                path, speed = np.concatenate([above[None], path]) * (1, 1, 0), np.r_[speed[:1], speed]
            motions.append(Motion(path, np.r_[speed[1:], speed[-1:]].clip(max=self.limits.speed), HEIGHT, HEIGHT))
            place = path[-1]
        return motions


def dialogue(name: str) -> Dialogue:
    told: list[str] = []
    commands: list[Command] = []
    unanswered: deque[str] = deque()
    cut = ""
    for entry in (Path(__file__).parent / "dialogues" / f"{name}.log").read_text().splitlines():
        when, way, content = entry.split(" ", 2)
        text = ast.literal_eval(content).decode()
        if way == ">":
            for line in re.findall(r"[^\x18?\n]+", text):
                unanswered.append(line)
                if line.startswith("$"):
                    continue
                if not commands or commands[-1].ended:
                    commands.append(Command(float(when)))
                commands[-1].lines.append(line)
            continue
        *whole, cut = (cut + text).split("\r\n")
        told += whole
        for _ in range(whole.count("ok")):
            if unanswered.popleft() == _ENDS:
                commands[-1].ended = float(when)
    return Dialogue(DIALOGUES[name], settings_of(told), commands[1:])  # the first lifts the pen once


def _words(line: str) -> dict[str, str]:
    return dict(re.findall(r"([A-Z])(-?[\d.]+)", line))
