"""Pauses, refills, copies and where to begin, from the command line."""

import io
import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from maulstick.cli.paint.operator import TerminalOperator
from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import write_painting
from maulstick.robot.execute import PaintProgress
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.pace import Pace
from maulstick.storage.arrays import Floats
from tests.cli.conftest import run
from tests.cli.paint.conftest import ALL, answers, painted
from tests.robot.test_ebb import until_true
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import line, painting_of

GRBL = ("--robot", "grbl:/dev/ttyUSB0")
TEN = painting_of(line(i, (0.01, 0.003 * i), (0.03, 0.003 * i)) for i in range(1, 11))
"""Ten strokes of 20 mm of one paint."""


@pytest.fixture
def ten(tmp_path: Path) -> Path:
    write_painting(TEN, tmp_path / "ten.json")
    return tmp_path / "ten.json"


@pytest.fixture
def penned(tmp_path: Path) -> Path:
    """The same with a pen, which needs no depth."""
    write_painting(painting_of(TEN.strokes, [load_brush("fineliner")]), tmp_path / "penned.json")
    return tmp_path / "penned.json"


class Person(io.StringIO):
    """Someone who presses Enter, after whatever a test does at that moment."""

    def __init__(self, at: Callable[[int], None]) -> None:
        super().__init__()
        self.asked = 0
        self._at = at

    def readline(self, size: int | None = -1, /) -> str:
        self.asked += 1
        self._at(self.asked)
        return "\n"


def painted_by(painting: Path, copy: int) -> set[int]:
    return Journal.read(journal_of(painting, copy)).painted


def test_it_begins_where_a_pen_is_put_in(painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch) -> None:
    answers(monkeypatch, "\n")
    ran = run("paint", painting, *GRBL, "--from-pen", "2")
    assert ran.code == 0, ran.stderr
    assert len(painted(painting)) == recorder.said.count("stroke") == 3
    assert "put in the marker with the paint #1a33b2" in ran.stderr
    assert "#cc1a1a, and" not in ran.stderr


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--from-pen", "3"), "--from-pen is 3; it must be 1 to 2, the times that a pen is put in"),
        (("--from-pen", "1", "--from-stroke", "1"), "--from-stroke and --from-pen both say where to begin"),
        (("--pause-at", "7"), "--pause-at is 7; it must be 1 to the 6 strokes"),
        (
            ("--refill-after", "20"),
            "--refill-after is '20'; it must be metres or minutes of drawing above 0",
        ),
        (("--refill-after", "0m"), "it must be metres or minutes of drawing above 0"),
        (("--refill-at", "-20,50"), "--refill-at is where a pen is refilled; add --refill-after"),
        (("--refill-after", "2m", "--refill-at", "left"), "--refill-at is 'left'; it must be two numbers in mm"),
        (("--refill-after", "2m", "--refill-at", "nan,1"), "two lengths on the canvas"),
        (("--refill-after", "2m", "--refill-at", "-900,0", *GRBL), "the machine's x is -900 mm"),
        (
            ("--refill-after", "2m", "--tray", "tray.json"),
            "a tray refills its brush by itself; leave out --refill",
        ),
        (("--copies", "0"), "--copies is 0; it must be 1 to 1000"),
        (("--copies", "2"), "the simulated easel has one sheet; leave out --copies"),
        (("--copies", "2", "--replan", "2", *GRBL), "what a camera sees belongs to one sheet; leave out --copies"),
        (("--pause-at", "2", "--replan", "2"), "strokes get other numbers when they are planned again"),
    ],
)
def test_what_does_not_go_together_is_refused_and_nothing_moves(
    painting: Path, recorder: Recorder, words: tuple[str, ...], text: str
) -> None:
    ran = run("paint", painting, *words)
    assert ran.code == 2
    assert text in ran.stderr
    assert set(recorder.said) <= {"close"}
    assert not journal_of(painting).exists()


