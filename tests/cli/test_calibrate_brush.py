import os
from collections import Counter
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.brush_fit import fit as fitting
from maulstick.brush_fit.fit import Fit
from maulstick.brush_fit.trials import Trials
from maulstick.calibration import collect as collecting
from maulstick.errors import InputError, MachineError, OutputError, Remedy
from maulstick.jobs.paint.simulation import Simulation
from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import read_painting
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.journal import Journal
from maulstick.robot.limits import Limits
from maulstick.robot.routine import routine
from tests.cli.conftest import Ran, run
from tests.plots.test_brush_fit_plot import a_fit
from tests.support.cli.webcam import after, put_webcam, unplug

WORDS = ("--name", "mine", "--strokes", "5", "--size", "100x80mm")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the commands run; own brushes are kept under it, and a fit takes no time."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.chdir(tmp_path)

    def fit_brush(
        trials: Trials, pixels_per_metre: float, name: str, *, depth: tuple[float, float], **_: object
    ) -> Fit:
        assert len(trials) == 5
        found = a_fit()
        return replace(found, brush=found.brush.model_copy(update={"name": name, "depth": depth}))

    monkeypatch.setattr(fitting, "fit_brush", fit_brush)
    put_webcam(monkeypatch)
    return tmp_path


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Counter[int]:
    """How often each stroke was finished."""
    counted: Counter[int] = Counter()
    end = Journal.end

    def count(journal: Journal, stroke: int) -> None:
        counted[stroke] += 1
        end(journal, stroke)

    monkeypatch.setattr(Journal, "end", count)
    return counted


def calibrate(*words: str) -> Ran:
    return run("calibrate", "brush", *WORDS, *words)


@pytest.mark.parametrize(("words", "numbers"), [((), [0, 1, 2, 3, 4, 5]), (("--photographs", "one"), [0, 5])])
def test_strokes_are_drawn_and_photographed_and_a_brush_is_fitted_to_them(
    drawn: Counter[int], words: tuple[str, ...], numbers: list[int]
) -> None:
    ran = calibrate(*words)
    assert ran.code == 0, ran.stderr
    assert drawn == dict.fromkeys(range(5), 1)
    assert ran.stdout.splitlines()[-1] == "maulstick plan photo.jpg --brush mine"
    folder = Path("calibration")
    assert sorted(path.name for path in folder.glob("sheet-*")) == [f"sheet-{number:04}.png" for number in numbers]
    sheet, trials = read_painting(folder / "practice.json"), Trials.open(folder / "trials")
    assert (sheet.sheet.width, sheet.sheet.height) == (0.1, 0.08)
    assert (trials.medium, trials.depth) == ("marker", load_brush("mine").depth)
    for trial in trials:
        assert trial.before is not None
        assert np.abs(trial.after - trial.before).max() > 0.3, "its stroke is on it"
        assert trial.before.mean() > 0.9, "and no other"


def test_a_brush_that_is_there_is_not_replaced_and_a_finished_folder_is_only_fitted_again(drawn: Counter[int]) -> None:
    assert calibrate().code == 0
    ran = calibrate()
    assert ran.code == 1
    assert "mine" in ran.mistake
    for words in (("--overwrite",), ("--name", "another-pen")):
        ran = calibrate(*words)
        assert ran.code == 0
        assert ran.stderr.splitlines()[0] == (
            "note: all strokes in calibration were drawn before, and are only fitted again; to draw others, choose "
            "another --out"
        )
    assert drawn == dict.fromkeys(range(5), 1)


@pytest.mark.parametrize("photographs", [1, 2])
def test_with_the_camera_plugged_in_again_the_same_words_go_on(
    drawn: Counter[int], monkeypatch: pytest.MonkeyPatch, photographs: int
) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, after(photographs, unplug))
        ran = calibrate()
        assert ran.code == 3
        assert ran.stderr.splitlines()[-1] == (
            "maulstick: the simulated camera sends no picture; plug it in again, and go on"
        )
    assert calibrate().code == 0
    assert drawn == dict.fromkeys(range(5), 1)


