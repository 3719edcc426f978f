"""Errors: a fault and a remedy, which each front end says in its own words."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import PYTHON, InputError, MachineError, MaulstickError, OutputError, Remedy, machine, option
from maulstick.robot.plotter import LockedError
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import Prompt
from maulstick.studio.wording import error_text, prompt_text

VALUES = {"speed": 0.04, "millimetres": "40"}


@pytest.mark.parametrize("remedy", Remedy)
def test_every_remedy_is_said_by_each_front_end_in_its_own_words(remedy: Remedy) -> None:
    error = InputError("something is wrong", remedy, **VALUES)
    page, line, python = error_text(error), COMMAND_LINE.say(error), str(error)
    assert all(sentence.startswith("something is wrong; ") for sentence in (page, line, python))
    assert [word for word in ("--", "PORT", "PATH", "=", "{") if word in page] == []
    assert [word for word in ("=", "{", "(...") if word in line] == []
    assert remedy is Remedy.CALIBRATE_TOUCH or "--" not in python


@pytest.mark.parametrize(
    ("error", "here"),
    [
        (MachineError("the line went silent", Remedy.GO_ON), "the line went silent; then “Go on where it stopped”"),
        (InputError("the journal is damaged", Remedy.RESTART), "the journal is damaged; “Start again on a new sheet”"),
        (InputError("no AxiDraw is plugged in", Remedy.NAME_PORT), "no AxiDraw is plugged in; connect its USB cable"),
        (
            MachineError("it lost its place", Remedy.HOME),
            "it lost its place; “Set the machine up by hand” homes it; without",
        ),
        (LockedError("it is locked", Remedy.UNLOCK), "it is locked; “Set the machine up by hand” homes or unlocks it"),
        (
            InputError(f"another maulstick drives {machine('grbl:/dev/ttyUSB0')}; wait"),
            "another maulstick drives Pen plotter with Grbl at /dev/ttyUSB0; wait",
        ),
        (InputError("planning again needs a camera over the sheet", Remedy.NAME_CAMERA), "planning again needs a cam"),
        (InputError("an arm must be told where the sheet lies", Remedy.CALIBRATE_TOUCH), "an arm must be told where"),
        (InputError("no easel says how deep", Remedy.FIND_DEPTH), "no easel says how deep; bring its easel file under"),
        (InputError.of_range(option("speed"), 0.01, "from 0.1 to 10000 mm/s"), "the speed is 0.01; it must be from"),
        (InputError.of_range(option("replan"), -1, "at least 1"), "the number of strokes between two looks is -1;"),
        (
            InputError(f"{option('background')} shows the sheet, and {option('paper')} its colour"),
            "the photograph of the sheet shows the sheet, and the colour of the paper its colour",
        ),
        (InputError("no CLIP", Remedy.CLIP_WEIGHTS_OR_NETWORK), "no CLIP; connect this computer to the internet and"),
        (InputError("what says nothing of the command line"), "what says nothing of the command line"),
    ],
)
def test_the_page_does_not_speak_like_the_command_line(error: MaulstickError, here: str) -> None:
    sentence = error_text(error)
    assert sentence.startswith(here)
    assert [
        word
        for word in ("--", "PORT", "PATH", "maulstick paint", "maulstick machine", "command line,")
        if word in sentence
    ] == []


def test_a_pen_that_stands_elsewhere_is_homed_where_each_front_end_does_so() -> None:
    prompt = Prompt("see that the pen stands here", 0, renews=False, elsewhere=Remedy.FIND_HOME)
    assert prompt_text(prompt) == (
        "see that the pen stands here (elsewhere: stop, home it under “Set the machine up by hand”)"
    )
    for wording in (COMMAND_LINE, PYTHON):
        assert prompt.told(wording) == "see that the pen stands here (elsewhere: stop, home it with maulstick machine)"
    assert prompt_text(Prompt("put in the marker", 0)) == "put in the marker"


@given(st.text(), st.sampled_from([None, *Remedy]))
def test_an_error_is_the_same_once_it_has_crossed_a_process(fault: str, remedy: Remedy | None) -> None:
    for kind in (InputError, OutputError, MachineError, LockedError):
        error = kind(fault, remedy, **VALUES)
        again = pickle.loads(pickle.dumps(error))
        assert (type(again), str(again), again.remedy) == (kind, str(error), remedy)
    stopped = pickle.loads(pickle.dumps(StoppedError()))
    assert isinstance(stopped, StoppedError)
    assert str(stopped) == "the machine was stopped"


def test_an_option_is_called_as_each_front_end_calls_it() -> None:
    error = InputError.of_range(option("ask_every"), 0, "at least 1")
    assert str(error) == "ask_every is 0; it must be at least 1"
    assert COMMAND_LINE.say(error) == "--ask-every is 0; it must be at least 1"
    assert error_text(error) == "ask every is 0; it must be at least 1"


def test_an_error_is_the_same_under_another_name_of_its_file() -> None:
    error = InputError("/tmp/x is torn", Remedy.SLOW_DOWN, speed=3).replaced("/tmp/x", "cat.json")
    assert str(error) == "cat.json is torn; slow all strokes down with speed=3"