def test_it_pauses_before_strokes_with_the_pen_lifted(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[int, bool]] = []
    monkeypatch.setattr("sys.stdin", Person(lambda asked: seen.append((len(painted(ten)), recorder.down))))
    ran = run("paint", ten, *GRBL, "--pause-at", "3", "--pause-at", "9")
    assert ran.code == 0, ran.stderr
    assert seen == [(2, False), (8, False)]
    assert "do what the pause before stroke 3 is for, and press Enter" in ran.stderr


def test_a_simulated_pen_refills_itself_and_waits_in_pauses(ten: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    person = Person(lambda asked: None)
    monkeypatch.setattr("sys.stdin", person)
    assert run("paint", ten, "--refill-after", "0.07m", "--pause-at", "3").code == 0
    assert person.asked == 1


@pytest.mark.parametrize("after", ["0.07m", "0.07 m"])
def test_a_pen_is_refilled_aside_and_the_rest_is_painted(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch, after: str
) -> None:
    seen: list[tuple[int, bool, float]] = []
    monkeypatch.setattr(
        "sys.stdin", Person(lambda asked: seen.append((len(painted(ten)), recorder.down, recorder.place[0])))
    )
    ran = run("paint", ten, *GRBL, "--refill-after", after, "--refill-at", "-20,10")
    assert ran.code == 0, ran.stderr
    assert seen == [(n, False, pytest.approx(-0.02)) for n in (3, 6, 9)]
    assert "refill or clean the marker with the paint #cc1a1a, and press Enter" in ran.stderr


def test_a_stop_at_any_prompt_is_journaled_and_goes_on_with_the_same_stops(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Person(lambda asked: os.kill(os.getpid(), signal.SIGINT)))
    ran = run("paint", ten, *GRBL, "--refill-after", "0.07m", "--pause-at", "9")
    assert ran.code == 130
    assert f"stopped, with the pen lifted; maulstick paint {ten} --resume goes on" in ran.stderr
    assert len(painted(ten)) == 3
    assert not recorder.down
    at: list[int] = []
    monkeypatch.setattr("sys.stdin", Person(lambda asked: at.append(len(painted(ten)))))
    assert run("paint", ten, "--resume").code == 0
    assert at == [3, 6, 8, 9], "nobody knows whether it was refilled, so it is first; then pause and refills"
    assert sorted(painted(ten)) == list(range(1, 11))


def test_copies_have_a_sheet_and_a_journal_each(ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[int, bool, float]] = []
    monkeypatch.setattr(
        "sys.stdin",
        Person(lambda asked: seen.append((recorder.said.count("stroke"), recorder.down, recorder.place[0]))),
    )
    ran = run("paint", ten, *GRBL, "--copies", "3")
    assert ran.code == 0, ran.stderr
    assert seen == [(10, False, 0.05), (20, False, 0.05)], "it is where it stood at first"
    assert "put in a new sheet for copy 2 of 3, and press Enter" in ran.stderr
    assert [painted_by(ten, copy) for copy in (1, 2, 3)] == [set(range(1, 11))] * 3
    assert run("paint", ten, *GRBL).code == 2, "it was begun"
    for own in ("ten.r1.json", "ten.r1.png", "ten.r2d2.png", "ten.r2.notes.txt", "ten.copy2d.log.jsonl"):
        ten.with_name(own).touch()
    assert run("paint", ten, *GRBL, "--restart").code == 0
    assert not journal_of(ten, 2).exists()
    assert {path.name for path in (ten.parent / "ten.run1").iterdir()} == {
        "ten.log.jsonl", "ten.copy2.log.jsonl", "ten.copy3.log.jsonl", "ten.r1.json", "ten.r1.png",
    }, "files that no run writes stay"  # fmt: skip


def test_a_machine_waits_for_sheets_where_the_first_run_began_wherever_it_was_stopped(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = recorder.stands
    monkeypatch.setattr("sys.stdin", Person(lambda asked: os.kill(os.getpid(), signal.SIGINT)))
    assert run("paint", ten, *GRBL, "--copies", "2", "--pause-at", "5").code == 130
    recorder.stands = next(path[-1] for what, path in reversed(recorder.commands) if what == "lift")
    assert recorder.stands[0] != pytest.approx(first[0])
    seen: list[Floats] = []
    monkeypatch.setattr("sys.stdin", Person(lambda asked: seen.append(recorder.place)))
    assert run("paint", ten, "--resume").code == 0
    new_sheet = seen[1]  # after the pause that was stopped at
    assert new_sheet[:2] == pytest.approx(first[:2])


def test_the_next_copy_is_drawn_at_the_pace_of_the_one_before(ten: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    paces: list[Pace] = []
    shown: list[int] = []

    def watch(operator: TerminalOperator, progress: PaintProgress) -> None:
        if not paces:
            operator.pace.change(-3)
        paces.append(operator.pace)
        shown.append(operator.pace.percent)

    monkeypatch.setattr(TerminalOperator, "watch", watch)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: Recorder())
    monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
    assert run("paint", ten, *GRBL, "--copies", "2").code == 0
    assert len(set(map(id, paces))) == 2
    assert set(shown) == {70}


def test_paint_is_not_asked_for_again_where_the_next_copy_begins_with_it(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers(monkeypatch, 9 * "\n")
    ran = run("paint", painting, *GRBL, "--copies", "2")
    assert ran.code == 0, ran.stderr
    assert ran.stderr.count("put in the marker") == 4
    assert painted_by(painting, 2) == set(ALL)


def test_another_copy_of_a_painting_that_is_finished_begins_where_the_pen_stands(
    penned: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeGrbl(pace=1000.0) as device:
        monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
        assert run("paint", penned, "--robot", f"grbl:{device.port}").code == 0
        dry = run("paint", penned, "--resume", "--copies", "3", "--dry-run")
        assert "10 strokes, 200 mm, 1 paint, about 1 min; then 1 more sheet" in dry.stderr
        person = Person(lambda asked: None)
        monkeypatch.setattr("sys.stdin", person)
        ran = run("paint", penned, "--resume", "--copies", "2")
    assert ran.code == 0, ran.stderr
    assert person.asked == 2
    assert ran.stderr.index("see that the pen stands") < ran.stderr.index("put in a new sheet for copy 2 of 2")
    assert "all strokes are painted" not in ran.stderr
    assert painted_by(penned, 2) == set(range(1, 11))


@pytest.mark.parametrize("how", ["s", "ctrl-c"])
def test_a_stop_where_the_pen_stands_elsewhere_moves_nothing_and_keeps_the_journal(
    penned: Path, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    with Journal.open(journal_of(penned)) as journal:
        journal.revise(penned)
        journal.begin(1)
        journal.end(1)

    def stop(asked: int) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    with FakeGrbl(pace=1000.0) as device:
        monkeypatch.setattr("sys.stdin", Person(stop) if how == "ctrl-c" else io.StringIO("s\n"))
        ran = run("paint", penned, "--resume", "--robot", f"grbl:{device.port}")
        assert {(x, y) for x, y, _, _ in device.reached} <= {(0, 0)}
        assert device.place[2] > 0
    assert ran.code == 130
    assert "see that the pen stands" in ran.stderr
    assert "s and Enter stop" in ran.stderr
    assert painted_by(penned, 1) == {1}
    assert Journal.read(journal_of(penned)).unfinished is None


def test_a_grbl_that_is_stopped_while_it_waits_is_left_idle(penned: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with FakeGrbl(pace=1000.0) as device:
        monkeypatch.setattr("sys.stdin", Person(lambda asked: os.kill(os.getpid(), signal.SIGINT)))
        ran = run("paint", penned, "--robot", f"grbl:{device.port}", "--pause-at", "3")
        lines = len(device.lines)
        assert until_true(lambda: device.state == "Idle")
        assert (device.holds, len(device.lines)) == (1, lines)
    assert ran.code == 130
    assert painted_by(penned, 1) == {1, 2}


def test_a_copy_of_an_earlier_run_whose_first_journal_is_gone_is_not_one_of_the_next_run(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
    assert run("paint", ten, *GRBL, "--copies", "2").code == 0
    journal_of(ten).unlink()
    answers(monkeypatch, "s\n")
    assert run("paint", ten, *GRBL, "--pause-at", "4").code == 130
    monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
    assert run("paint", ten, "--resume").code == 0
    assert sorted(painted(ten)) == list(range(1, 11))
    assert not journal_of(ten, 2).exists()
    assert (ten.parent / "ten.run1" / "ten.copy2.log.jsonl").exists()


def test_a_painting_that_would_share_the_journal_of_a_copy_of_another_is_not_begun(
    ten: Path, recorder: Recorder
) -> None:
    other = ten.rename(ten.with_name("ten.copy2.json"))
    told = "a further copy of ten.json would have the same journal as ten.copy2.json; give ten.copy2.json another name"
    assert run("paint", other, *GRBL).mistake == told
    assert not journal_of(other).exists()


@pytest.mark.parametrize(("at", "strokes", "copies"), [(1, 10, 2), (2, 20, 3)])
def test_a_run_that_was_stopped_goes_on_in_the_right_copy(
    ten: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch, at: int, strokes: int, copies: int
) -> None:
    def stop(asked: int) -> None:
        if asked == at:
            os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr("sys.stdin", Person(stop))
    assert run("paint", ten, *GRBL, "--copies", "3").code == 130
    assert recorder.said.count("stroke") == strokes
    person = Person(lambda asked: None)
    monkeypatch.setattr("sys.stdin", person)
    ran = run("paint", ten, "--resume")
    assert ran.code == 0, ran.stderr
    assert f"put in a new sheet for copy {copies} of 3" in ran.stderr, "nobody knows whether it was"
    assert person.asked == 4 - copies
    assert recorder.said.count("stroke") == 30
    assert painted_by(ten, 3) == set(range(1, 11))


def test_a_run_that_was_stopped_in_a_copy_asks_for_no_new_sheet_for_it(
    ten: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(what: str) -> None:
        if what == "stroke" and robot.said.count("stroke") == 13:
            os.kill(os.getpid(), signal.SIGINT)

    robot = Recorder(before=interrupt)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
    assert run("paint", ten, *GRBL, "--copies", "2").code == 130
    assert len(painted_by(ten, 2)) == 3
    robot.commands.append(("stroke", robot.commands[0][1]))  # nobody interrupts again
    ran = run("paint", ten, "--resume", "--unfinished", "painted", "--dry-run")
    assert "7 strokes" in ran.stderr
    person = Person(lambda asked: None)
    monkeypatch.setattr("sys.stdin", person)
    assert run("paint", ten, "--resume", "--unfinished", "painted").code == 0
    assert person.asked == 0
    assert painted_by(ten, 2) == set(range(1, 11))


def test_a_dry_run_says_how_many_sheets_follow(ten: Path, recorder: Recorder) -> None:
    ran = run("paint", ten, *GRBL, "--copies", "5", "--dry-run")
    assert ran.stderr == "10 strokes, 200 mm, 1 paint, about 1 min; then 4 more sheets\n"


def test_the_pen_that_draws_is_named_and_kept_for_later(ten: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    note = "note: it was planned for the brush marker, whose width varies; plan it for micron-01 to have it so"
    answers(monkeypatch, "")
    ran = run("paint", ten, "--pen", "micron-01", "--pause-at", "2")
    assert ran.code == 2, "nobody is there"
    assert note in ran.stderr
    monkeypatch.setattr("sys.stdin", Person(lambda asked: None))
    again = run("paint", ten, "--resume")
    assert again.code == 0
    assert note in again.stderr
    assert "there is no pen 'quill'; there are: " in run("paint", ten, "--restart", "--pen", "quill").mistake