def test_with_the_machine_mended_the_same_words_go_on_and_no_others(monkeypatch: pytest.MonkeyPatch) -> None:
    def lost(robot: object, path: object, speed: object) -> None:
        raise MachineError("the line went silent; check the cable", Remedy.GO_ON)

    with monkeypatch.context() as patch:
        patch.setattr("maulstick.robot.simulated.easel.SimulatedEasel._stroke", lost)
        ran = calibrate()
    assert ran.code == 3
    assert ran.stderr.splitlines()[-2:] == [
        "stopped, with the pen lifted; the same command goes on",
        "maulstick: the line went silent; check the cable",
    ]


def test_a_machine_that_counts_its_steps_asks_where_its_pen_stands_before_it_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[str] = []
    monkeypatch.setattr("maulstick.robot.simulated.easel.SimulatedEasel.counts_steps", True)
    monkeypatch.setattr(Simulation, "ask", lambda simulation, action: asked.append(action.message))
    with monkeypatch.context() as patch:
        put_webcam(patch, after(1, unplug))
        assert calibrate().code == 3
    assert not any("see that the pen stands" in message for message in asked), "it began at home"
    assert calibrate().code == 0
    assert sum(message.startswith("see that the pen stands") for message in asked) == 1


def test_a_sheet_that_was_moved_on_the_way_is_to_be_put_back(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, after(2, unplug))
        assert calibrate().code == 3
    with monkeypatch.context() as patch:
        put_webcam(patch, lambda simulation, camera: camera.move_paper(0.008, 0.0))
        ran = calibrate()
        assert ran.code == 3
        assert ran.stderr.splitlines()[-1] == (
            "maulstick: strokes are learned by their places, and the sheet has moved; put it back, and go on"
        )
    assert calibrate().code == 0


def test_a_hidden_tag_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    put_webcam(monkeypatch, lambda simulation, camera: camera.cover(1))
    ran = calibrate()
    assert ran.code == 0
    assert "note: tag 1 is hidden; the other three do" in ran.stderr


def test_trials_that_were_not_all_written_are_cut_out_again(
    drawn: Counter[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        append = Trials.append

        def full(trials: Trials, path: NDArray[np.float64], after: NDArray[np.float32]) -> None:
            if len(trials) == 3:
                raise OutputError("cannot write: No space left on device")
            append(trials, path, after)

        patch.setattr(collecting.Trials, "append", full)
        assert calibrate().code == 1
    assert not Path("calibration/trials").exists()
    assert calibrate().code == 0
    assert drawn == dict.fromkeys(range(5), 1)


def test_a_stroke_that_was_under_the_brush_is_asked_about(monkeypatch: pytest.MonkeyPatch, drawn: Counter[int]) -> None:
    with monkeypatch.context() as patch:

        def full(journal: Journal, stroke: int) -> None:
            raise OutputError("cannot write: No space left on device")

        patch.setattr(Journal, "end", full)
        assert calibrate().code == 1
    with open(os.devnull) as nobody, monkeypatch.context() as patch:
        patch.setattr("sys.stdin", nobody)
        ran = calibrate()
        assert ran.code == 2
        assert "stroke 1 was under the brush. Is it on the paper?" in ran.stderr
    with monkeypatch.context() as patch:
        patch.setattr(
            import_module("maulstick.cli.calibrate.brush"), "confirm", lambda console, question, otherwise: True
        )
        assert calibrate().code == 0
    assert drawn == dict.fromkeys(range(5), 1)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--strokes", "4"), "--strokes is 4; it must be 5 to 1000"),
        (
            ("--robot", "grbl:/dev/null"),
            "a camera over the sheet is needed; name it with --camera usb:0, or folder:PATH",
        ),
        (("--camera", "usb:0"), "the simulated easel has a camera of its own; leave out --camera"),
        (("--robot", "simple"), "there is no machine 'simple'; there are: "),
        (("--like", "spoon"), "there is no brush 'spoon'"),
        (("--style", "nobody"), "there is no style 'nobody'"),
        (("--size", "30x30mm"), "of 5 strokes fit on a sheet of 30 x 30 mm"),
        (("--easel", "none.json"), "there is no easel none.json; check its name and folder"),
        (("--name", "marker"), "marker"),
        (("--robot", "plotter", "--camera", "folder:."), "there is no machine 'plotter'; there are: "),
        (
            ("--robot", "grbl:/dev/absent", "--camera", "webcam"),
            "'webcam' is not a camera; write usb:0, or folder:PATH",
        ),
        (("--view", "none.json"), "there is no camera's view none.json"),
    ],
)
def test_what_cannot_be_calibrated_is_one_sentence_and_leaves_nothing(words: tuple[str, ...], text: str) -> None:
    ran = calibrate(*words)
    assert ran.code == 2
    assert text in ran.mistake
    assert not Path("calibration").exists()


