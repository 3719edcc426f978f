"""A fake Grbl 1.1 on a pseudo-terminal, independent of the package.

Its time runs `pace` times as fast as the wall's. As no wire is that fast, its time stands still while it could take
another line and none has come yet, unless the machine that sends is known to wait. What a real wire and the firmware
take is added where nothing moves meanwhile; test_dialogues.py compares that with the real firmware.
"""

import os
import pty
import re
import select
import threading
import time
import tty
from collections import deque
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, Self

from tests.support.robot.grbl_motion import TICK, GrblMotion, Vector

BUFFER = 128
OVERRIDES = {b"\x90": None, b"\x91": 10, b"\x92": -10, b"\x93": 1, b"\x94": -1}
SENDER_WAITS = 0.1  # seconds of the wall without a byte: on a busy machine a sender may be late
BYTE = 10 / 115200  # seconds on the wire
ANSWER = 1e-3  # seconds from the end of what a line waited for until its ok is read
LAST_SEGMENT = 5e-3  # seconds: motions are stepped in segments of 10 ms, and begin and end with a part of one
PULL_OFF = 1.0  # millimetres that it stands off its switches, $27
HELD = 255  # as $1: the motors are never let go
CRITICAL = ("ALARM:1", "ALARM:2")  # nothing but a reset is heard after these

SETTINGS: dict[int, float] = {
    1: 25, 10: 1, 11: 0.01, 12: 0.002, 13: 0, 20: 0, 21: 0, 22: 0, 23: 0, 24: 25, 25: 500, 27: PULL_OFF,
    30: 1000, 31: 0, 32: 0,
    100: 80, 101: 80, 102: 400, 110: 6000, 111: 6000, 112: 1200,
    120: 400, 121: 400, 122: 400, 130: 300, 131: 220, 132: 60,
}  # fmt: skip

WITH_SWITCHES: dict[str, Any] = {
    "settings": SETTINGS | {22: 1},
    "origin": (-100.0, -100.0, -20.0),
    "start": (-50.0, -50.0, -10.0),
}
"""Of a Grbl that finds its home by switches, and stands elsewhere."""


