import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import MachineError, Remedy
from maulstick.painting.painting_file import write_painting
from maulstick.painting.svg import painting_svg
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal, journal_of
from tests.cli.conftest import contents, run
from tests.cli.paint.conftest import ALL, answers, events, painted, picture_of
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX
from tests.support.tolerances import SAME_SHEET


def test_a_painting_that_was_begun_is_not_begun_again(begun: Path) -> None:
    before = contents(begun.parent)
    ran = run("paint", begun)
    assert ran.code == 2
    assert ran.mistake == (
        f"{journal_of(begun)} says that this painting was begun; go on with --resume, or start on a new sheet with "
        "--restart"
    )
    assert contents(begun.parent) == before


@pytest.mark.parametrize(("answer", "again"), [("painted", False), ("again", True)])
def test_a_run_goes_on_when_it_is_told_what_became_of_the_unfinished_stroke(
    begun: Path, answer: str, again: bool
) -> None:
    ran = run("paint", begun, "--resume", "--unfinished", answer)
    assert ran.code == 0, ran.stderr
    assert "4 strokes" in ran.stderr if not again else "5 strokes" in ran.stderr
    assert events(begun)[3] == ("again 11" if again else "end 11")
    assert sorted(painted(begun)) == ALL
    assert events(begun).count("begin 11") == 1 + again


@pytest.mark.parametrize(
    ("typed", "again"), [("y\n", False), ("No\n", True), ("well\n\nperhaps\nyes\n", False), ("n\n", True)]
)
def test_a_run_asks_what_became_of_the_unfinished_stroke(
    begun: Path, monkeypatch: pytest.MonkeyPatch, typed: str, again: bool
) -> None:
    answers(monkeypatch, typed)
    ran = run("paint", begun, "--resume")
    assert ran.code == 0, ran.stderr
    question = "stroke 2 was under the brush when the run ended. Is it on the paper? [y/n]"
    assert ran.stderr.count(question) == typed.count("\n")
    assert events(begun).count("begin 11") == 1 + again
    assert sorted(painted(begun)) == ALL


