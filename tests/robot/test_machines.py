import subprocess
import sys

import pytest

from maulstick.errors import InputError, MaulstickError
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.machines import SPECS, is_simulated, machine, only_lifts
from maulstick.robot.robot import Robot
from tests.support.robot.fake_grbl import FakeGrbl


@pytest.mark.parametrize("spec", ["", ":", "robot", "grble:/dev/ttyUSB0", "GRBL:/dev/ttyUSB0", "10.0.0.1"])
def test_a_spec_that_names_no_machine_is_refused_with_those_that_do(spec: str) -> None:
    with pytest.raises(InputError) as caught:
        machine(spec, None)
    assert str(caught.value) == f"there is no machine {spec!r}; there are: {SPECS}"


def test_a_machine_is_no_simulation_because_its_name_begins_as_one_s_does() -> None:
    assert [is_simulated(spec) for spec in ("sim", "sim:pens", "sim:real", "simplotter", "simplotter:1")] == [
        *3 * [True],
        *2 * [False],
    ]


@pytest.mark.parametrize("spec", ["grbl", "grbl:", "xarm", "franka:", "ur"])
def test_a_machine_whose_place_is_not_said_is_refused(spec: str) -> None:
    with pytest.raises(InputError, match=r"does not say where the machine is; there are: "):
        machine(spec, None)


@pytest.mark.parametrize("spec", ["grbl:/dev/null/none", "axidraw:/dev/null/none"])
def test_a_plotter_is_not_connected_before_it_is_entered(spec: str) -> None:
    robot = machine(spec, None)
    assert isinstance(robot, Robot)
    with pytest.raises(MaulstickError) as caught:
        robot.__enter__()
    assert "\n" not in str(caught.value)


def test_all_specs_but_the_simulators_name_machines() -> None:
    for spec in SPECS.split(", "):
        if not is_simulated(spec):
            assert isinstance(machine(spec.replace("IP", "192.0.2.1"), None), Robot)


def test_naming_machines_loads_none_of_what_drives_them() -> None:
    heavy = ["torch", "cv2", "serial", "xarm", "franky", "rtde_control", "shapely"]
    names = f"[name for name in {heavy} if name in sys.modules]"
    code = f"import sys, maulstick.robot.machines, maulstick.robot.execute; print({names})"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_the_kinds_that_only_lift_their_pen_are_those_whose_limits_say_so() -> None:
    pen = Pen(up=200, down=700)
    servo = Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), pen=pen)
    with FakeGrbl() as plotter:
        grbl = machine(f"grbl:{plotter.port}", servo)
        with grbl.connected():
            assert only_lifts("grbl:/dev/ttyUSB0") is not grbl.limits.varies_pressure
    for spec in ("axidraw", "xarm:192.0.2.1", "lite6:192.0.2.1", "franka:192.0.2.1", "ur:192.0.2.1"):
        assert only_lifts(spec) is not machine(spec, None).limits.varies_pressure
    assert only_lifts("hpgl")
    assert not only_lifts("sim:real")


def test_a_kind_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="there is no machine 'plotter'; there are: axidraw, "):
        only_lifts("plotter")
