import os
import signal
from pathlib import Path

import pytest

import maulstick as ms
from maulstick.painting.painting_file import write_painting
from maulstick.robot.robot import StoppedError
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_a_kill_and_a_closed_terminal_lift_the_pen_of_a_program(tmp_path: Path, number: signal.Signals) -> None:
    def interrupt(what: str) -> None:
        if what == "stroke" and robot.said.count(what) == 2:
            os.kill(os.getpid(), number)

    write_painting(SIX, tmp_path / "six.json")
    robot = Recorder(before=interrupt)
    before = signal.signal(number, signal.default_int_handler)
    try:
        with pytest.raises(StoppedError):
            ms.paint(tmp_path / "six.json", robot=robot, ask=lambda message: None)
        assert signal.getsignal(number) == signal.default_int_handler
    finally:
        signal.signal(number, before)
    assert robot.said[-2:] == ["recover", "close"]
    result = ms.paint(tmp_path / "six.json", robot=robot, resume=True, unfinished=True, ask=lambda message: None)
    assert result.painted == result.strokes == len(SIX.strokes)
