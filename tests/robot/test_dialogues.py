"""The estimate of time, and the fake Grbl, beside what the real firmware took."""

import pytest

from maulstick.robot.adapters.grbl import Grbl
from maulstick.robot.duration import seconds_of
from maulstick.robot.routine import Draw
from tests.support.robot.dialogue import DIALOGUES, START, Dialogue, dialogue
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.tolerances import CLOCK, FIRMWARE_CLOCK


@pytest.fixture(scope="module", params=DIALOGUES)
def said(request: pytest.FixtureRequest) -> Dialogue:
    return dialogue(request.param)


@pytest.fixture(scope="module")
def told(said: Dialogue) -> tuple[list[str], float]:
    """What a fake Grbl with the same settings is told for the same motions, and the seconds that it takes."""
    with FakeGrbl(settings=said.settings, pace=200) as device, Grbl(device.port, said.pen) as robot:
        lines, seconds = len(device.lines), device.seconds
        for motion in said.motions():
            robot.move(motion.start)
            robot.stroke(motion.path, motion.speed)
            robot.lift(motion.after)
        return device.lines[lines:], device.seconds - seconds


def test_all_forty_strokes_are_in_each_dialogue(said: Dialogue) -> None:
    assert len(list(said.strokes())) == 40
    assert all(command.ended for command in said.commands)


def test_the_estimate_agrees_with_the_firmware(said: Dialogue) -> None:
    actions = [Draw(number, 0, motion) for number, motion in enumerate(said.motions())]
    estimated = seconds_of(actions, said.limits, START).sum()
    assert estimated == pytest.approx(said.seconds, rel=CLOCK)


def test_the_fake_grbl_takes_as_long_as_the_firmware(said: Dialogue, told: tuple[list[str], float]) -> None:
    assert told[1] == pytest.approx(sum(command.seconds for command in said.commands), rel=FIRMWARE_CLOCK)


def test_the_adapter_still_says_to_a_machine_what_the_firmware_was_told(
    said: Dialogue, told: tuple[list[str], float]
) -> None:
    assert told[0] == [line for command in said.commands for line in command.lines]
