"""Recorded hands to measure styles with. Only the Wacom drawings may be learned from in what ships."""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "experiments"))  # scripts there are not installed

from wacom import DATA, LONGER_SIDE, wacom_hands

from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import Strokes

MOCAP = ("cat", "circular", "lia", "long", "strokes")
SHEET = (0.25, 0.2)
LEAST = 1e-3
"""Metres: what is shorter is a dot, and left out everywhere."""
_FEWEST_SAMPLES = 4


def mocap_hands() -> dict[str, Strokes]:
    """The five sessions of Spline-FRIDA's authors: measured with only."""
    hands = {}
    for name in MOCAP:
        with np.load(DATA / f"mocap_{name}.npz", allow_pickle=False) as file:
            paths = np.split(file["points_m"].astype(np.float64), np.cumsum(file["lengths"])[:-1])
            rate = float(file["rate_hz"])
        samples = [
            np.column_stack([np.arange(len(path)) / rate, path, np.full(len(path), np.nan)])
            for path in paths
            if len(path) >= _FEWEST_SAMPLES
        ]
        hands[name] = _without_dots(Strokes.of(Ink.of(samples, SHEET, name)))
    return hands


def mouse_hands() -> dict[str, Strokes]:
    """Drawings of the same authors with a mouse: measured with only. Their longer side is taken as 150 mm."""
    return {f"mouse-{drawing}": strokes for drawing, strokes in _each_drawing("mouse_drawings").items()}


def human_drawings() -> dict[str, Strokes]:
    """Drawings of 62 motifs: measured with only, and constants chosen on. Their longer side is taken as 150 mm."""
    return _each_drawing("drawings")


def _each_drawing(file_name: str) -> dict[str, Strokes]:
    with np.load(DATA / f"{file_name}.npz", allow_pickle=False) as file:
        paths = np.split(file["points"].astype(np.float64), np.cumsum(file["lengths"])[:-1])
        drawings = file["drawing"]
        names = file["names"] if "names" in file else np.arange(drawings.max() + 1)
    hands = {}
    for drawing in np.unique(drawings):
        drawn = [path[:, :2] for path, of in zip(paths, drawings, strict=True) if of == drawing]
        places = np.concatenate(drawn)
        scale, origin = LONGER_SIDE / np.ptp(places, axis=0).max(), places.min(axis=0)
        unknown = [np.full((len(path), 1), np.nan) for path in drawn]
        samples = [
            np.concatenate([nan, (path - origin) * scale, nan], axis=1)
            for path, nan in zip(drawn, unknown, strict=True)
            if len(path) >= _FEWEST_SAMPLES
        ]
        hands[str(names[drawing])] = _without_dots(Strokes.of(Ink.of(samples, (LONGER_SIDE,) * 2, file_name)))
    return hands


def wacom_drawings() -> dict[str, Strokes]:
    """The Wacom drawings and documents."""
    return {name: _without_dots(strokes) for name, strokes in wacom_hands().items()}


def _without_dots(strokes: Strokes) -> Strokes:
    return strokes[strokes.lengths >= LEAST]
