"""Failures on the way: the machine stops with its pen lifted, nothing is lost, one sentence says what to do.

Where that is seen at the command line without a camera, the tests are in tests/cli/paint/test_bad_days.py.
"""

import os
from functools import partial
from pathlib import Path
from unittest.mock import patch

import pytest

from maulstick.errors import InputError, MachineError, OutputError
from maulstick.jobs.paint import camera_loop
from maulstick.jobs.paint.simulation import Simulation
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.picture import encode_png
from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.easel import Pen, write_easel
from maulstick.robot.execute import execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.limits import Limits
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import routine
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.storage.files import file_sum
from tests.cli.conftest import Ran, run
from tests.support.cli.webcam import Event, after, put_webcam, unplug
from tests.support.planned import STROKES, picture, planned
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.recorder import EASEL, Recorder
from tests.support.robot.small_paintings import HEIGHT, SIX, WIDTH, line, painting_of

EVERY = 12
SERVO, PEN_DOWN = Pen(up=500, down=700, seconds=0.02), "M3S700"
ALL = set(range(10, 16))


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a picture and its painting, in which commands run; planning again takes few steps."""
    monkeypatch.chdir(tmp_path)
    put_webcam(monkeypatch)
    monkeypatch.setattr(camera_loop, "replanned", partial(camera_loop.replanned, steps=4))
    (tmp_path / "picture.png").write_bytes(encode_png(picture()))
    known = {"image": "picture.png", "image_sha256": file_sum(tmp_path / "picture.png")}
    write_painting(
        planned().model_copy(update={"provenance": planned().provenance.model_copy(update=known)}),
        tmp_path / "painting.json",
    )
    return tmp_path


def replan(*options: str) -> Ran:
    return run("paint", "painting.json", "--replan", str(EVERY), "--picture", "picture.png", *options)


def painted() -> list[int]:
    """Ids of the painted strokes in order, by the journal."""
    with Journal.open(Path("painting.log.jsonl")) as journal:
        assert journal.unfinished is None
        return sorted(journal.painted)


def goes_on_to_the_end() -> None:
    before = painted()
    ran = replan("--resume")
    assert ran.code == 0, ran.stderr
    with Journal.open(Path("painting.log.jsonl")) as journal:
        whole = read_painting(journal.painting())
    assert painted() == sorted(stroke.id for stroke in whole.strokes)
    assert set(before) <= set(painted())


# The camera.


def darken(simulation: Simulation, camera: SimulatedCamera) -> None:
    camera.black()


def hide_two(simulation: Simulation, camera: SimulatedCamera) -> None:
    camera.cover(0, 3)


def take_away(simulation: Simulation, camera: SimulatedCamera) -> None:
    camera.move_paper(0.5, 0.0)


@pytest.mark.parametrize(
    ("event", "sentence"),
    [
        (unplug, "the simulated camera sends no picture; plug it in again, and go on"),
        (darken, "the photograph is black; take off the lens cap or switch on the light, and go on"),
        (
            hide_two,
            "only 2 of the 4 tags are seen (1, 2); uncover and light 0 (upper left), 3 (lower left), and go on",
        ),
        (take_away, "the sheet is not seen where it lay; put it back, or take away what hides it, and go on"),
    ],
)
def test_a_camera_that_cannot_see_stops_it_and_it_goes_on_when_that_is_mended(
    here: Path, monkeypatch: pytest.MonkeyPatch, event: Event, sentence: str
) -> None:
    with monkeypatch.context() as context:
        put_webcam(context, after(1, event))
        ran = replan()
    assert ran.code == 3
    assert ran.stderr.splitlines()[-1] == f"maulstick: {sentence}"
    assert len(painted()) == EVERY
    goes_on_to_the_end()


def test_a_corner_tag_that_is_hidden_is_said_and_does_not_matter(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_webcam(monkeypatch, after(1, lambda simulation, camera: camera.cover(2)))
    ran = replan()
    assert ran.code == 0
    assert "note: tag 2 is hidden; the other three do" in ran.stderr.splitlines()
    assert len(painted()) <= STROKES


def test_without_a_camera_that_sees_the_bare_sheet_nothing_is_begun(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as context:
        put_webcam(context, unplug)
        assert replan().code == 3
    assert not Path("painting.log.jsonl").exists()
    assert replan().code == 0


# The disk.


def test_a_disk_that_is_full_when_a_revision_is_written_loses_nothing(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as context:

        def full(painting: Painting, path: Path) -> None:
            raise OutputError(f"cannot write {path}: No space left on device")

        context.setattr(camera_loop, "write_painting", full)
        ran = replan()
    assert ran.code == 1
    assert ran.stderr.splitlines()[-1] == (
        f"maulstick: cannot write {Path('painting.r1.json')}: No space left on device"
    )
    assert len(painted()) == EVERY
    goes_on_to_the_end()


@pytest.mark.parametrize("half", [False, True])
def test_a_disk_that_is_full_while_journaling_stops_the_machine_with_the_pen_lifted(tmp_path: Path, half: bool) -> None:
    write_painting(SIX, tmp_path / "painting.json")
    path, robot = journal_of(tmp_path / "painting.json"), Recorder()
    writes, write = 0, os.write

    def full(file: int, content: bytes) -> int:
        nonlocal writes
        writes += 1
        if writes < 4:
            return write(file, content)
        if half:
            return write(file, content[: len(content) // 2])
        raise OSError(28, "No space left on device")

    with Journal.open(path) as journal:
        journal.revise(tmp_path / "painting.json")
        actions = routine(SIX, EASEL, robot.limits)
        with patch("os.write", full), robot, pytest.raises(OutputError) as caught:
            execute(actions, robot, journal, lambda ask: None)
    assert str(caught.value) == (
        f"cannot write {path}: No space left on device; mend that; then go on with paint(..., resume=True)"
    )
    assert not robot.down
    assert robot.said.count("stroke") == robot.said.count("lift")
    with Journal.open(path) as journal, robot:
        assert journal.unfinished is not None, "its end was not written"
        assert journal.painted == {10}
        journal.end(journal.unfinished)
        actions = routine(SIX, EASEL, robot.limits, done=journal.painted)
        execute(actions, robot, journal, lambda ask: None)
        assert journal.painted == ALL
    assert robot.said.count("stroke") == 6


# The machine.


FAULTS = {
    "noise": r"there is noise on the line .*; check cable and ground; then go on with paint\(\.\.\., resume=True\)",
    "lost": r"went silent; check cable and power; then go on with paint\(\.\.\., resume=True\)",
    "silent": r"went silent; check cable and power; then go on with paint\(\.\.\., resume=True\)",
    "closed": r"went silent; check cable and power; then go on with paint\(\.\.\., resume=True\)",
    "error:20": "with error 20: ",
    "ALARM:1": r"alarm 1: .*; home it with maulstick machine, or without switches",
}


@pytest.mark.parametrize(("fault", "at"), [*((fault, 25) for fault in FAULTS), ("noise", 40)])
def test_a_line_with_noise_a_lost_cable_and_an_alarm_stop_it_and_each_stroke_is_painted_once(
    tmp_path: Path, fault: str, at: int
) -> None:
    write_painting(SIX, tmp_path / "painting.json")
    path = journal_of(tmp_path / "painting.json")
    with FakeGrbl(faults={at: fault}) as device, Journal.open(path) as journal:
        journal.revise(tmp_path / "painting.json")
        with Grbl(device.port, SERVO, patience=2.0 if FAULTS[fault].startswith("went silent") else 30.0) as robot:
            actions = routine(SIX, robot.easel(WIDTH, HEIGHT), robot.limits)
            with pytest.raises(MachineError, match=FAULTS[fault]) as caught:
                execute(actions, robot, journal, lambda ask: None)
        before, unfinished = set(journal.painted), journal.unfinished
        drawn = device.lines.count(PEN_DOWN)
        if fault not in ("closed", "silent"):
            assert device.servo == SERVO.up
    assert "\n" not in str(caught.value)
    assert not isinstance(caught.value, StoppedError)
    assert len(before) + (unfinished is not None) == drawn
    with FakeGrbl() as device, Journal.open(path) as journal, Grbl(device.port, SERVO) as robot:
        assert (journal.painted, journal.unfinished) == (before, unfinished)
        if unfinished is not None:
            journal.again(unfinished)
        actions = routine(SIX, robot.easel(WIDTH, HEIGHT), robot.limits, done=journal.painted)
        execute(actions, robot, journal, lambda ask: None)
        assert journal.painted == ALL
        assert device.lines.count(PEN_DOWN) == len(ALL - before)


def test_a_machine_in_its_error_state_does_not_begin(tmp_path: Path) -> None:
    with FakeGrbl(locked=True) as device, pytest.raises(MachineError) as caught, Grbl(device.port, SERVO):
        pass
    assert "\n" not in str(caught.value)
    assert not device.reached


# The sheet and the folder.


def test_a_plan_for_a_larger_sheet_than_the_machine_reaches_is_refused_before_anything_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    large = painting_of([line(0), line(1, (0.1, 0.2), (0.9, 0.2)), line(2, (0.1, 0.1), (0.7, 0.1))], size=(1.0, 0.5))
    write_painting(large, Path("large.json"))
    sentence = (
        r"stroke 1: the machine's x is 900 mm; it must be -100 to 200 mm: 700 mm less far (and 1 more like it); "
        "lay the sheet elsewhere, plan for a smaller one, or turn or scale an SVG with rotate or size"
    )
    with Recorder() as robot:
        with pytest.raises(InputError) as caught:
            routine(large, EASEL, robot.limits)
        assert str(caught.value) == sentence
        assert robot.commands == []
    reach = Limits(
        lower=(-0.1, -0.6, -0.02), upper=(0.2, 0.1, 0.1), speed=1, climb=1, acceleration=1, varies_pressure=True
    )
    write_easel(EASEL.model_copy(update={"limits": reach}), Path("easel.json"))
    ran = run("paint", "large.json", "--easel", "easel.json")
    assert ran.code == 2
    assert (
        "less far (and 1 more like it); lay the sheet elsewhere, plan for a smaller one, or turn or scale an SVG with "
        "--rotate or --size" in ran.mistake
    )
    assert not journal_of(Path("large.json")).exists()


def test_two_calibrations_in_one_folder_do_not_draw_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    put_webcam(monkeypatch, unplug)
    command = ("calibrate", "brush", "--name", "mine", "--strokes", "5", "--size", "100x80mm")
    assert run(*command).code == 3
    path = Path("calibration/practice.log.jsonl")
    with Journal.open(path):
        ran = run(*command)
    assert (ran.code, ran.mistake) == (
        2, f"another maulstick paints by {path}; wait until it has finished, or stop it",
    )  # fmt: skip


def test_two_runs_of_one_painting_with_cameras_do_not_paint_at_once(here: Path) -> None:
    with Journal.open(Path("painting.log.jsonl")) as journal:
        journal.revise(Path("painting.json"))
        ran = replan("--resume")
        assert ran.code == 2
        assert "another maulstick paints by painting.log.jsonl" in ran.mistake
        assert journal.painted == set()
