"""Universal Robots' arms: set-points through servoL of ur-rtde, which follows them with a little smoothing."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final, final

import numpy as np

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.robot.adapters.arm import Arm, pose_of
from maulstick.robot.adapters.reaches import UR_REACHES
from maulstick.robot.adapters.streaming import stream
from maulstick.robot.force import FeelsForce
from maulstick.robot.limits import Limits
from maulstick.robot.stopping import Stopping
from maulstick.robot.timing import Profile
from maulstick.storage.arrays import Floats

UR_LIMITS: Final = Limits(
    lower=(-0.7, -0.7, -0.1),
    upper=(0.7, 0.7, 0.5),
    speed=0.2,
    climb=0.1,
    acceleration=0.5,
    deviation=1e-4,
    varies_pressure=True,
)
"""Limits: a box about the arm, of which each model reaches a part.

Set its own safety planes for what it must not touch.
"""

_E_SERIES: Final = 5  # first version of PolyScope that drives it, under the models' old names
_PERIOD: Final = 0.008  # seconds between set-points: both series keep that pace, and so does a busy computer
_LOOKAHEAD: Final = 0.03  # seconds, the least allowed: at our acceleration it cuts corners by 0.2 mm at most
_GAIN: Final = 500.0  # of servoL, whose range is 100 to 2000: higher follows more stiffly


@final
class UR(Arm, FeelsForce):
    """UR of the CB or e-series at an IP address, under remote control; the limits narrow UR_LIMITS."""

    knows_its_reach = True

    def __init__(self, address: str, limits: Limits | None = None) -> None:
        super().__init__(UR_LIMITS, limits)
        self._address = address
        self._control: Any = None
        self._receive: Any = None
        self._turned: list[float] = []

    def force(self) -> float:
        """Return the force along z at the tip, newtons, of which only differences count."""
        with self._line():
            return float(self._receive.getActualTCPForce()[2])

    def _connect(self) -> None:
        try:
            from rtde_control import RTDEControlInterface
            from rtde_receive import RTDEReceiveInterface
        except ImportError as error:
            raise InputError(f"the library for a UR is not installed; {how_to_add('ur')}") from error
        try:
            self._receive = RTDEReceiveInterface(self._address)
            self._check_safety()
            self._control = RTDEControlInterface(self._address)
        except RuntimeError as error:
            raise MachineError(
                f"no UR can be driven at {self._address} ({' '.join(str(error).split())}); check its power and the "
                "cable, and that it is under remote control"
            ) from error
        pose = self._pose()
        self._turned = pose[3:6]
        self._take_over_reach(pose)

    def _disconnect(self) -> None:
        control, receive = self._control, self._receive
        self._control = self._receive = None
        with self._line():
            if control is not None:
                control.stopScript()
                control.disconnect()
            if receive is not None:
                receive.disconnect()

    def _where(self) -> Floats:
        return np.array(self._pose()[:3])

    def _follow(self, profile: Profile, stopping: Stopping) -> None:
        with self._line():
            try:
                stream(profile, self._send, self._where, _PERIOD, stopping)
            finally:
                self._control.servoStop()

    def _accepts(self, place: Floats) -> bool:
        # Unlike getInverseKinematics this does not stop the controller's program where there is no pose.
        with self._line():
            if self._control.isPoseWithinSafetyLimits([*place.tolist(), *self._turned]):
                return True
            self._check_safety()
            if not self._control.isProgramRunning():
                raise MachineError("the UR does not answer; see what its pendant says")
        return False

    def _take_over_reach(self, pose: list[float]) -> None:
        if not (model := self._model()):
            return  # of a model that is not in the table, its own kinematics decide alone
        from scipy.spatial.transform import Rotation

        with self._line():
            tool = self._control.getTCPOffset()
        held = (pose_of(np.array(of[:3]), Rotation.from_rotvec(of[3:6])) for of in (pose, tool))
        self._reaches(UR_REACHES[model], *held)

    def _model(self) -> str:
        """Ask for the model, as in UR5e; empty for an unknown one, and where nobody tells, as in PolyScope X."""
        from dashboard_client import DashboardClient

        board = DashboardClient(self._address)
        try:
            board.connect()
            try:
                name, version = board.getRobotModel().strip(), board.polyscopeVersion()
            finally:
                board.disconnect()
        except RuntimeError:
            return ""
        series = re.search(r"\d+", version)
        names = [name] if series is not None and int(series[0]) < _E_SERIES else [f"{name}e", name]
        return next((known for known in names if known in UR_REACHES), "")

    def _make_ready(self) -> None:
        self._check_safety()
        with self._line():
            if not self._control.isProgramRunning() and not self._control.reuploadScript():
                raise MachineError("the UR does not take its program again; see what its pendant says")

    def _pose(self) -> list[float]:
        with self._line():
            return list(self._receive.getActualTCPPose())

    def _send(self, place: Floats) -> None:
        pose = [*place.tolist(), *self._turned]
        if not self._control.servoL(pose, 0.0, 0.0, _PERIOD, _LOOKAHEAD, _GAIN):
            self._check_safety()
            raise MachineError("the UR no longer follows; see what its pendant says")

    def _check_safety(self) -> None:
        """Raise MachineError in a stop that, by the arm's own rules, a person has to release."""
        with self._line():
            if not self._receive.isConnected():
                raise MachineError(f"the connection to the UR at {self._address} is lost; check the cable")
            if self._receive.isEmergencyStopped():
                raise MachineError("the UR's emergency stop is pressed; release it, and start the arm at its pendant")
            if self._receive.isProtectiveStopped():
                raise MachineError("the UR is in a protective stop; see what it hit, and release it at its pendant")

    @contextmanager
    def _line(self) -> Iterator[None]:
        """Turn what ur-rtde raises into MachineError."""
        try:
            yield
        except RuntimeError as error:
            text = " ".join(str(error).split())
            raise MachineError(
                f"the connection to the UR at {self._address} is lost ({text}); check the cable"
            ) from error
