"""A cheap webcam above an easel: it knows all that a real one suffers from, and tells nobody."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.camera import Camera, CameraError
from maulstick.robot.camera.opencv import opencv
from maulstick.robot.camera.tag_frame import TAGS, TagFrame
from maulstick.storage.arrays import Floats, Image

_FINER = 2  # samples across a pixel
_VIEW = 1.06  # of what must be seen
_CENTRE = (0.006, -0.004)  # of the photograph's width: no lens sits right above its sensor
_SENSOR = np.array([[0.74, 0.08, -0.02], [0.04, 0.69, 0.04], [0.0, 0.07, 0.58]], dtype=np.float32)
_TONE = 0.012  # by which makers bend the curve of sRGB
_WOOD = np.array([0.115, 0.075, 0.05], dtype=np.float32)  # light
_GRAIN = 0.35  # of it
_CARD = 0.82  # light off printer paper; and off its black:
_PRINT = 0.035


@dataclass(frozen=True)
class Optics:
    """What is wrong with the camera, in order of what it does to a photograph.

    size: width and height, pixels.  focal: of the width.  tilt: forwards and sideways, radians.
    bend: radial distortion k1, k2.  lamp: right, below and above the middle, in halves of what the tags enclose.
    vignette: how much darker the photograph's corners are.
    drift: of the exposure from one photograph to the next, one sigma.  noise: in the mid-tones, one sigma.
    """

    size: tuple[int, int] = (1600, 1200)
    focal: float = 0.9
    tilt: tuple[float, float] = (0.14, -0.06)
    bend: tuple[float, float] = (-0.1, 0.015)
    lamp: tuple[float, float, float] = (-0.6, 0.4, 3.0)
    vignette: float = 0.12
    drift: float = 0.03
    noise: float = 0.008


@dataclass(frozen=True)
class _Pose:
    """turn: (3, 3) from the bed to the camera.  place: of the bed's origin in the camera's frame, metres."""

    turn: Floats
    place: Floats


_WEBCAM = Optics()


@final
class SimulatedCamera(Camera):
    """Photographs of a sheet on a wooden bed, with the cards of four tags at its corners.

    scene: the sheet as it is at the moment, (h, w, 3) sRGB, of any resolution.  canvas: its size.  rng: all chance.
    tags: theirs; of the canvas with the usual cards when left out.
    """

    def __init__(
        self,
        scene: Callable[[], Image],
        canvas: Canvas,
        rng: np.random.Generator,
        optics: Optics = _WEBCAM,
        tags: TagFrame | None = None,
    ) -> None:
        self._cv2 = opencv()
        self._scene, self._canvas, self._rng, self._optics = scene, canvas, rng, optics
        self._tags = tags or TagFrame(canvas.width, canvas.height)
        self._plugged, self._lit = True, True
        self._covered: frozenset[int] = frozenset()
        self._moved = (0.0, 0.0, 0.0)
        self._grain = _wood(rng)
        tilts = (*(np.array(optics.tilt) + rng.normal(0, 0.01, 2)), rng.normal(0, 0.015))
        self._look(self._framed(_turn(tilts)))

    def close(self) -> None:
        """The same as to unplug it."""
        self._plugged = False

    def unplug(self) -> None:
        """Pull the cable: there are no more photographs, until `plug_in`."""
        self._plugged = False

    def plug_in(self) -> None:
        """Put the cable back."""
        self._plugged = True

    def black(self, off: bool = True) -> None:
        """Switch the light off, or on again."""
        self._lit = not off

    def cover(self, *tags: int) -> None:
        """Something dark lies on these tags, and on no others."""
        if odd := sorted(set(tags) - set(TAGS)):
            raise InputError.of_range("a tag", odd[0], "0, 1, 2 or 3")
        self._covered = frozenset(tags)
        self._bed = self._photographed_bed()

    def move_paper(self, dx: float, dy: float, dtheta: float = 0.0) -> None:
        """Move the sheet on the bed, from where it is: turn it about its middle, then shift it. Metres, radians."""
        self._moved = (self._moved[0] + dx, self._moved[1] + dy, self._moved[2] + dtheta)

    def bump(self, dx: float, dy: float, dtheta: float = 0.0) -> None:
        """Knock the camera: what it sees shifts by this much on the bed, and turns. Metres, radians."""
        turn = _turn((0.0, 0.0, dtheta))
        self._look(_Pose(turn @ self._pose.turn, turn @ (self._pose.place - self._pose.turn @ (dx, dy, 0.0))))

    def _take(self) -> Image:
        if not self._plugged:
            raise CameraError("the simulated camera sends no picture; plug it in again, and go on")
        light = self._bed.copy()
        self._lay(light, light_of(self._scene()), self._sheet_corners())
        light *= self._lamp[..., None]
        light = light @ _SENSOR.T * np.float32(self._lit * np.exp(self._rng.normal(0, self._optics.drift)))
        noise = self._rng.standard_normal(light.shape, dtype=np.float32)
        light += noise * np.float32(self._optics.noise) * np.sqrt(np.maximum(light, 0) + np.float32(0.01))
        colours = colours_of(light)
        colours += np.float32(_TONE) * np.sin(np.float32(2 * np.pi) * colours)
        return np.asarray(np.round(colours * np.float32(255)).clip(0, 255) / np.float32(255), dtype=np.float32)

    def _sheet_corners(self) -> Floats:
        width, height = self._canvas.width, self._canvas.height
        dx, dy, angle = self._moved
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        middle = np.array([width, height]) / 2
        corners = np.array([[0, 0], [width, 0], [width, height], [0, height]]) - middle
        return np.asarray(corners @ turn.T + middle + (dx, dy))

    def _framed(self, turn: Floats) -> _Pose:
        """A pose with this turn, from where all cards are seen."""
        outer = np.concatenate([self._tags.card_corners(tag) for tag in TAGS])
        middle = (outer.min(0) + outer.max(0)) / 2
        half = np.array(self._optics.size) / 2
        near, far = 0.1 * np.ptp(outer), 10 * np.ptp(outer)
        for _ in range(40):
            distance = (near + far) / 2
            pose = _Pose(turn, np.array([0, 0, distance]) - turn @ (*middle, 0.0))
            reach = np.abs(self._project(outer, pose) - half).max(0)
            near, far = (near, distance) if (reach * _VIEW <= half).all() else (distance, far)
        return pose

    def _look(self, pose: _Pose) -> None:
        self._pose = pose
        width, height = self._optics.size
        coarse = self._unproject(np.arange(width), np.arange(height))
        # Between pixels the map is straight to a thousandth of one.
        self._places = self._cv2.resize(coarse, (width * _FINER, height * _FINER), interpolation=self._cv2.INTER_LINEAR)
        half = np.array([self._canvas.width, self._canvas.height]) / 2
        lamp = np.array(self._optics.lamp)
        off = (coarse - half) / (half.max() + self._tags.card) - lamp[:2]
        fall = ((lamp @ lamp) / ((off**2).sum(axis=-1) + lamp[2] ** 2)) ** 1.5
        edge = np.hypot(*np.meshgrid(np.linspace(-1, 1, width), np.linspace(-1, 1, height))) / np.sqrt(2)
        self._lamp = np.asarray(fall * (1 - self._optics.vignette * edge**2), dtype=np.float32)
        self._bed = self._photographed_bed()

    def _project(self, points: Floats, pose: _Pose) -> Floats:
        """Pixels of points (N, 2) on the bed, metres."""
        seen = points @ pose.turn[:, :2].T + pose.place
        flat = seen[:, :2] / seen[:, 2:]
        squared = (flat**2).sum(1, keepdims=True)
        k1, k2 = self._optics.bend
        return np.asarray(flat * (1 + k1 * squared + k2 * squared**2) * self._focal + self._centre)

    def _unproject(self, across: NDArray[np.int64], down: NDArray[np.int64]) -> Image:
        """(down, across, 2) metres on the bed, of pixels."""
        x, y = np.meshgrid((across - self._centre[0]) / self._focal, (down - self._centre[1]) / self._focal)
        bent = np.hypot(x, y)
        straight = np.linspace(0, 2 * bent.max(), 20_000)
        k1, k2 = self._optics.bend
        table = straight * (1 + k1 * straight**2 + k2 * straight**4)
        factor = np.interp(bent, table, straight) / np.maximum(bent, 1e-12)
        turn, place = self._pose.turn, self._pose.place
        to_bed = np.linalg.inv(np.column_stack([turn[:, :2], place]))
        flat = np.stack([x * factor, y * factor, np.ones_like(x)], axis=-1) @ to_bed.T
        return np.asarray(flat[..., :2] / flat[..., 2:], dtype=np.float32)

    @property
    def _focal(self) -> float:
        return self._optics.focal * self._optics.size[0]

    @property
    def _centre(self) -> Floats:
        width, height = self._optics.size
        return np.asarray(np.array([width - 1, height - 1]) / 2 + width * np.array(_CENTRE), dtype=np.float64)

    def _photographed_bed(self) -> Image:
        """Light off the bed and its cards, (H, W, 3)."""
        size = self._grain.shape[0] - 1
        extent = 3 * max(self._canvas.width, self._canvas.height)
        at = (self._places / np.float32(extent) + np.float32(0.5)) * np.float32(size)
        grain = self._cv2.remap(self._grain, at, None, self._cv2.INTER_LINEAR, borderMode=self._cv2.BORDER_REFLECT)
        light = (1 + _GRAIN * self._shrunk(grain))[..., None] * _WOOD
        for tag in set(TAGS) - self._covered:
            grey = self._tags.card_picture(tag, 8_000).astype(np.float32) / 255 * (_CARD - _PRINT) + _PRINT
            self._lay(light, np.repeat(grey[..., None], 3, axis=2), self._tags.card_corners(tag))
        for tag in self._covered:
            self._lay(light, np.full((2, 2, 3), 0.02, dtype=np.float32), self._tags.card_corners(tag))
        return light

    def _lay(self, light: Image, picture: Image, corners: Floats) -> None:
        """Put a picture (h, w, 3) of light on the bed, its corners (4, 2) in metres; it hides what is under it."""
        cv2 = self._cv2
        width, height = self._optics.size
        seen = self._project(corners, self._pose)
        density = np.linalg.norm(np.diff(seen, axis=0, append=seen[:1]), axis=1)
        shape = (
            min(picture.shape[1], round(max(density[0], density[2]) * _FINER) + 1),
            min(picture.shape[0], round(max(density[1], density[3]) * _FINER) + 1),
        )
        picture = cv2.resize(picture, shape, interpolation=cv2.INTER_AREA)
        picture = np.concatenate([picture, np.ones_like(picture[..., :1])], axis=2)
        left, top = np.clip(np.floor(seen.min(0)).astype(int) - 8, 0, (width, height))
        right, bottom = np.clip(np.ceil(seen.max(0)).astype(int) + 8, 0, (width, height))
        if right <= left or bottom <= top:
            return
        places = self._places[_FINER * top : _FINER * bottom, _FINER * left : _FINER * right]
        axes = np.stack([(corners[1] - corners[0]) / shape[0], (corners[3] - corners[0]) / shape[1]], axis=1)
        to_picture = np.linalg.inv(axes).astype(np.float32)
        at = (places - corners[0].astype(np.float32)) @ to_picture.T - np.float32(0.5)
        laid = cv2.remap(picture, at, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
        laid = self._shrunk(laid)
        part = light[top:bottom, left:right]
        part *= 1 - laid[..., 3:]
        part += laid[..., :3]

    def _shrunk(self, fine: Image) -> Image:
        size = (fine.shape[1] // _FINER, fine.shape[0] // _FINER)
        return np.asarray(self._cv2.resize(fine, size, interpolation=self._cv2.INTER_AREA))


def _wood(rng: np.random.Generator) -> Image:
    """Grain along x, (513, 513), about 0."""
    noise = np.fft.rfft2(rng.standard_normal((513, 513)))
    along, across = np.fft.rfftfreq(513), np.fft.fftfreq(513)[:, None]
    noise *= np.exp(-((60 * along) ** 2)) / (1 + (12 * across) ** 2)
    grain = np.fft.irfft2(noise, s=(513, 513))
    return np.asarray(grain / grain.std() / 2, dtype=np.float32)


def _turn(angles: tuple[float, ...]) -> Floats:
    """Rotation about x, then y, then z."""
    (a, b, c), (d, e, f) = np.cos(angles), np.sin(angles)
    about_x = np.array([[1, 0, 0], [0, a, -d], [0, d, a]])
    about_y = np.array([[b, 0, e], [0, 1, 0], [-e, 0, b]])
    about_z = np.array([[c, -f, 0], [f, c, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)
