"""A server on the loopback address that speaks NatNet 3.0 to 4.2 over UDP, as Motive does in unicast."""

import socket
import struct
import threading
import time
from collections.abc import Callable, Collection
from typing import Self

import numpy as np

from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Floats

_CONNECT, _SERVER_INFO, _REQUEST_MODELS, _MODELS, _FRAME = 0, 1, 4, 5, 7
_OCCLUDED, _SOLVED, _HAS_MODEL, _UNLABELLED = 0x01, 0x02, 0x08, 0x10
_PEN, _CANVAS = 3, 5
_BETWEEN = 3e-4  # seconds between frames


class Server(threading.Thread):
    """Streams a take to whoever connects and asks what is tracked; then says no more.

    version: of the protocol.  names: of the pen's and the canvas's rigid bodies, or of the pen's alone where the
    canvas's markers are loose.  labelled: whether the measured markers of rigid bodies are streamed.
    lost: indices of frames that never arrive.  garbled: whether a packet that cannot be read comes before each frame.
    deaf: to what messages it does not reply.  after: is called when the whole take is sent.
    """

    def __init__(
        self,
        take: Take,
        *,
        version: tuple[int, int] = (3, 1),
        names: tuple[str, ...] = ("Pen", "Canvas"),
        labelled: bool = True,
        lost: Collection[int] = (),
        garbled: bool = False,
        deaf: Collection[int] = (),
        after: Callable[[], None] = lambda: None,
    ) -> None:
        super().__init__(daemon=True)
        self.take, self.version, self.names, self.labelled = take, version, names, labelled
        self.lost, self.garbled, self.deaf, self.after = lost, garbled, deaf, after
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(0.02)
        self.address = "127.0.0.1:{1}".format(*self.socket.getsockname())
        self._going = True

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._going = False
        self.join()
        self.socket.close()

    def run(self) -> None:
        while self._going:
            try:
                message, client = self.socket.recvfrom(1024)
            except TimeoutError:
                continue
            (kind,) = struct.unpack_from("<H", message)
            if kind in self.deaf:
                continue
            if kind == _CONNECT:
                info = b"Motive".ljust(256, b"\0") + bytes([3, 1, 0, 0]) + bytes([*self.version, 0, 0])
                self.send(_SERVER_INFO, info, client)
            elif kind == _REQUEST_MODELS:
                self.send(_MODELS, self.models(), client)
                for index in range(len(self.take)):
                    if self.garbled:
                        self.send(_FRAME, b"\xff" * 40, client)
                    if index not in self.lost and _FRAME not in self.deaf:
                        self.send(_FRAME, self.frame(index), client)
                        time.sleep(_BETWEEN)
                self.after()

    def send(self, kind: int, content: bytes, client: tuple[str, int]) -> None:
        self.socket.sendto(struct.pack("<HH", kind, len(content)) + content, client)

    def models(self) -> bytes:
        """What is tracked: a marker set, which says nothing new, and the rigid bodies."""
        sets = [_text("all") + struct.pack("<I", 1) + _text("Pen_1")]
        bodies = []
        for name, number, offsets in zip(self.names, (_PEN, _CANVAS), self.offsets(), strict=False):
            body = _text(name) + struct.pack("<Ii3f", number, -1, 0, 0, 0)
            if self.version >= (4, 2):
                body += struct.pack("<4f", 0, 0, 0, 1)
            body += struct.pack("<I", len(offsets)) + offsets.astype("<f4").tobytes() + bytes(4 * len(offsets))
            if self.version >= (4, 0):
                body += b"".join(_text(f"Marker {place + 1:03}") for place in range(len(offsets)))
            bodies.append(body)
        models = struct.pack("<I", len(sets) + len(bodies))
        for kind, model in [*((0, model) for model in sets), *((1, model) for model in bodies)]:
            models += (
                struct.pack("<I", kind) + (struct.pack("<I", len(model)) if self.version >= (4, 1) else b"") + model
            )
        return models

    def offsets(self) -> tuple[Floats, Floats]:
        """The pen's markers and the canvas's, each in the frame of its rigid body."""
        pen = np.arange(3.0 * self.take.pen_markers.shape[1]).reshape(-1, 3) * 1e-3
        return pen, self.take.canvas_markers[0] - self.take.canvas_markers[0].mean(axis=0)

    def frame(self, index: int) -> bytes:
        """The frame with this index of the take."""
        take = self.take
        poses = [(_PEN, np.concatenate([take.pen_positions[index], take.pen_rotations[index]]))]
        members = [(_PEN << 16) + 1 + place for place in range(take.pen_markers.shape[1])]
        flags = [_HAS_MODEL] * len(members)
        if len(self.names) > 1:
            poses.append((_CANVAS, np.append(take.canvas_markers[index].mean(axis=0), [0, 0, 0, 1])))
            members += [(_CANVAS << 16) + 1 + place for place in range(3)]
            flags += [_HAS_MODEL] * 3
        else:
            members += [1001, 1002, 1003]
            flags += [_UNLABELLED] * 3
        markers = []
        places = np.concatenate([take.pen_markers[index], take.canvas_markers[index]])
        for member, flag, place in zip(members, flags, places, strict=True):
            lost = np.isnan(place).any()
            if self.labelled or flag == _UNLABELLED:
                numbers = np.nan_to_num(place)
                markers.append(
                    struct.pack("<I4fHf", member, *numbers, 0.006, flag | (_OCCLUDED if lost else _SOLVED), 0)
                )
        bodies = [
            struct.pack("<I8fH", number, *np.nan_to_num(pose), 1e-4, not np.isnan(pose).any()) for number, pose in poses
        ]
        parts: list[list[bytes]] = [[], [], bodies, [], markers, [], []]  # sets, others, skeletons, plates, devices
        if self.version >= (4, 1):
            parts.insert(4, [])  # assets
        frame = struct.pack("<I", index)
        for part in parts:
            content = b"".join(part)
            frame += struct.pack("<I", len(part))
            frame += (struct.pack("<I", len(content)) if self.version >= (4, 1) else b"") + content
        return frame + struct.pack("<IIdQQQH", 0, 0, take.times[index], 0, 0, 0, 0) + bytes(4)


def _text(text: str) -> bytes:
    return text.encode() + b"\0"
