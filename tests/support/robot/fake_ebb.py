"""A fake EiBotBoard on a pseudo-terminal, `pace` times as fast as real time: one motion runs and one is queued."""

import os
import pty
import select
import threading
import time
import tty
from collections import deque
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

STEPS_PER_SECOND = 25_000
SLOWEST = 1.31


@dataclass
class Motion:
    """Motion of so many seconds and steps of the motors, or of the pen, which goes up or down at once."""

    seconds: float
    steps: tuple[int, int] = (0, 0)
    gone: float = 0.0


@dataclass
class FakeEbb:
    """Board that answers as firmware 2.x does, until a fault.

    faults[n] happens instead of the answer to the n-th SM, counted from 0.

    A fault is an answer that starts with !, or `silent`, `closed`, `noise`.  delay: seconds of the wall that every
    answer is late.
    """

    version: str = "2.7.0"
    pace: float = 50.0
    delay: float = 0.0
    faults: dict[int, str] = field(default_factory=dict)
    steps: tuple[int, int] = (0, 0)

    commands: list[str] = field(default_factory=list)
    reached: list[tuple[int, int, bool]] = field(default_factory=list)  # both motors and whether the pen was down
    refused: list[str] = field(default_factory=list)
    seconds: float = 0.0  # of motion, since it was switched on
    down: bool = False
    stops: int = 0

    def __enter__(self) -> Self:
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._unread = b""
        self._answers: deque[tuple[float, bytes]] = deque()
        self._motions: deque[Motion] = deque()
        self._base = self.steps
        self._moves = 0
        self._silent = self._ending = False
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._ending = True
        self._thread.join()
        self._hang_up()

    def _live(self) -> None:
        before = time.monotonic()
        while not self._ending:
            if self._master < 0:
                time.sleep(0.005)
                continue
            try:
                if select.select([self._master], [], [], 0.0005)[0]:
                    self._unread += os.read(self._master, 4096)
                while self._answers and self._answers[0][0] <= time.monotonic():
                    content = self._answers.popleft()[1]
                    if not self._silent:
                        os.write(self._master, content)
            except OSError:
                continue
            now = time.monotonic()
            self._run((now - before) * self.pace)
            before = now
            while b"\r" in self._unread and self._obey(self._unread.split(b"\r", 1)[0].decode("latin-1")):
                self._unread = self._unread.split(b"\r", 1)[1]

    def _run(self, seconds: float) -> None:
        while self._motions and seconds > 0:
            motion = self._motions[0]
            took = min(seconds, motion.seconds - motion.gone)
            motion.gone += took
            seconds -= took
            self.seconds += took
            share = motion.gone / motion.seconds
            self.steps = (
                self._base[0] + round(share * motion.steps[0]),
                self._base[1] + round(share * motion.steps[1]),
            )
            if motion.gone >= motion.seconds:
                self._base = self.steps
                self._motions.popleft()
                self.reached.append((*self.steps, self.down))

    def _tell(self, text: str, end: str = "\r\n") -> None:
        self._answers.append((time.monotonic() + self.delay, f"{text}{end}".encode("latin-1")))

    def _hang_up(self) -> None:
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._master = -1

    def _obey(self, command: str) -> bool:
        """Deal with the command; returns whether that was possible now."""
        name, *words = command.split(",")
        if name in ("SM", "SP") and len(self._motions) >= 2:
            return False
        self.commands.append(command)
        if name == "SM":
            fault = self.faults.get(self._moves)
            self._moves += 1
            if fault is not None:
                self._fail(fault)
                return True
        if name == "V":
            self._tell(f"EBBv13_and_above EB Firmware Version {self.version}")
            return True
        if name == "QM":
            moving = int(bool(self._motions))
            self._tell(f"QM,{moving},{moving},{moving},{int(len(self._motions) > 1)}", "\n\r")
            return True
        if (refusal := self._act(name, words)) is not None:
            self.refused.append(command)
            self._tell(refusal)
            return True
        self._tell("OK")
        return True

    def _act(self, name: str, words: list[str]) -> str | None:
        """Return why the command is refused, or None."""
        if name == "EM":
            self.steps = self._base = (0, 0)
        elif name == "QS":
            self._tell(f"{self.steps[0]},{self.steps[1]}", "\n\r")
        elif name == "ES":
            self.stops += 1
            self._tell(f"{int(bool(self._motions))},0,0,0,0", "\n\r")
            self._motions.clear()
            self._base = self.steps
        elif name == "SP":
            self.down = words[0] == "0"
            self._motions.append(Motion(int(words[1]) / 1000))
        elif name == "SM":
            duration, first, second = map(int, words)
            rates = [abs(steps) * 1000 / max(duration, 1) for steps in (first, second)]
            if duration < 1 or max(rates) > STEPS_PER_SECOND or any(0 < rate < SLOWEST for rate in rates):
                return "!5 Err: <axis1> step rate out of range."
            self._motions.append(Motion(duration / 1000, (first, second)))
        elif name != "SC":
            return f"!8 Err: Unknown command '{name}'"
        return None

    def _fail(self, fault: str) -> None:
        if fault == "silent":
            self._silent = True
        elif fault == "closed":
            self._hang_up()
        elif fault == "noise":
            self._tell("\xff\x03O\xf8")
        else:
            self._tell(fault)
