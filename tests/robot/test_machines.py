import subprocess
import sys

import pytest

from maulstick.errors import InputError, MaulstickError
from maulstick.robot.machines import SPECS, machine
from maulstick.robot.robot import Robot


@pytest.mark.parametrize("spec", ["", ":", "robot", "grble:/dev/ttyUSB0", "GRBL:/dev/ttyUSB0", "10.0.0.1"])
def test_a_spec_that_names_no_machine_is_refused_with_those_that_do(spec: str) -> None:
    with pytest.raises(InputError) as caught:
        machine(spec, None)
    assert str(caught.value) == f"there is no machine {spec!r}; there are: {SPECS}"


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
        if not spec.startswith("sim"):
            assert isinstance(machine(spec.replace("IP", "192.0.2.1"), None), Robot)


def test_naming_machines_loads_none_of_what_drives_them() -> None:
    heavy = ["torch", "cv2", "serial", "xarm", "franky", "rtde_control", "shapely"]
    names = f"[name for name in {heavy} if name in sys.modules]"
    code = f"import sys, maulstick.robot.machines, maulstick.robot.execute; print({names})"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
