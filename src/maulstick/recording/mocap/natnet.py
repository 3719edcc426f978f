"""Live recording of what OptiTrack's Motive 2 and 3 stream over the network (NatNet 3 and 4)."""

import io
import math
import socket
import time
from array import array
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError, how_to_add, option
from maulstick.recording.mocap.bodies import CANVAS_MARKERS, check_names, pen_and_canvas
from maulstick.recording.mocap.take import Take, is_unit
from maulstick.storage.arrays import Floats

PORT = 1510
"""Port on which Motive listens for commands by default."""

_PATIENCE = 5.0  # seconds without an answer or a frame, after which the recording ends
_POLL = 0.005  # seconds between two looks at the socket
_POSE = 7  # numbers of a pose: position and quaternion
_STREAMING = "switch on streaming in Motive, with rigid bodies, labelled and unlabelled markers"


@dataclass(frozen=True)
class Seen:
    """Progress of a recording: number of frames, duration, and whether the last frame shows the pen and the canvas."""

    frames: int
    seconds: float
    pen: bool
    canvas: bool


def receive(
    server: str,
    going: Callable[[], bool],
    *,
    local: str | None = None,
    pen: str | None = None,
    canvas: str | None = None,
    multicast: bool = False,
    watch: Callable[[Seen], None] = lambda _: None,
) -> Take:
    """Record the take that Motive streams, while `going()` is true, or until no later frame came for 5 s.

    server: address of Motive's machine, followed by a colon and the port where it is not 1510.
    local: this machine's address on the network; by default the one from which `server` is reached.
    pen, canvas: names of rigid bodies, as in `read_motive`.  Three loose markers are a canvas if exactly three are
    seen at the start; one that Motive loses and then sees as a new one stays unseen, which a rigid body avoids.
    multicast: whether Motive is set to transmit by multicast.
    watch: called with the progress many times per second.

    The markers are those that Motive measures; if it streams none of a rigid body, they are computed from its pose.
    A frame that came late or twice is left out.  Raises InputError where the package natnet is not installed, where no
    frame comes, and where the pen or the canvas cannot be found; the sockets are closed in any case.
    """
    try:
        from natnet import NatNetClient  # type: ignore[import-untyped]
    except ImportError:
        raise InputError(f"recording live needs the package natnet; {how_to_add('mocap')}") from None
    host, port = _address(server)
    client = NatNetClient(host, _local_address(host, port, local), command_port=port, use_multicast=multicast)
    try:
        _connect(client, server)
        return _record(client, server, going, pen, canvas, watch)
    finally:
        client.shutdown()


def _address(server: str) -> tuple[str, int]:
    host, _, port = server.partition(":")
    if not host or not (port or "1").isdecimal() or not 0 < int(port[:6] or PORT) < 2**16:
        raise InputError(f"{server!r} is not the address of a server; write 192.168.1.5 or 192.168.1.5:{PORT}")
    try:
        return socket.gethostbyname(host), int(port or PORT)
    except (OSError, ValueError):
        raise InputError(
            f"there is no machine {host!r} to be found; check {option('server')}, as in 192.168.1.5"
        ) from None


def _local_address(host: str, port: int, local: str | None) -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:  # sends nothing
        try:
            probe.bind((local or "", 0))
        except (OSError, ValueError):
            raise InputError(f"{local!r} is not an address of this machine; leave out {option('local')}") from None
        try:
            probe.connect((host, port))
        except OSError as error:
            raise InputError(f"there is no way from here to {host}: {error.strerror}; check the network") from error
        return str(probe.getsockname()[0])


def _connect(client: Any, server: str) -> None:
    from natnet import NatNetError

    way = "multicast" if client.use_multicast else "unicast"
    try:
        with redirect_stdout(io.StringIO()):  # the package prints complaints about packets
            client.connect(_PATIENCE)
    except TimeoutError:
        raise InputError(
            f"{server} does not answer; check the address, the firewall, and that Motive there streams in {way}"
        ) from None
    except (OSError, NatNetError) as error:
        cause = getattr(error, "inner_error", error)
        raise InputError(f"cannot listen to {server} in {way}: {cause.strerror or cause}") from error
    except Exception as error:  # the package does not check what it reads
        raise InputError(f"{server} answers, but not as Motive does; check the address and the port") from error
    version = client.server_info.nat_net_protocol_version
    if version.major not in (3, 4):
        raise InputError(f"{server} streams NatNet {version}; it must be 3 or 4, those of Motive 2 and 3")