@dataclass
class FakeGrbl:
    """Machine that answers as Grbl does, until a fault.

    faults[n] happens instead of the answer to the n-th line of G-code, counted from 0.

    A fault is an answer like error:20 or ALARM:1, or `silent`, `closed`, `noise`, `lost` (an ok), `door`,
    `restart` (of the board: it counts its place from where it stands, and is locked where it has switches), and
    `noisy restart`, whose noise comes as a line of its own, since Grbl greets on a new one.
    delay: seconds of the wall that every answer is late.  lost_reports: the first so many come with noise.
    homing: seconds of the wall that finding home takes, in which nothing but a reset is heard.
    more_axes: places of further axes than x, y and z, which it tells after theirs.
    """

    settings: dict[int, float] = field(default_factory=lambda: dict(SETTINGS))
    origin: Vector = (0.0, 0.0, 0.0)  # of the work, G54
    shift: Vector = (0.0, 0.0, 0.0)  # left by another program's G92
    start: Vector = (0.0, 0.0, 0.0)
    pace: float = 50.0
    delay: float = 0.0
    faults: dict[int, str] = field(default_factory=dict)
    lost_reports: int = 0
    options: str = "V"  # with which it was built
    banner: str = "Grbl 1.1h ['$' for help]"
    locked: bool = False
    homing: float = 0.0
    more_axes: tuple[float, ...] = ()

    lines: list[str] = field(default_factory=list)
    seconds: float = 0.0  # of its own time while it was not idle
    servo: float = 0.0
    reached: list[tuple[float, float, float, float]] = field(default_factory=list)  # x, y, z, servo at ends of blocks
    most_unread: int = 0
    override: int = 100  # per cent of the feed of motions that are planned from now on
    overrides: list[bytes] = field(default_factory=list)
    holds: int = 0
    woke_at: Vector = (0.0, 0.0, 0.0)  # from where it has counted its place since it restarted

    def __enter__(self) -> Self:
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._motion = GrblMotion(self.settings, self.start)
        self._unread = b""
        self._state = "Alarm" if self.locked else "Idle"
        self._answers: deque[tuple[float, bytes]] = deque()
        self._silent = self._ending = False
        self._home_at: float | None = None  # when home is found
        self._g_lines = 0
        self._forget()
        self._thread = threading.Thread(target=self._live, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._ending = True
        self._thread.join()
        self._hang_up()

    @property
    def place(self) -> Vector:
        """Place of the tip, millimetres from the machine's origin."""
        return self._motion.place

    @property
    def _offset(self) -> Vector:
        x, y, z = (origin + shift for origin, shift in zip(self.origin, self.shift, strict=True))
        return x, y, z

    @property
    def fastest(self) -> float:
        """Highest speed so far, millimetres per second."""
        return self._motion.fastest

    @property
    def state(self) -> str:
        return self._state

    @property
    def _at_rest(self) -> bool:
        return not self._motion.busy and self._dwell <= 0 and self._settling <= 0

    def press_hold(self) -> None:
        """Press the machine's own button that holds it."""
        self._state = "Hold:1" if self._motion.speed > 0 else "Hold:0"

    def press_start(self) -> None:
        """Press the machine's own button that lets it go on."""
        self._state = "Idle" if self._at_rest else "Run"

    def _live(self) -> None:
        heard = ran_to = time.monotonic()
        owed = 0.0
        while not self._ending:
            now = time.monotonic()
            if self._master < 0:
                time.sleep(0.005)
                continue
            idle = self._at_rest and not self._answers
            try:
                if select.select([self._master], [], [], 0.002 if idle else 0.0005)[0]:
                    self._take(os.read(self._master, 4096))
                    heard = time.monotonic()
                self._say()
            except OSError:
                continue
            if self._home_at is not None and time.monotonic() >= self._home_at:
                self._home_at, self._state = None, "Idle"
                self._motion.place = (-PULL_OFF, -PULL_OFF, -PULL_OFF)
                self._forget()
                self._tell("ok")
            self._read_lines()
            now = time.monotonic()
            if self._may_run(now - heard):
                owed += min(now - ran_to, 0.02) * self.pace
                self._run(int(owed / TICK))
                owed %= TICK
            ran_to = now

    def _may_run(self, quiet: float) -> bool:
        full = self._motion.full or self._pending is not None or self._state.startswith("Hold")
        return full or quiet > SENDER_WAITS

    def _take(self, came: bytes) -> None:
        for byte in came:
            letter = bytes([byte])
            if (self._blocked or self._home_at is not None) and letter != b"\x18":
                continue
            if letter == b"?":
                self._report()
            elif letter == b"!":
                self.holds += 1
                if self._state in ("Run", "Idle"):
                    self._state = "Hold:1" if self._motion.speed > 0 else "Hold:0"
            elif letter == b"~":
                if self._state == "Hold:0":
                    self.press_start()
            elif letter == b"\x18":
                self._reset()
            elif letter in OVERRIDES:
                self.overrides.append(letter)
                change = OVERRIDES[letter]
                self.override = 100 if change is None else min(max(self.override + change, 10), 200)
            elif len(self._unread) >= BUFFER:
                self.most_unread = BUFFER + 1  # an overflow; the byte is lost
            else:
                self._unread += letter
                self.most_unread = max(self.most_unread, len(self._unread))

    def _tell(self, text: str) -> None:
        self._answers.append((time.monotonic() + self.delay, text.encode("latin-1") + b"\r\n"))

    def _say(self) -> None:
        while self._answers and self._answers[0][0] <= time.monotonic():
            _, content = self._answers.popleft()
            if not self._silent:
                os.write(self._master, content)

    def _hang_up(self) -> None:
        if self._master >= 0:
            os.close(self._master)
            os.close(self._slave)
            self._master = -1

    def _report(self) -> None:
        of_machine = int(self.settings[10]) & 1
        tip = zip(self._motion.place, (0.0, 0.0, 0.0) if of_machine else self._offset, strict=True)
        place = ",".join(f"{value:.3f}" for value in (*(value - offset for value, offset in tip), *self.more_axes))
        kind = "M" if of_machine else "W"
        report = f"<{self._state}|{kind}Pos:{place}|FS:0,{self.servo:.0f}|Ov:{self.override},100,100>"
        if self.lost_reports > 0:
            self.lost_reports -= 1
            report = "\xc3" + report[1:]
        self._tell(report)

    def _forget(self) -> None:
        self._motion.forget()
        self._dwell = self._settling = 0.0
        self._blocked = False
        self._pending: str | None = None  # a line that waits for room or for all motion to end
        self._rate = 0.0

    def _reset(self) -> None:
        moving, homing = self._state in ("Run", "Hold:1"), self._home_at is not None
        self._home_at = None
        self._forget()
        self._unread = b""
        self.servo, self.override = 0.0, 100
        self._answers.clear()
        if moving or homing:
            self._state = "Alarm"
            self._tell("ALARM:6" if homing else "ALARM:3")
        elif self._state != "Alarm":
            self._state = "Idle"
        self._tell(self.banner)
        if self._state == "Alarm":
            self._tell("[MSG:'$H'|'$X' to unlock]")

    def _read_lines(self) -> None:
        while self._state != "Hold:0" and self._dwell <= 0 and self._settling <= 0 and not self._blocked:
            if self._pending is None:
                if b"\n" not in self._unread:
                    return
                line, self._unread = self._unread.split(b"\n", 1)
                self._pending = line.decode("latin-1").strip()
                self.lines.append(self._pending)
                if self._at_rest:
                    self.seconds += BYTE * (len(line) + 1)
            if not self._done(self._pending):
                return
            self._pending = None

    def _done(self, line: str) -> bool:
        """Deal with the line; returns whether that was possible now."""
        if line.startswith("$"):
            self._system(line)
            return True
        if self._state == "Alarm":
            self._tell("error:9")
            return True
        words = dict(re.findall(r"([A-Z])(-?[\d.]+)", line))
        motion = ("X" in words or "Y" in words or "Z" in words) and words.get("G") != "10"
        if motion and self._motion.full:
            return False
        waits = "M" in words or words.get("G") == "4"
        if waits and not self._at_rest:
            return False
        fault = self.faults.get(self._g_lines)
        self._g_lines += 1
        if fault is not None:
            self._fail(fault)
            return True
        if waits:
            self.seconds += ANSWER
        if words.get("G") == "10":
            self._set_origin(words)
        if "S" in words:
            self.servo = float(words["S"])
        if words.get("G") == "4":
            self._dwell = float(words["P"])
            if self._dwell > 0:
                return True
        if motion:
            self._plan(words)
        self._tell("ok")
        return True

    def _fail(self, fault: str) -> None:
        if fault == "silent":
            self._silent = True
        elif fault == "closed":
            self._hang_up()
        elif fault == "noise":
            self._tell("\xff\x03o\xf8k")
        elif fault == "door":
            self._state = "Door:0"
        elif fault in ("restart", "noisy restart"):
            x, y, z = (woke + counted for woke, counted in zip(self.woke_at, self._motion.place, strict=True))
            self.woke_at, self._motion.place = (x, y, z), (0.0, 0.0, 0.0)
            self._forget()
            self._state, self._unread, self.servo = "Alarm" if self.settings[22] else "Idle", b"", 0.0
            if fault == "noisy restart":
                self._tell("\xfe")
            self._tell(self.banner)
        elif fault.startswith("ALARM"):
            self._forget()
            self._state = "Alarm"
            self._tell(fault)
            if fault in CRITICAL:
                self._blocked = True
                self._tell("[MSG:Reset to continue]")
        elif fault != "lost":
            self._tell(fault)

    def _system(self, line: str) -> None:
        if line == "$H":
            if not self.settings[22]:
                self._tell("error:5")
                return
            self._state, self._home_at = "Home", time.monotonic() + self.homing
            return
        if line == "$$":
            for number, value in self.settings.items():
                self._tell(f"${number}={value:.3f}" if value != int(value) or number > 99 else f"${number}={value:.0f}")
        elif line == "$#":
            nowhere = (0.0, 0.0, 0.0)
            for name, place in {"G54": self.origin, "G55": nowhere, "G28": nowhere, "G92": self.shift}.items():
                told = ",".join(f"{value:.3f}" for value in (*place, *self.more_axes))
                self._tell(f"[{name}:{told}]")
            self._tell("[TLO:0.000]")
        elif line == "$I":
            self._tell("[VER:1.1h.20190830:]")
            self._tell(f"[OPT:{self.options},15,128]")
        elif line == "$X":
            self._state = "Idle" if self._state == "Alarm" else self._state
        self._tell("ok")

    def _plan(self, words: dict[str, str]) -> None:
        self._rate = float(words.get("F", 60 * self._rate)) / 60
        x, y, z = (
            float(words[letter]) + offset if letter in words else here
            for letter, offset, here in zip("XYZ", self._offset, self._motion.goal, strict=True)
        )
        self._motion.add((x, y, z), self._rate * self.override / 100)
        if self._state == "Idle" and self._motion.busy:
            self._state = "Run"

    def _set_origin(self, words: dict[str, str]) -> None:
        x, y, z = (
            here - float(words[letter]) if letter in words else before
            for letter, here, before in zip("XYZ", self._motion.place, self.origin, strict=True)
        )
        self.origin = (x, y, z)

    def _run(self, ticks: int) -> None:
        for _ in range(ticks):
            if self._dwell > 0:
                self.seconds += TICK
                self._dwell -= TICK
                if self._dwell <= 1e-9:
                    self._dwell = 0.0
                    self._tell("ok")
                    self._read_lines()
            elif self._settling > 0:
                self.seconds += TICK
                self._settling -= TICK
                if self._settling <= 1e-9:
                    self._settling = 0.0
                    self._state = "Idle"
                    self._read_lines()
            elif self._motion.busy and self._state in ("Run", "Hold:1"):
                self.seconds += TICK
                self._step()
                if self._pending is not None:
                    self._read_lines()
                if not self._may_run(0.0):
                    return
            else:
                return

    def _step(self) -> None:
        braking = self._state == "Hold:1"
        self.reached += [(*place, self.servo) for place in self._motion.step(braking)]
        if braking and self._motion.speed == 0:
            self._state = "Hold:0"
        elif not self._motion.busy:
            self._settling = LAST_SEGMENT + (0.0 if self.settings[1] == HELD else 1e-3 * self.settings[1])
            self._state = "Run"
