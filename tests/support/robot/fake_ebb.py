"""A fake EiBotBoard on a pseudo-terminal, `pace` times as fast as real time: one motion runs and one is queued."""

import os
import pty
import select
import threading
import time
import tty
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

STEPS_PER_MILLISECOND = 25
SLOWEST = 1.31
LONGEST = 0xFFFFFF  # milliseconds, or steps, of one SM
SERVO_REST = 60_000  # milliseconds after its last motion when the servo's power goes off, since 2.6.3
POWERED, UNPOWERED = 300, 20  # of QC, with and without a supply of 9 V


@dataclass
class Motion:
    """Motion of so many seconds and steps of the motors, or of the pen, which goes up or down at once."""

    seconds: float
    steps: tuple[int, int] | None = None
    gone: float = 0.0

    @property
    def left(self) -> tuple[int, int]:
        """Steps of both motors that are still to be made."""
        done = self.gone / self.seconds
        first, second = self.steps or (0, 0)
        return abs(first - round(done * first)), abs(second - round(done * second))


@dataclass
class FakeEbb:
    """Board that answers as the documentation of its firmware, 2.x or 3.x, says, until a fault.

    faults[n] happens instead of the answer to the n-th SM, counted from 0.

    A fault is an answer that starts with !, or `silent`, `closed`, `noise`, `unpowered`.  delay: seconds of the wall
    that every answer is late.  unread: what an earlier program left of a command.
    """

    version: str = "2.8.1"
    pace: float = 50.0
    delay: float = 0.0
    faults: dict[int, str] = field(default_factory=dict)
    steps: tuple[int, int] = (0, 0)
    supply: int = POWERED
    button: bool = False
    unread: bytes = b""
    enabled: bool | None = None  # None: where it begins with steps, since it counts none while its motors turn freely
    divided: int = 16  # into how many each step is, where it is enabled
    future: bool = False  # whether it answers in the syntax that firmware 3 knows beside the old one
    queue: int = 1  # motions that wait beside the one that runs

    commands: list[str] = field(default_factory=list)
    made: tuple[int, int] = (0, 0)  # steps that the motors really made: none without power
    reached: list[tuple[int, int, bool]] = field(default_factory=list)  # those, and whether the pen was down
    refused: list[str] = field(default_factory=list)
    seconds: float = 0.0  # of motion, since it was switched on
    clock: float = 0.0  # seconds since then
    down: bool = False
    stops: int = 0

    def __enter__(self) -> Self:
        self._master, self._unplugged = -1, False
        self.plug_in()
        self.made = self.steps
        if self.enabled is None:
            self.enabled = self.steps != (0, 0)
        self._answers: deque[tuple[float, bytes]] = deque()
        self._motions: deque[Motion] = deque()
        self._base = self.steps
        self._moves = 0
        self._rest, self._served = SERVO_REST, -1e9
        self._silent = self._ending = False
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._ending = True
        self._thread.join()
        self._hang_up()

    def plug_in(self) -> None:
        """Connect the line, at a new port, unless it is connected; the board may have been running without one."""
        if self._master >= 0:
            return
        master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._master = master

    def unplug(self) -> None:
        """Disconnect the line at the next look at it; what was queued is carried out."""
        self._unplugged = True
        while self._master >= 0:
            time.sleep(0.001)

    @property
    def moves(self) -> bool:
        """Whether a motion runs."""
        return bool(self._motions)

    @property
    def servo_is_powered(self) -> bool:
        """Whether the servo has power, as QR would say: off when switched on, and so long after its last motion."""
        return self._served >= 0 and (self._rest == 0 or 1000 * (self.clock - self._served) < self._rest)

    def _live(self) -> None:
        before = time.monotonic()
        while not self._ending:
            if self._unplugged:
                self._unplugged = False
                self._hang_up()
            if self._master < 0:
                time.sleep(0.005)
            else:
                self._talk()
            now = time.monotonic()
            self.clock += (now - before) * self.pace
            self._run((now - before) * self.pace)
            before = now
            while b"\r" in self.unread and self._obey(self.unread.split(b"\r", 1)[0].decode("latin-1")):
                self.unread = self.unread.split(b"\r", 1)[1]

    def _talk(self) -> None:
        with suppress(OSError):
            if select.select([self._master], [], [], 0.0005)[0]:
                self.unread += os.read(self._master, 4096)
            while self._answers and self._answers[0][0] <= time.monotonic():
                content = self._answers.popleft()[1]
                if not self._silent:
                    os.write(self._master, content)

    def _run(self, seconds: float) -> None:
        while self._motions and seconds > 0:
            motion = self._motions[0]
            took = min(seconds, motion.seconds - motion.gone)
            motion.gone += took
            seconds -= took
            self.seconds += took
            share = motion.gone / motion.seconds
            first, second = motion.steps or (0, 0)
            steps = self._base[0] + round(share * first), self._base[1] + round(share * second)
            if self.supply > UNPOWERED:
                self.made = self.made[0] + steps[0] - self.steps[0], self.made[1] + steps[1] - self.steps[1]
            self.steps = steps
            if motion.gone >= motion.seconds:
                self._base = self.steps
                self._motions.popleft()
                self.reached.append((*self.made, self.down))

    def _tell(self, text: str, end: str = "\r\n") -> None:
        if self.future:
            text, end = self._name if text == "OK" else f"{self._name},{text.removeprefix('QM,')}", "\n"
        self._answers.append((time.monotonic() + self.delay, f"{text}{end}".encode("latin-1")))

    def _hang_up(self) -> None:
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._master = -1

    def _obey(self, command: str) -> bool:
        """Deal with the command; returns whether that was possible now."""
        name, *words = command.split(",")
        if name in ("SM", "SP") and len(self._motions) > self.queue:  # one more blocks all commands after it
            return False
        if not command:
            return True
        self.commands.append(command)
        self._name, before = name, len(self._answers)
        if name == "SM":
            fault = self.faults.get(self._moves)
            self._moves += 1
            if fault is not None and not self._fail(fault):
                return True
        act = getattr(self, f"_do_{name.lower()}", None) if name.isalnum() else None
        refusal = unknown(name) if act is None else self._act(act, words)
        if refusal is not None:
            self.refused.append(command)
            self._tell(refusal)
        elif name not in ("V", "QM") and not (self.future and len(self._answers) > before):
            self._tell("OK")
        return True

    def _act(self, act: Callable[[list[int]], str | None], words: list[str]) -> str | None:
        try:
            return act([int(word) for word in words])
        except IndexError:
            return "!4 Err: Missing parameter(s)"
        except ValueError:
            return wrong_value()

    def _do_v(self, _: list[int]) -> None:
        self._tell(f"EBBv13_and_above EB Firmware Version {self.version}")

    def _do_qm(self, _: list[int]) -> None:
        first, second = self._motions[0].steps or (0, 0) if self._motions else (0, 0)
        states = int(bool(self._motions)), int(first != 0), int(second != 0), int(len(self._motions) > 1)
        self._tell("QM,{},{},{},{}".format(*states), "\n\r")

    def _do_qs(self, _: list[int]) -> None:
        self._tell(f"{self.steps[0]},{self.steps[1]}", "\n\r")

    def _do_qc(self, _: list[int]) -> None:
        self._tell(f"0394,{self.supply:04d}")

    def _do_qe(self, _: list[int]) -> str | None:
        if not self._has((2, 8, 0)):
            return unknown("QE")
        state = self.divided if self.enabled else 0
        self._tell(f"{state},{state}")
        return None

    def _do_qb(self, _: list[int]) -> None:
        self._tell(str(int(self.button)))
        self.button = False

    def _do_em(self, words: list[int]) -> str | None:
        first, second = words
        if not (0 <= first <= 5 and 0 <= second <= 5):
            return wrong_value()
        self.enabled = first > 0 and second > 0
        self.divided = 16 >> (first - 1) if first > 0 else self.divided
        if self._has((2, 6, 2)):
            self._do_cs([])
        return None

    def _do_cs(self, _: list[int]) -> None:
        self.steps = self._base = (0, 0)

    def _do_es(self, _: list[int]) -> None:
        """Drop the motions of the motors, but none of the pen; tell whether any, and before 3.0 what was left to do."""
        self.stops += 1
        running, queued = [*self._motions, Motion(1), Motion(1)][:2]
        dropped = [motion for motion in self._motions if motion.steps is not None]
        numbers = int(bool(dropped)), *queued.left, *running.left
        told = numbers[:1] if self._has((3, 0, 0)) else numbers
        self._tell(",".join(map(str, told)), "\n\r")
        self._motions = deque(motion for motion in self._motions if motion.steps is None)
        self._base = self.steps

    def _do_sc(self, words: list[int]) -> str | None:
        kind, value = words
        return None if 0 <= kind <= 255 and (1 if kind in (4, 5) else 0) <= value <= 65535 else wrong_value()

    def _do_cu(self, words: list[int]) -> str | None:
        """Set the depth of the queue (4), or the syntax (10), whose answer is half in either."""
        if not self._has((3, 0, 0)) or words[0] not in (4, 10):
            return wrong_value()
        if words[0] == 4:
            self.queue = words[1]
        elif self.future and words[1] == 0:
            self.future = False
            self._tell("CU", "")
        return None

    def _do_sr(self, words: list[int]) -> str | None:
        if not self._has((2, 6, 0)):
            return unknown("SR")
        self._rest = words[0]
        return None if 0 <= words[0] < 2**32 else wrong_value()

    def _do_sp(self, words: list[int]) -> str | None:
        state, duration = words
        if state not in (0, 1) or not 1 <= duration <= 65535:
            return wrong_value()
        self.down, self._served = state == 0, self.clock
        self._motions.append(Motion(duration / 1000))
        return None

    def _do_sm(self, words: list[int]) -> str | None:
        duration, *steps = words
        if not 1 <= duration <= LONGEST:
            return "!0 Err: <move_duration> larger than 16777215 ms."
        for axis, count in enumerate(map(abs, steps), 1):
            if count > LONGEST:
                return f"!0 Err: <axis{axis}> larger than 16777215 steps."
            if count > STEPS_PER_MILLISECOND * duration:
                return f"!0 Err: <axis{axis}> step rate > 25K steps/second."
            if 0 < count < SLOWEST * duration / 1000:
                return f"!0 Err: <axis{axis}> step rate < 1.31Hz."
        self.enabled = True
        self._motions.append(Motion(duration / 1000, (steps[0], steps[1])))
        return None

    def _has(self, version: tuple[int, ...]) -> bool:
        return tuple(map(int, self.version.split("."))) >= version

    def _fail(self, fault: str) -> bool:
        """Let the fault happen; returns whether the command is carried out all the same."""
        if fault == "silent":
            self._silent = True
        elif fault == "closed":
            self._hang_up()
        elif fault == "noise":
            self._tell("\xff\x03O\xf8")
        elif fault == "unpowered":
            self.supply = UNPOWERED
            return True
        else:
            self._tell(fault)
        return False


def unknown(name: str) -> str:
    return f"!8 Err: Unknown command '{name}:{''.join(f'{ord(letter):02X}' for letter in name)}'"


def wrong_value() -> str:
    return "!6 Err: Invalid parameter value"