def test_other_words_do_not_go_on_with_a_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, unplug)
        assert calibrate().code == 3
    for words in (("--strokes", "6"), ("--size", "100x90mm"), ("--style", "marks"), ("--like", "round")):
        ran = calibrate(*words)
        assert ran.code == 2
        assert ran.mistake == (
            "calibration was begun with other options; go on with the same ones, or choose another --out"
        )


@pytest.mark.parametrize(
    ("robot", "servo", "varies"), [("axidraw", False, False), ("grbl", True, False), ("grbl", False, True)]
)
def test_a_machine_that_only_lifts_its_pen_is_given_strokes_that_it_can_draw(
    here: Path, robot: str, servo: bool, varies: bool
) -> None:
    easel = Easel(corner=(0, 0.08, 0), right=(1, 0, 0), down=(0, -1, 0), pen=Pen(up=9000, down=8000) if servo else None)
    (here / "easel.json").write_text(easel.model_dump_json())
    ran = calibrate("--robot", f"{robot}:/dev/absent", "--camera", "folder:.", "--easel", "easel.json")
    assert "cannot open the port /dev/absent" in ran.mistake
    sheet = read_painting(Path("calibration/practice.json"))
    (drawn,) = sheet.brushes.values()
    assert (drawn.name, drawn.pressure_matters) == ("marker", varies)
    assert (np.ptp(sheet.trajectories()[..., 2]) > 0.5) == varies
    if not varies:
        limits = Limits(lower=(0, 0, 0), upper=(1, 1, 1), speed=1, climb=1, acceleration=1, varies_pressure=False)
        assert len(routine(sheet, easel, limits)) == 5


def test_strokes_that_no_machine_has_begun_are_replaced_by_those_of_other_words() -> None:
    ran = calibrate("--strokes", "6", "--robot", "grbl:/dev/absent", "--camera", "folder:.")
    assert "cannot open the port /dev/absent" in ran.mistake
    assert len(read_painting(Path("calibration/practice.json")).strokes) == 6
    ran = calibrate()
    assert ran.code == 0, ran.stderr
    assert len(read_painting(Path("calibration/practice.json")).strokes) == 5


def test_strokes_that_cannot_be_used_are_not_to_be_fitted_again_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> Fit:
        raise InputError("0 of 5 trials can be used, and 5 are needed: stroke 1 left no mark")

    monkeypatch.setattr(fitting, "fit_brush", refuse)
    ran = calibrate()
    assert ran.code == 2
    assert ran.stderr.splitlines()[-1] == (
        "maulstick: 0 of 5 trials can be used, and 5 are needed: stroke 1 left no mark; to draw other strokes on a new "
        "sheet, choose another --out"
    )


@pytest.mark.parametrize("finished", [False, True])
def test_strokes_of_another_machine_are_not_taken_for_those_of_this_one(
    monkeypatch: pytest.MonkeyPatch, finished: bool
) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, after(99 if finished else 1, unplug))
        assert calibrate().code == (0 if finished else 3)
    ran = calibrate("--robot", "grbl:/dev/null", "--camera", "folder:.", "--overwrite")
    assert ran.code == 2
    assert ran.mistake == ("the strokes in calibration were drawn by sim, not by grbl:/dev/null; choose another --out")
    assert calibrate("--robot", "sim:pens", "--overwrite").code == 0, "it is the same machine"


def test_a_folder_with_something_else_in_it_is_left_alone(here: Path) -> None:
    (here / "calibration").mkdir()
    (here / "calibration" / "thesis.tex").touch()
    ran = calibrate()
    assert (ran.code, ran.mistake) == (1, "calibration holds something else; choose another --out")