def _record(
    client: Any,
    server: str,
    going: Callable[[], bool],
    pen: str | None,
    canvas: str | None,
    watch: Callable[[Seen], None],
) -> Take:
    descriptions: list[Any] = []
    frames: list[Any] = []

    def keep(frame: Any) -> None:
        if math.isfinite(frame.suffix.timestamp):
            frames.append(frame)

    client.on_data_description_received_event.handlers.append(descriptions.append)
    client.on_data_frame_received_event.handlers.append(keep)
    client.request_modeldef()
    for awaited, what in ((descriptions, "does not say what it tracks"), (frames, "sends no frames")):
        since = time.monotonic()
        while not awaited:
            if not going():
                raise InputError("stopped before the first frame had come; nothing was recorded")
            if time.monotonic() - since > _PATIENCE:
                raise InputError(f"{server} {what} that can be read; {_STREAMING}")
            _poll(client)
    recorder = _Recorder(descriptions[0], frames[0], pen, canvas)
    heard = time.monotonic()
    while True:
        kept = [recorder.add(frame) for frame in frames]
        if any(kept):
            heard = time.monotonic()
        frames.clear()
        watch(recorder.seen())
        if not going() or time.monotonic() - heard > _PATIENCE:
            return recorder.take()
        _poll(client)


def _poll(client: Any) -> None:
    """Receive what has come; a packet that cannot be read counts as lost."""
    time.sleep(_POLL)
    try:
        with redirect_stdout(io.StringIO()):
            client.update_sync()
    except Exception:
        return


class _Recorder:
    """Frames as numbers: the time, position and rotation of the pen and of the canvas, markers of both."""

    def __init__(self, description: Any, first: Any, pen: str | None, canvas: str | None) -> None:
        check_names([body.name for body in description.rigid_bodies])
        bodies = {body.name: body for body in description.rigid_bodies}
        loose = [marker.id_num for marker in first.labeled_markers if marker.unlabeled]
        counts = {name: len(body.markers) for name, body in bodies.items()}
        names = pen_and_canvas(counts, len(loose), pen, canvas)
        self._bodies = [bodies[name] for name in names if name is not None]
        self._markers = [number for body in self._bodies for number in _numbers_of(body, first)]
        if names[1] is None:
            self._markers += loose
        self._width = 1 + _POSE * len(self._bodies) + 3 * len(self._markers)
        self._numbers = array("d")

    def add(self, frame: Any) -> bool:
        """Keep this frame if it is later than all before it; return whether it is."""
        stamp = frame.suffix.timestamp
        if self._numbers and stamp <= self._numbers[-self._width]:
            return False
        poses = {body.id_num: (*body.pos, *body.rot) for body in frame.rigid_bodies if body.tracking_valid}
        places = {marker.id_num: marker.pos for marker in frame.labeled_markers if not marker.occluded}
        self._numbers.append(stamp)
        for body in self._bodies:
            self._numbers.extend(poses.get(body.id_num, (math.nan,) * _POSE))
        for marker in self._markers:
            self._numbers.extend(places.get(marker, (math.nan,) * 3))
        return True

    def seen(self) -> Seen:
        """Return the progress after at least one frame."""
        last = self._numbers[-self._width :]
        canvas = last[1 + _POSE : 1 + 2 * _POSE] if len(self._bodies) > 1 else last[-3 * CANVAS_MARKERS :]
        return Seen(
            len(self._numbers) // self._width,
            last[0] - self._numbers[0],
            not math.isnan(last[1]),
            not any(map(math.isnan, canvas)),
        )

    def take(self) -> Take:
        """Return all frames as a take."""
        values = np.array(self._numbers).reshape(-1, self._width)
        poses, markers = np.split(values[:, 1:], [_POSE * len(self._bodies)], axis=1)
        poses, markers = (part.reshape(len(values), -1, size) for part, size in ((poses, _POSE), (markers, 3)))
        poses[~is_unit(poses[..., 3:])] = np.nan
        for part in (poses, markers):
            part[~np.isfinite(part).all(axis=2)] = np.nan
        first = 0
        for body, pose in zip(self._bodies, np.moveaxis(poses, 1, 0), strict=True):
            own = markers[:, first : first + len(body.markers)]
            if np.isnan(own).all():
                own[:] = _solved(body, pose)
            first += len(body.markers)
        return Take(
            values[:, 0], poses[:, 0, :3], poses[:, 0, 3:], markers[:, :-CANVAS_MARKERS], markers[:, -CANVAS_MARKERS:]
        )


def _numbers_of(body: Any, frame: Any) -> list[int]:
    """Return the numbers of a body's markers: those in the frame if all are there, else those that Motive derives."""
    came = sorted(m.id_num for m in frame.labeled_markers if m.model_id == body.id_num and not m.unlabeled)
    count = len(body.markers)
    return came if len(came) == count else [(body.id_num << 16) + number for number in range(1, count + 1)]


def _solved(body: Any, poses: Floats) -> Floats:
    """Return the places (F, M, 3) of a body's markers, computed from its poses (F, 7)."""
    tracked = np.isfinite(poses[:, 0])
    solved = np.full((len(poses), len(body.markers), 3), np.nan)
    if tracked.any():
        turns = Rotation.from_quat(poses[tracked, 3:])
        for number, marker in enumerate(body.markers):
            solved[tracked, number] = poses[tracked, :3] + turns.apply(marker.pos)
    return solved
