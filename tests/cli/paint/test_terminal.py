"""``maulstick paint`` with a person at the terminal, who presses keys, and with power cuts."""

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from maulstick.painting.painting_file import write_painting
from maulstick.robot.journal import Journal, journal_of
from tests.cli.conftest import Running, run
from tests.support.robot.small_paintings import line, painting_of

SLOW = ("--robot", "sim:real", "--speed", "20")
LONG = painting_of([line(i, (0.005, 0.005 * i), (0.035, 0.005 * i)) for i in range(1, 4)])
"""Three strokes of 30 mm, 1.5 s each at 20 mm/s."""


class Terminal(Running):
    """``maulstick paint`` in a terminal of its own, whose keys are pressed here."""

    def __init__(self, *words: str | Path) -> None:
        super().__init__("paint", *words, keys=True)

    def press(self, keys: str) -> None:
        os.write(self._terminal, keys.encode())

    def send(self, number: signal.Signals) -> None:
        """A signal, to the process and to no other."""
        self._process.send_signal(number)

    def close(self) -> None:
        if self._process.poll() is None:
            self._process.kill()
            self.leave()


Begun = Callable[..., Terminal]


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    write_painting(LONG, tmp_path / "painting.json")
    return tmp_path / "painting.json"


@pytest.fixture
def begin() -> Iterator[Begun]:
    """Begin a run; it is ended with the test."""
    begun: list[Terminal] = []

    def start(*words: str | Path) -> Terminal:
        begun.append(Terminal(*words))
        return begun[-1]

    yield start
    for terminal in begun:
        terminal.close()


def said_of(painting: Path) -> tuple[set[int], int | None]:
    """What the journal says is painted, and what was under the brush."""
    with Journal.open(journal_of(painting)) as journal:
        return journal.painted, journal.unfinished


def begun(painting: Path) -> list[int]:
    lines = [json.loads(line) for line in journal_of(painting).read_text().splitlines()]
    return [line["stroke"] for line in lines if line["event"] == "begin"]


def wait_for_stroke(painting: Path, terminal: Terminal, count: int = 1) -> None:
    """Return once so many strokes were begun, and the last of them is on its way."""
    terminal.wait_for("stroke")
    while not journal_of(painting).exists() or len(begun(painting)) < count:
        assert terminal.listen(), terminal.said
    for _ in range(3):
        assert terminal.listen(), terminal.said


def is_stopped(painting: Path, terminal: Terminal) -> None:
    """It stopped in a stroke, said so, and goes on to paint all."""
    assert terminal.leave() == 130
    assert f"stopped, with the pen lifted; maulstick paint {painting} --resume goes on" in " ".join(
        terminal.said.split()
    )
    painted, unfinished = said_of(painting)
    assert len(painted) < 3
    assert unfinished is not None
    assert painting.with_name("painting-painted.png").exists()
    assert run("paint", painting, "--resume", "--unfinished", "again").code == 0
    assert said_of(painting) == ({1, 2, 3}, None)
    assert begun(painting).count(unfinished) == 2


@pytest.mark.parametrize("key", ["s", "\x03"])
def test_a_key_stops_it_at_once_and_it_goes_on_later(painting: Path, begin: Begun, key: str) -> None:
    terminal = begin(painting, *SLOW)
    wait_for_stroke(painting, terminal)
    terminal.press(key)
    is_stopped(painting, terminal)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP])
def test_a_signal_stops_it_at_once_and_it_goes_on_later(painting: Path, begin: Begun, number: signal.Signals) -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)  # ignored where tests run under nohup, as what they begin is
    try:
        terminal = begin(painting, *SLOW)
    finally:
        signal.signal(signal.SIGHUP, before)
    wait_for_stroke(painting, terminal)
    terminal.send(number)
    is_stopped(painting, terminal)


def test_space_holds_it_between_strokes_lets_it_go_on_and_holds_it_again_until_it_is_stopped(
    painting: Path, begin: Begun
) -> None:
    terminal = begin(painting, "--robot", "sim:real", "--speed", "60")
    wait_for_stroke(painting, terminal)
    terminal.press(" ")
    terminal.wait_for("paused after this stroke; space goes on")
    wait_until_held(painting, terminal)
    for _ in range(5):  # pictures of the progress bar, ten a second
        assert terminal.listen()
    assert said_of_running(painting) == (1, False)
    terminal.press(" ")
    terminal.wait_for("going on")
    wait_for_stroke(painting, terminal, count=2)
    terminal.press(" ")
    wait_until_held(painting, terminal)
    terminal.press("s")
    assert terminal.leave() == 130
    assert said_of(painting) == (set(begun(painting)), None)
    assert len(begun(painting)) == 2


def test_plus_and_minus_change_the_pace_which_is_shown(painting: Path, begin: Begun) -> None:
    terminal = begin(painting, "--robot", "sim:real", "--speed", "30")
    wait_for_stroke(painting, terminal)
    terminal.press("-")
    terminal.wait_for("at 90 %")
    terminal.press("++")
    terminal.wait_for("at 110 %")
    terminal.press(10 * "+")
    terminal.wait_for("at 200 %")
    assert terminal.leave() == 0
    assert said_of(painting) == ({1, 2, 3}, None)


def said_of_running(painting: Path) -> tuple[int, bool]:
    """How many strokes are painted, and whether one is under the brush, while the journal is another's."""
    events = [json.loads(line)["event"] for line in journal_of(painting).read_text().splitlines()]
    return events.count("end"), events[-1] == "begin"


def wait_until_held(painting: Path, terminal: Terminal) -> None:
    """Return once the stroke under the brush is painted."""
    while said_of_running(painting)[1]:
        assert terminal.listen(), terminal.said


def test_after_a_kill_it_asks_about_one_stroke_and_paints_the_others_once(painting: Path, begin: Begun) -> None:
    terminal = begin(painting, "--robot", "sim:real", "--speed", "100")
    wait_for_stroke(painting, terminal, count=2)
    terminal.send(signal.SIGKILL)
    assert terminal.leave() == -9
    first, second = begun(painting)
    assert said_of(painting) in (({first}, second), ({first, second}, None))
    again = begin(painting, "--resume")
    if said_of_running(painting)[1]:
        again.wait_for("stroke 2 was under the brush when the run ended")
        again.press("y\n")
    assert again.leave() == 0
    assert said_of(painting) == ({1, 2, 3}, None)
    assert sorted(begun(painting)) == [1, 2, 3]
