"""Takes of a simulated pen that draws real or made-up strokes, as motion capture would see it.

The pen draws each stroke as it is given, at 240 Hz, then lifts and travels to the next: 100 to 400 ms, longer over
longer ways, leaving the paper with the speed that it had and arriving with that of the next stroke, and 1.5 to 8 mm
high. It leans by 20 to 40 degrees, slowly changing, as does its turn about itself. Every marker has Gaussian noise of
its own in each frame, and the pen's pose is what best fits its four noisy markers.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation
from scipy.special import expit

from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import resample

DATA = Path(__file__).parents[4] / "shared" / "data"
SESSIONS = ("cat", "circular", "lia", "long", "strokes")
RATE = 240.0
TIP = np.array([0.0, -0.139, 0.0])
SHEET = (0.24, 0.19)
MARKERS = np.array([(21.0, -8.0, 3.0), (-13.0, -6.0, 19.0), (-11.0, -9.0, -20.0), (2.0, 24.0, -1.0)]) * 1e-3
_FEWEST, _SHORTEST = 12, 1e-3  # samples, metres: less is a dot, or a twitch of the recording, and is not drawn


@dataclass(frozen=True)
class Faults:
    """What goes wrong: metres of noise, and how often a minute the rest happens.

    The pen is lost, or two of its markers are taken for each other, for up to 100 ms, and seen well for 300 ms between;
    a marker of the canvas is lost for up to 0.8 s, or two of its markers have swapped names for up to 0.2 s.
    """

    noise: float = 1e-4
    pen_lost: float = 20.0
    pen_swapped: float = 10.0
    canvas_lost: float = 20.0
    canvas_swapped: float = 10.0


NONE = Faults(0, 0, 0, 0, 0)


def mocap_strokes(session: str) -> list[Floats]:
    """The strokes (m, 2) of a motion-capture session, without dots."""
    path = DATA / f"mocap_{session}.npz"
    if not path.exists():
        pytest.skip("shared data absent: motion-capture sessions")
    arrays = np.load(path, allow_pickle=False)
    return _worth_drawing(np.split(arrays["points_m"], np.cumsum(arrays["lengths"])[:-1]))


def wacom_strokes(source: str) -> list[Floats]:
    """The strokes (m, 2) of a Wacom drawing 150 mm large, drawn at 40 to 120 mm/s, slower in curves."""
    path = DATA / "uil_strokes.npz"
    if not path.exists():
        pytest.skip("shared data absent: Wacom drawings")
    arrays = np.load(path, allow_pickle=False)
    strokes = np.split(arrays["data"][:, :2], np.cumsum(arrays["lens"])[:-1])
    chosen = [stroke for stroke, of in zip(strokes, arrays["source"], strict=True) if of == source]
    every = np.concatenate(chosen)
    scale = 0.15 / np.ptp(every, axis=0).max()
    return _worth_drawing([paced((stroke - every.min(axis=0)) * scale + 0.02) for stroke in chosen])


def loops_and_lines(number: int = 12) -> list[Floats]:
    """Made-up strokes: loops 3 to 12 mm wide, arcs and hooks."""
    rng = np.random.default_rng(5)
    strokes = []
    for i in range(number):
        turn, along = np.linspace(0, (6.0, 2.0, 9.0)[i % 3], 200), np.linspace(0, (0.01, 0.03, 0.02)[i % 3], 200)
        radius = rng.uniform(1.5e-3, 6e-3)
        path = np.stack([radius * np.cos(turn) + along, radius * np.sin(turn)], axis=1)
        heading = Rotation.from_euler("z", rng.uniform(0, 6.28)).as_matrix()[:2, :2]
        strokes.append(paced(path @ heading.T + rng.uniform((0.05, 0.05), (0.19, 0.14))))
    return strokes


def paced(path: Floats) -> Floats:
    """The path at the pace of a hand: bell-shaped speed, slower in curves."""
    fine = resample(path, max(8, int(np.hypot(*np.diff(path, axis=0).T).sum() / 1e-4)))
    fine = np.stack([gaussian_filter1d(column, 3, mode="nearest") for column in fine.T], axis=1)
    steps = np.hypot(*np.diff(fine, axis=0).T)
    turns = np.abs(np.gradient(np.unwrap(np.arctan2(*np.gradient(fine, axis=0).T[::-1]))))[:-1] / np.maximum(
        steps, 1e-9
    )
    share = np.linspace(0, 1, len(steps))
    speeds = 0.04 + 0.08 * np.minimum(1, 4 * share * (1 - share)) / (1 + gaussian_filter1d(turns, 10) / 300)
    times = np.concatenate([[0], np.cumsum(steps / speeds)])
    wanted = np.arange(0, times[-1], 1 / RATE)
    return np.stack([np.interp(wanted, times, column) for column in fine.T], axis=1)


def _worth_drawing(strokes: Sequence[Floats]) -> list[Floats]:
    long = [stroke for stroke in strokes if len(stroke) >= _FEWEST]
    return [stroke for stroke in long if np.hypot(*np.diff(stroke, axis=0).T).sum() >= _SHORTEST]


@dataclass(frozen=True)
class Simulated:
    """A take, and the strokes (m, 2) on the canvas that it shows."""

    take: Take
    strokes: list[Floats]


def simulate(
    strokes: list[Floats],
    seed: int,
    faults: Faults | None = None,
    *,
    corner: int = 0,
    marker_heights: tuple[float, float, float] = (0.0, 0.0, 0.0),
    bump: float = 0.0,
) -> Simulated:
    """A take of these strokes on a sheet of SHEET, of which the markers sit on three corners.

    corner: which of the corners has the right angle's marker, clockwise from the upper left one.
    marker_heights: metres that the markers' centres lie over the paper.  bump: metres that the board is pushed, once.
    """
    rng, faults = np.random.default_rng(seed), faults or Faults()
    places = _way(strokes, rng)
    frames = len(places)
    times = np.arange(frames) / RATE
    up = np.array([1, -1, -1])  # from the canvas's frame, with z into the paper, to one with z up
    lean = Rotation.from_euler("x", 90, degrees=True)  # the pen's own axis y points up
    angles = np.stack([_drift(times, rng, *of) for of in ((-40, 40), (20, 40), (-30, 30))], axis=1)
    poses = Rotation.from_euler("ZXZ", angles, degrees=True) * lean
    pen = (poses.as_matrix() @ (MARKERS - TIP).T).swapaxes(1, 2) + (places * up)[:, None]
    width, height = SHEET
    corners = np.array([(0, 0), (width, 0), (width, height), (0, height)])[np.arange(corner - 1, corner + 2) % 4]
    canvas = np.concatenate([corners, -np.array(marker_heights)[:, None]], axis=1) * up
    canvas = np.tile(canvas[rng.permutation(3)], (frames, 1, 1))
    pushed = bump * expit((times - times[-1] / 2) / 0.02)[:, None, None] * np.array([0.8, 0.6, 0])
    world, away = Rotation.random(random_state=seed), rng.uniform(-2, 2, 3)
    pen, canvas = (world.apply((m + pushed).reshape(-1, 3)).reshape(m.shape) + away for m in (pen, canvas))
    pen += rng.normal(0, faults.noise, pen.shape)
    canvas += rng.normal(0, faults.noise, canvas.shape)
    positions, rotations, pen = _seen(pen, faults, rng)
    for rows in _events(rng, frames, faults.canvas_swapped, 50):
        canvas[rows] = canvas[rows][:, _two_swapped(3, rng)]
    for rows in _events(rng, frames, faults.canvas_lost, 200):
        canvas[rows, rng.integers(3)] = np.nan
    return Simulated(Take(times, positions, rotations, pen, canvas), strokes)


def pivot_take(seed: int, lean: float = 30.0, faults: Faults | None = None) -> Take:
    """A take of the pen turned about its tip, leaning by up to `lean` degrees."""
    rng, faults = np.random.default_rng(seed), faults or Faults()
    times = np.arange(round(10 * RATE)) / RATE
    turning = np.stack([360 * times / 5, lean * np.sin(times) ** 2, _drift(times, rng, -lean, lean)], axis=1)
    poses = Rotation.from_euler("YXY", turning, degrees=True)
    pen = (poses.as_matrix() @ (MARKERS - TIP).T).swapaxes(1, 2) + rng.uniform(-1, 1, 3)
    pen += rng.normal(0, faults.noise, pen.shape)
    positions, rotations, pen = _seen(pen, faults, rng)
    return Take(times, positions, rotations, pen, np.tile(np.eye(3) * 0.2, (len(times), 1, 1)))


def distances(recovered: Floats, drawn: Floats) -> Floats:
    """From each sample of either stroke to the nearest place on the other, metres; the ends are samples, too."""
    there = KDTree(resample(drawn, 2000)).query(recovered)[0]
    back = KDTree(resample(recovered, 2000)).query(drawn)[0]
    return np.concatenate([there, back])


def way_of(strokes: list[Floats], seed: int) -> Floats:
    """The true places (F, 3) of the tip in the take simulated with this seed: x, y, and z into the paper."""
    return _way(strokes, np.random.default_rng(seed))


def _way(strokes: list[Floats], rng: np.random.Generator) -> Floats:
    """Places (F, 3) of the tip in the frame of the canvas: each stroke, and the lifts between, before and after."""
    ends = [strokes[0][:1] - (0.03, 0.02), *strokes, np.add(strokes[-1][-1:], (0.02, 0.03))]
    parts = []
    for number, (stroke, following) in enumerate(pairwise(ends)):
        parts.append(np.pad(stroke, ((0, 0), (0, 1)))[: len(stroke) * (number > 0)])
        far = float(np.hypot(*(following[0] - stroke[-1])))
        seconds = float(np.clip(0.1 + far / 0.4 + rng.uniform(0, 0.1), 0.1, 0.4))
        high = 1.5e-3 + min(1.0, far / 0.05) * rng.uniform(0, 6.5e-3)
        wanted = np.arange(1, round(seconds * RATE)) / RATE
        speeds = [(path[-1] - path[0]) * RATE / max(1, len(path) - 1) for path in (stroke[-4:], following[:4])]
        travel = CubicHermiteSpline([0, seconds], [stroke[-1], following[0]], speeds)(wanted)
        rise = np.sin(np.pi * wanted / seconds) ** 2
        if number in (0, len(strokes)):  # the pen comes from where it hovers, and goes on hovering at the end
            rise[(wanted < seconds / 2) == (number == 0)] = 1
        parts.append(np.column_stack([travel, -high * rise]))
    return np.concatenate(parts)


def _drift(times: Floats, rng: np.random.Generator, least: float, most: float) -> Floats:
    waves = [np.sin(times * rng.uniform(0.3, 2.5) + rng.uniform(0, 6.28)) for _ in range(3)]
    drift: Floats = least + (most - least) * (0.5 + np.sum(waves, axis=0) / 6)
    return drift


def _events(rng: np.random.Generator, frames: int, a_minute: float, longest: int) -> list[slice]:
    """Stretches of 1 to `longest` frames, with a third of a second between them."""
    starts = np.sort(rng.integers(0, frames, rng.poisson(a_minute * frames / RATE / 60)))
    starts = starts[np.diff(starts, prepend=-frames) > longest + RATE / 3]
    return [slice(start, start + rng.integers(1, longest + 1)) for start in starts]


def _two_swapped(number: int, rng: np.random.Generator) -> list[int]:
    order = list(range(number))
    i, j = rng.choice(number, 2, replace=False)
    order[i], order[j] = order[j], order[i]
    return order


def _seen(markers: Floats, faults: Faults, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Positions (F, 3), quaternions (F, 4) and markers (F, 4, 3) of the pen, with markers swapped, or with it lost."""
    markers = markers.copy()
    lost = []
    for rows in _events(rng, len(markers), faults.pen_swapped + faults.pen_lost, 24):
        if rng.random() * (faults.pen_swapped + faults.pen_lost) < faults.pen_swapped:
            markers[rows] = markers[rows][:, _two_swapped(4, rng)]
        else:
            lost.append(rows)
    positions, rotations = _rigid_body(markers)
    for rows in lost:
        positions[rows], rotations[rows], markers[rows] = np.nan, np.nan, np.nan
    return positions, rotations, markers


def _rigid_body(markers: Floats) -> tuple[Floats, Floats]:
    """Positions (F, 3) and quaternions (F, 4) that best put MARKERS onto the markers (F, 4, 3) (Kabsch)."""
    centred = markers - markers.mean(axis=1, keepdims=True)
    own = MARKERS - MARKERS.mean(axis=0)
    u, _, v = np.linalg.svd(np.einsum("fmi,mj->fij", centred, own))
    u[:, :, 2] *= np.sign(np.linalg.det(u @ v))[:, None]
    rotations = u @ v
    return markers.mean(axis=1) - rotations @ MARKERS.mean(axis=0), Rotation.from_matrix(rotations).as_quat()
