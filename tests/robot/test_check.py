"""`check_robot`: a machine that keeps its promises passes, and each promise, broken, is found out."""

import re
import time

import numpy as np
import pytest

from maulstick.errors import InputError, MachineError
from maulstick.painting.raster import Canvas
from maulstick.robot.check import check_robot
from maulstick.robot.simulated.easel import ARM, SimulatedEasel
from maulstick.robot.simulated.sheets import ModelSheet
from maulstick.storage.arrays import Floats
from tests.support.nominal import nominal
from tests.support.robot.obedient_robot import EASEL, LIMITS, Obedient

MIDDLE = (0.05, 0.05)


class Locked(Obedient):
    def _open(self) -> Floats:
        raise MachineError("the door is open")


class Elsewhere(Obedient):
    def _move(self, place: Floats) -> Floats:
        return super()._move(place + np.array([2e-4, 0, 0]))


class Sloppy(Obedient):
    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        return super()._stroke(path, speed) + np.array([0, 0, 3e-4])


class Half(Obedient):
    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        return super()._stroke(path, speed)[:1]


class Slanting(Obedient):
    def _lift(self, place: Floats) -> Floats:
        return super()._lift(place + np.array([2e-3, 0, 0]))


class Low(Obedient):
    def _lift(self, place: Floats) -> Floats:
        return super()._lift(place - np.array([0, 0, 2e-3]))


class Unlimited(Obedient):
    def move(self, place: Floats) -> Floats:  # type: ignore[misc]  # it is broken
        return self._do(lambda: self._move(place))


class Sneaking(Obedient):
    def move(self, place: Floats) -> Floats:  # type: ignore[misc]  # it is broken
        try:
            return super().move(place)
        except InputError:
            self._place = place
            raise


class Unstoppable(Obedient):
    def _stroke(self, path: Floats, speed: Floats) -> Floats:
        return path


class Late(Obedient):
    def _recover(self) -> None:
        time.sleep(0.5)
        super()._recover()


class Restless(Obedient):
    def move(self, place: Floats) -> Floats:  # type: ignore[misc]  # it is broken
        self.limits.check_path(place[None])
        self._place = self._move(place)
        return place


class Dragging(Obedient):
    def _recover(self) -> None:
        pass


class Once(Obedient):
    entries = 0

    def _open(self) -> Floats:
        self.entries += 1
        if self.entries > 1:
            raise OSError("the port is busy")
        return super()._open()


class Clinging(Obedient):
    def _close(self) -> None:
        raise MachineError("the line is broken")


def test_a_machine_that_keeps_its_promises_passes_every_check() -> None:
    checks = check_robot(Obedient(), EASEL, MIDDLE)
    assert [check for check in checks if not check.passed] == []
    assert len({check.name for check in checks}) == 8


@pytest.mark.parametrize(
    ("broken", "promise", "finding"),
    [
        (Locked, "it can be entered", "MachineError: the door is open"),
        (Elsewhere, "it goes where it is sent", "sent 0.2 mm beside"),
        (Sloppy, "it draws and lifts where it is told", "drew 0.3 mm beside the path"),
        (Half, "it draws and lifts where it is told", r"returned one \(1, 3\)"),
        (Slanting, "it draws and lifts where it is told", "moved sideways when it was lifted"),
        (Low, "it draws and lifts where it is told", "lifted to 23 mm"),
        (Unlimited, "it refuses what is outside its limits", "took a place 10 mm outside"),
        (Sneaking, "it refuses what is outside its limits", "refused a place .* and moved"),
        (Unstoppable, "it stops at once", "was over before it was stopped"),
        (Late, "it stops at once", r"it took 0\.\d+ s, of which lifting takes 0\.13 at most"),
        (Restless, "it stays stopped", "moved after it was stopped"),
        (Dragging, "it comes back with its pen lifted", "0 mm above the stroke"),
        (Once, "it comes back with its pen lifted", "OSError: the port is busy"),
        (Clinging, "it can be left", "MachineError: the line is broken"),
    ],
)
def test_a_broken_promise_is_found_out(broken: type[Obedient], promise: str, finding: str) -> None:
    found = {check.name: check for check in check_robot(broken(), EASEL, MIDDLE)}[promise]
    assert not found.passed
    assert re.search(finding, found.finding), found.finding


def test_a_machine_that_cannot_be_entered_is_tried_no_further() -> None:
    robot = Locked()
    assert [check.passed for check in check_robot(robot, EASEL, MIDDLE)] == [False]
    assert robot.lowest == np.inf


def test_a_trial_that_does_not_fit_the_limits_is_refused_before_the_machine_is_entered() -> None:
    robot = Obedient()
    with pytest.raises(InputError, match="the machine's x is"):
        check_robot(robot, EASEL, (LIMITS.upper[0], 0.05))
    with pytest.raises(InputError, match="not connected"):
        _ = robot.place


def test_a_machine_with_a_usual_place_needs_no_more_than_itself() -> None:
    sheet = ModelSheet(Canvas(0.1, 0.1, 1000), nominal("marker"))
    assert [check.name for check in check_robot(SimulatedEasel(sheet, limits=ARM, pace=1)) if not check.passed] == []
    with pytest.raises(InputError, match="it stands nowhere"):
        check_robot(Obedient())


def test_an_interrupted_trial_leaves_the_machine() -> None:
    class Interrupted(Obedient):
        def _stroke(self, path: Floats, speed: Floats) -> Floats:
            raise KeyboardInterrupt

    robot = Interrupted()
    with pytest.raises(KeyboardInterrupt):
        check_robot(robot, EASEL, MIDDLE)
    with pytest.raises(InputError, match="not connected"):
        _ = robot.place