def test_where_nobody_answers_nothing_is_done(begun: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answers(monkeypatch, "")
    before = contents(begun.parent)
    ran = run("paint", begun, "--resume")
    assert ran.code == 2
    assert ran.stderr.endswith("Nobody answers; add --unfinished painted, or --unfinished again\n")
    assert contents(begun.parent) == before


def test_a_painting_that_is_finished_has_nothing_left(painting: Path) -> None:
    assert run("paint", painting).code == 0
    before = journal_of(painting).read_bytes()
    sheet = picture_of(painting.with_name("painting-painted.png"))
    ran = run("paint", painting, "--resume")
    assert ran.code == 0
    assert ran.stderr == "all strokes are painted\n"
    assert journal_of(painting).read_bytes() == before
    assert np.abs(picture_of(painting.with_name("painting-painted.png")) - sheet).mean() < SAME_SHEET


def test_a_painting_that_was_not_begun_cannot_go_on(painting: Path) -> None:
    ran = run("paint", painting, "--resume")
    assert ran.code == 2
    assert ran.mistake == f"there is no journal {journal_of(painting)}, so nothing was begun; leave out --resume"


@pytest.mark.parametrize("content", [b"", b'{"event": "rev'])
def test_a_journal_of_which_nothing_reached_the_disk_is_no_hindrance(painting: Path, content: bytes) -> None:
    journal_of(painting).write_bytes(content)
    ran = run("paint", painting, "--resume")
    assert ran.code == 2
    assert ran.mistake == f"the journal {journal_of(painting)} is empty, so nothing was begun; leave out --resume"
    assert run("paint", painting).code == 0
    assert sorted(painted(painting)) == ALL


def test_starting_anew_keeps_the_old_journal(begun: Path) -> None:
    old = journal_of(begun).read_bytes()
    for number in (1, 2):
        assert run("paint", begun, "--restart").code == 0
        assert sorted(painted(begun)) == ALL
        kept = begun.with_name(f"painting.run{number}") / "painting.log.jsonl"
        assert kept.read_bytes() == old
        old = journal_of(begun).read_bytes()


def test_where_the_machine_is_not_reached_starting_anew_leaves_all_as_it_was(begun: Path) -> None:
    before = contents(begun.parent)
    ran = run("paint", begun, "--restart", "--robot", "grbl:/dev/null/none")
    assert ran.code != 0
    assert "cannot open the port /dev/null/none" in ran.stderr
    assert contents(begun.parent) == before


def test_a_painting_that_has_changed_since_does_not_go_on(begun: Path) -> None:
    write_painting(SIX.model_copy(update={"strokes": SIX.strokes[:3]}), begun)
    ran = run("paint", begun, "--resume", "--unfinished", "again")
    assert ran.code == 2
    assert ran.mistake.startswith(f"{begun} is not the file that {journal_of(begun)} was begun with; ")


def test_it_may_begin_with_a_later_stroke(painting: Path) -> None:
    whole = painting.with_name("whole.json")
    shutil.copy(painting, whole)
    assert run("paint", whole).code == 0
    order = painted(whole)
    ran = run("paint", painting, "--from-stroke", "4")
    assert ran.code == 0
    assert "3 strokes" in ran.stderr
    assert "3 are painted" in ran.stderr
    assert painted(painting) == order[3:]
    with Journal.open(journal_of(painting)) as journal:
        assert journal.painted == set(ALL)


@pytest.mark.parametrize("number", [-1, 0, 7])
def test_a_stroke_that_is_not_there_is_not_begun_with(painting: Path, number: int) -> None:
    ran = run("paint", painting, "--from-stroke", str(number))
    assert ran.code == 2
    assert ran.mistake == f"--from-stroke is {number}; it must be 1 to the 6 strokes"


def test_what_was_begun_on_a_machine_goes_on_there_and_nowhere_else(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    specs: list[str] = []

    def machine(spec: str, easel: object) -> Recorder:
        specs.append(spec)
        return recorder

    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", machine)
    answers(monkeypatch, "\ns\n")
    ran = run("paint", painting, "--robot", "grbl:/dev/ttyUSB0", "--speed", "40")
    assert ran.code == 130
    assert 0 < len(painted(painting)) < 6
    assert run("paint", painting, "--resume", "--robot", "sim").mistake == (
        "this painting was begun on grbl:/dev/ttyUSB0, and what is left belongs on the same sheet; leave out "
        "--robot, or start on a new sheet with --restart"
    )
    answers(monkeypatch, "\n\n\n")
    assert run("paint", painting, "--resume").code == 0
    assert sorted(painted(painting)) == ALL
    assert run("paint", painting, "--resume", "--robot", "grbl:/dev/ttyUSB1").code == 0
    assert specs == ["grbl:/dev/ttyUSB0", "grbl:/dev/ttyUSB0", "grbl:/dev/ttyUSB1"]
    lines = map(json.loads, journal_of(painting).read_text().splitlines())
    asked = [line["options"] for line in lines if line["event"] == "options"]
    assert asked[0] == {"robot": "grbl:/dev/ttyUSB0", "speed": 0.04}


def test_what_was_begun_in_the_simulator_does_not_go_on_elsewhere(painting: Path) -> None:
    assert run("paint", painting).code == 0
    ran = run("paint", painting, "--resume", "--robot", "grbl:/dev/ttyUSB0")
    assert (ran.code, "this painting was begun on sim" in ran.mistake) == (2, True)


def test_a_real_machine_begins_what_was_only_rehearsed(
    painting: Path, recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: recorder)
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
        journal.write_options({"robot": "sim:real"})
        journal.begin(10)
    assert run("paint", painting).code == 2, "on the simulated easel it was begun"
    answers(monkeypatch, "\n\n\n")
    assert run("paint", painting, "--robot", "grbl:/dev/ttyUSB0").code == 0
    assert sorted(painted(painting)) == ALL
    assert (painting.parent / "painting.run1" / journal_of(painting).name).is_file()
    assert run("paint", painting, "--robot", "grbl:/dev/ttyUSB0").code == 2, "it is on paper now"


def test_a_dry_run_says_of_a_painting_that_was_begun_what_the_run_would(calibrated: Path) -> None:
    assert run("paint", calibrated).code == 0
    refused = run("paint", calibrated)
    assert (refused.code, "says that this painting was begun" in refused.mistake) == (2, True)
    assert run("paint", calibrated, "--dry-run").mistake == refused.mistake
    for words in (("--restart",), ("--resume",)):
        assert run("paint", calibrated, "--dry-run", *words).code == 0


@pytest.mark.parametrize("words", [("--dry-run",), ()])
def test_a_machine_that_fails_before_anything_is_painted_leaves_nothing_to_go_on_with(
    calibrated: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    def lost(robot: Recorder) -> None:
        raise MachineError("the line went silent; check the cable", Remedy.GO_ON)

    monkeypatch.setattr(Recorder, "_connect", lost)
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: Recorder())
    ran = run("paint", calibrated, "--robot", "grbl:/dev/ttyUSB0", *words)
    assert ran.mistake == "the line went silent; check the cable"
    assert not journal_of(calibrated).exists()


def test_a_machine_that_counts_its_steps_asks_where_its_pen_stands_before_it_goes_on(
    calibrated: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    easel = calibrated.with_name("easel.json")
    deep = Easel(corner=(0, SIX.sheet.height, 0), right=(1, 0, 0), down=(0, -1, 0), deepest=2e-3)
    easel.write_text(deep.model_dump_json())
    stands = "0 mm from the left and {:.0f} mm from the upper edge of the sheet, and 10 mm above it"
    asked = f"see that the pen stands {stands} (elsewhere: "
    answers(monkeypatch, "\n" * 9)
    with FakeGrbl(faults={60: "ALARM:1"}) as device:
        ran = run("paint", calibrated, "--robot", f"grbl:{device.port}", "--speed", "20", "--easel", easel)
        assert "a limit switch was hit and its position is lost" in ran.stderr
        assert "see that the pen stands" not in ran.stderr
    with FakeGrbl(origin=(0.0, 0.0, -10.0)) as restarted:
        robot = f"grbl:{restarted.port}"
        ran = run("paint", calibrated, "--resume", "--unfinished", "again", "--robot", robot)
    assert ran.code == 0, ran.stderr
    assert asked.format(1e3 * SIX.sheet.height) in ran.stderr
    assert sorted(painted(calibrated)) == ALL


def test_a_file_does_not_go_on_with_the_journal_of_another_nor_is_that_moved_away(painting: Path) -> None:
    other = painting.with_suffix(".svg")
    other.write_text(painting_svg(SIX))
    assert run("paint", painting, "--from-stroke", "4").code == 0
    before = journal_of(painting).read_bytes()
    for words in ((), ("--resume",), ("--resume", "--dry-run"), ("--restart",)):
        ran = run("paint", other, *words)
        assert ran.code == 2
        assert ran.mistake == (
            f"{journal_of(other)} is the journal of painting.json; name that one, or give painting.svg another name"
        )
    assert journal_of(painting).read_bytes() == before
    assert run("paint", painting, "--resume").stderr == "all strokes are painted\n"
    named = other.rename(painting.with_name("drawing.svg"))
    assert run("paint", named).code == 0


@pytest.mark.parametrize("damaged", [b"\x00\n", b'{"event": "begin", "stroke": 1}\n', b'{"event": "revis'])
def test_a_journal_that_does_not_say_whose_it_is_is_moved_away_by_restart(painting: Path, damaged: bytes) -> None:
    journal_of(painting).write_bytes(damaged)
    assert run("paint", painting, "--restart").code == 0
    assert (painting.parent / "painting.run1" / journal_of(painting).name).read_bytes() == damaged
