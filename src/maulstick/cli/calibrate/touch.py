"""``maulstick calibrate touch``: measures where the sheet lies before a machine."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console

from maulstick.cli.folder import check_absent
from maulstick.cli.keyboard import hang_up_as_ctrl_c, pressed_keys, unechoed
from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import InputError, nothing_is_painted
from maulstick.jobs.paint.machine_lock import machine_lock
from maulstick.painting.raster import parse_size
from maulstick.robot.easel import write_easel
from maulstick.robot.machines import REAL_SPECS, is_simulated, machine
from maulstick.storage.folders import made_folder

if TYPE_CHECKING:
    from maulstick.robot.easel import Easel
    from maulstick.robot.force import FeelsForce
    from maulstick.robot.robot import Robot
    from maulstick.storage.arrays import Floats

_LIFT = 0.02  # metres above the sheet from corner to corner, clear of clips and tape


def touch(
    robot: Annotated[str, typer.Option(metavar="MACHINE", help=f"The machine: {REAL_SPECS}.")],
    size: Annotated[str, typer.Option(metavar="SIZE", help="Size of the sheet: 200x160mm, A4-landscape.")],
    force: Annotated[
        bool, typer.Option("--force", metavar="", help="Lower the tip until the machine feels the paper.")
    ] = False,
    out: Annotated[Path, typer.Option(metavar="FILE", help="File to write.")] = Path("easel.json"),
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier file.")] = False,
) -> None:
    """Take the tip to the corners of the sheet, and measure where the paper lies and how deep it may be pressed.

    Arrow keys move the tip, Page Up and Page Down lift and lower it; 1, 2 and 3 set the step to 10, 1 or 0.1 mm; Enter
    takes the point. Ctrl-C stops at once and lifts the tip.

    Example: maulstick calibrate touch --robot xarm:192.168.1.5 --size 200x160mm --out easel.json
    """
    if is_simulated(robot):
        raise InputError(f"{robot} knows where its sheet lies, and shows no tip to take there; name a real machine")
    width, height = parse_size(size)
    check_absent(out, "--out", overwrite)
    if not sys.stdin.isatty():
        raise InputError("keys are needed to take the tip to the corners; run it in a terminal")
    from maulstick.robot.force import FeelsForce

    console = Console(stderr=True, markup=False, highlight=False)
    corners = {
        "upper left": (0.0, 0.0),
        "upper right": (width, 0.0),
        "lower right": (width, height),
        "lower left": (0.0, height),
    }
    keys = pressed_keys()
    folder = made_folder(out.parent)  # before the corners are touched
    with (
        folder,
        machine_lock(robot),
        unechoed(),
        hang_up_as_ctrl_c(),
        nothing_is_painted(),
        machine(robot, None) as arm,
    ):
        if force and not isinstance(arm, FeelsForce):
            raise InputError(f"{robot} cannot feel the paper; leave out --force, and touch it by eye")
        easel = _touched(arm, keys, corners, console, force=force)
        if arm.limits.varies_pressure:
            easel = _pressed(arm, keys, easel, console)
            _raise(arm)
        write_easel(easel, out)
    print(
        f"touched to {1e3 * easel.error:.2f} mm; the paper is tilted by {np.degrees(easel.tilt):.2f} degrees, "
        f"and may be pressed {1e3 * easel.deepest:.1f} mm deep",
        flush=True,
    )
    print(out, flush=True)


def _touched(
    arm: "Robot", keys: Iterator[str], corners: dict[str, tuple[float, float]], console: Console, *, force: bool
) -> "Easel":
    """Return the easel on which the corners lie; where they do not fit, ask for each again until they do."""
    from maulstick.calibration.touch import easel_from_touches
    from maulstick.robot.force import FeelsForce

    touched: dict[str, Floats] = {}
    while True:
        for name in corners:
            if force:
                assert isinstance(arm, FeelsForce)
                touched[name] = _felt(arm, keys, f"take the tip above the {name} corner of the sheet", console)
            else:
                ask = f"lower the tip onto the {name} corner of the sheet until it just touches"
                touched[name] = _jogged(arm, keys, ask, console)
            _raise(arm)
            if len(touched) == len(corners):
                try:
                    return easel_from_touches(np.array([*touched.values()]), np.array([*corners.values()]))
                except InputError as error:
                    console.print(COMMAND_LINE.say(error), soft_wrap=True)


def _felt(arm: "FeelsForce", keys: Iterator[str], ask: str, console: Console) -> "Floats":
    """Return the place of the paper beneath the tip, (3,) metres; asks again where nothing is felt."""
    from maulstick.calibration.touch import NothingFeltError, probe_by_force

    while True:
        above = _jogged(arm, keys, ask, console)
        try:
            return probe_by_force(arm, above, arm.limits.lower[2])
        except NothingFeltError as error:
            console.print(COMMAND_LINE.say(error), soft_wrap=True)


def _pressed(arm: "Robot", keys: Iterator[str], easel: "Easel", console: Console) -> "Easel":
    """Return the easel with its deepest pressure; asks again where it is wrong, since the corners took a while."""
    from maulstick.calibration.touch import with_deepest

    while True:
        place = _jogged(arm, keys, "press the tip onto the sheet as deep as the deepest stroke may be", console)
        try:
            return with_deepest(easel, place)
        except InputError as error:
            console.print(COMMAND_LINE.say(error), soft_wrap=True)


def _raise(arm: "Robot") -> None:
    arm.lift(min(float(arm.place[2]) + _LIFT, arm.limits.upper[2]))


def _jogged(arm: "Robot", keys: Iterator[str], ask: str, console: Console) -> "Floats":
    """Let the operator move the tip; returns its place (3,), metres, once they press Enter."""
    from maulstick.calibration.touch import Jog

    console.print(f"{ask}, and press Enter", soft_wrap=True)
    x, y, z = np.clip(arm.place, arm.limits.lower, arm.limits.upper).tolist()
    jog = Jog((x, y, z), arm.limits)
    for key in keys:
        jog = jog.pressed(key)
        if jog.taken:
            return arm.place
        place = np.array(jog.place)
        if not np.array_equal(place, arm.place):
            arm.jog(place)
            console.print("x {:.1f}  y {:.1f}  z {:.1f} mm".format(*(1e3 * place).round(1) + 0.0), end="\r")
    raise InputError("nobody is at the keyboard; run it in a terminal")
