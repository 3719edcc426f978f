"""UFACTORY's arms, xArm 5 to 7, 850 and Lite 6: set-points through xarm-python-sdk, in the controller's servo mode.

In that mode the tip moves straight to the last set-point, so it follows our own profile, and stops when none comes.
"""

import io
import time
from contextlib import redirect_stdout
from typing import Any, Final, final

import numpy as np

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.arm import Arm, pose_of
from maulstick.robot.adapters.reaches import UFACTORY_REACHES
from maulstick.robot.adapters.streaming import stream
from maulstick.robot.limits import Limits
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

XARM: Final = Limits(
    lower=(0.15, -0.4, -0.1),
    upper=(0.6, 0.4, 0.45),
    speed=0.2,
    climb=0.1,
    acceleration=1.0,
    deviation=1e-4,
    varies_pressure=True,
)
"""Limits: a box about what the arms of 700 mm reach."""

LITE6: Final = XARM.narrowed(XARM.model_copy(update={"lower": (0.15, -0.2, -0.05), "upper": (0.38, 0.2, 0.35)}))
"""Limits: a box about what a Lite 6 reaches; no arm gets to all the corners of its box, which `reach` knows."""

_SERVO_MODE: Final = 1  # of set_mode: follow set-points
_READY: Final = 0  # of set_state
_LITE6_TYPE: Final = 9  # of device_type
_PERIOD: Final = 0.01  # seconds: the controller takes up to 250 set-points per second
_TOLD: Final = 0.4  # seconds: the controller reports its tool five times a second; until then the SDK says zeros
_UNANSWERED: Final = (-1, 3, 4, 5, 6, 7, 8)  # codes of a broken line or protocol, which say nothing about a place
_METRE: Final = 1e3  # millimetres, in which the SDK counts
_OF_A_COLLISION: Final = (22, 31, 35)  # error codes: with itself, with something, with a boundary
_RETURNED: Final = {  # codes that calls of the SDK return
    -1: "it is not connected; check the cable",
    -2: "it is not enabled; release the emergency stop",
    -6: "that place is outside the limits set in UFACTORY Studio",
    -7: "a joint would pass its limit; turn the tool, or lay the sheet elsewhere",
    -9: "the emergency stop is pressed; release it",
    1: "it has an error that was not cleared",
    3: "it did not answer in time; check the cable",
    8: "nothing can be sent to it; check the cable",
    9: "it is not ready to move; it was stopped from elsewhere",
}


@final
class XArm(Arm):
    """xArm, or with `limits` within LITE6 a Lite 6, at an IP address; the limits narrow XARM."""

    knows_its_reach = True

    def __init__(self, address: str, limits: Limits | None = None) -> None:
        super().__init__(XARM, limits)
        self._address = address
        self._arm: Any = None
        self._turned: list[float] = []

    def _connect(self) -> None:
        try:
            with redirect_stdout(io.StringIO()):  # it prints its version
                from xarm.wrapper import XArmAPI
        except ImportError as error:
            raise InputError(f"the library for an xArm is not installed; {how_to_add('xarm')}") from error
        try:
            self._arm = XArmAPI(self._address)
        except Exception as error:  # the SDK knows no narrower one
            raise MachineError(
                f"no xArm answers at {self._address} ({error}); check its power, and the cable"
            ) from error
        if self._arm.device_type == _LITE6_TYPE and self.limits.narrowed(LITE6) != self.limits:
            raise InputError("this arm is a Lite 6, which reaches less far than an xArm; call it lite6:IP")
        self._make_ready()
        pose = self._pose()
        self._turned = pose[3:6]
        self._take_over_reach(pose)

    def _disconnect(self) -> None:
        if self._arm is not None:
            self._arm.disconnect()
            self._arm = None

    def _where(self) -> Floats:
        return np.array(self._pose()[:3]) / _METRE

    def _follow(self, profile: Profile, stopping: Stopping) -> None:
        stream(profile, self._send, self._where, _PERIOD, stopping)

    def _accepts(self, place: Floats) -> bool:
        pose = [*(_METRE * place).tolist(), *self._turned]
        code, joints = self._arm.get_inverse_kinematics(pose, input_is_radian=True, return_is_radian=True)
        if code in _UNANSWERED:
            raise MachineError(_refusal(code))
        return code == 0 and not any(
            self._said(limited)
            for limited in (
                self._arm.is_joint_limit(joints, is_radian=True),
                self._arm.is_tcp_limit(pose, is_radian=True),
            )
        )

    def _take_over_reach(self, pose: list[float]) -> None:
        reach = UFACTORY_REACHES.get((self._arm.axis, self._arm.device_type))
        if reach is None:
            return  # of a model that is not in the table, its own kinematics decide alone
        from scipy.spatial.transform import Rotation

        time.sleep(_TOLD)
        if any(self._arm.world_offset):
            return  # places are not counted from its base, which only itself takes into account
        tool = list(self._arm.tcp_offset)
        self._reaches(
            reach,
            pose_of(np.array(pose[:3]) / _METRE, Rotation.from_euler("xyz", pose[3:6])),
            pose_of(np.array(tool[:3]) / _METRE, Rotation.from_euler("xyz", tool[3:6], degrees=True)),
        )

    def _make_ready(self) -> None:
        if self._error() in _OF_A_COLLISION:
            raise MachineError(f"{self._sentence(0)}; see that it is free, clear the error at the arm, and start again")
        self._arm.clean_error()
        self._arm.clean_warn()
        self._check(self._arm.motion_enable(True))
        self._check(self._arm.set_mode(_SERVO_MODE))
        self._check(self._arm.set_state(_READY))
        time.sleep(0.1)  # the controller takes that long to change its mode
        if self._error():
            raise MachineError(self._sentence(0))

    def _error(self) -> int:
        """Ask for the controller's error, 0 where it has none."""
        code, codes = self._arm.get_err_warn_code()
        if code:
            raise MachineError(_refusal(code))
        return int(codes[0])

    def _said(self, answer: tuple[int, bool | None]) -> bool:
        code, limited = answer
        self._check(code)
        return bool(limited)

    def _pose(self) -> list[float]:
        code, pose = self._arm.get_position(is_radian=True)
        self._check(code)
        return list(pose)

    def _send(self, place: Floats) -> None:
        pose = [*(_METRE * place).tolist(), *self._turned]
        self._check(self._arm.set_servo_cartesian(pose, is_radian=True))

    def _check(self, code: int) -> None:
        if code:
            raise MachineError(self._sentence(code))

    def _sentence(self, code: int) -> str:
        """Return a sentence about a fault: the controller's error where it has one, else what the SDK's code means."""
        from xarm.core.config.x_code import ControllerError

        asked, codes = self._arm.get_err_warn_code()
        if asked or not codes[0]:
            return _refusal(code)
        error = codes[0]
        told = ControllerError(error)
        cure = " ".join(told.description["en"].split())
        return f"the xArm stopped with error {error}, {told.title['en']}: {cure}"


def _refusal(code: int) -> str:
    return f"the xArm refuses: {_RETURNED.get(code, f'the SDK returned code {code}, which its manual explains')}"
