"""Parser of the text of an InkML trace (W3C Recommendation of 20 September 2011, section 3.2.1)."""

import re

import numpy as np

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats

_BEYOND_PLAIN = re.compile(r"[^\d\s.,eE+-]", re.ASCII)
_VALUE = re.compile(
    r"""\s*(?:(?P<comma>,)|(?P<order>[!'"]?)\s*(?:(?P<hex>-?\#[0-9A-Fa-f]+)|(?P<word>[TF*?])"""
    r"""|(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)))""",
    re.ASCII,
)
_ORDERS = {"!": 0, "'": 1, '"': 2}  # prefixes of values, first and second differences


def points_of(text: str, channels: int) -> Floats:
    """Parse the points (m, channels) of a trace, NaN where a value is unknown, missing at a point's end, or boolean.

    Raises InputError at the first text that is not a value, or where a point has more values than there are channels.
    """
    plain = None if _BEYOND_PLAIN.search(text) else _plain(text, channels)
    return plain if plain is not None else _coded(text, channels)


def _plain(text: str, channels: int) -> Floats | None:
    """Parse points of separate values without prefixes, none missing; return None where the text is not that simple."""
    try:
        points = np.array([point.split() for point in text.split(",") if point.strip()], dtype=np.float64)
    except ValueError:
        return None
    return points if points.ndim == 2 and points.shape[1] == channels else None


def _coded(text: str, channels: int) -> Floats:
    """Parse points with prefixes: each channel keeps its order, 0 for values, 1 for differences, 2 for theirs."""
    points: list[list[float]] = []
    orders = [0] * channels
    values, speeds, changes = ([0.0] * channels for _ in range(3))
    point: list[float] = []
    end = len(text.rstrip())
    place = 0
    while place < end:
        match = _VALUE.match(text, place)
        if match is None:
            raise InputError(f"a trace has {text[place : place + 20].strip()!r} where a value must be")
        place = match.end()
        if match["comma"]:
            points.append(point)
            point = []
            continue
        channel = len(point)
        if channel == channels:
            raise InputError(f"a point of a trace has more than {channels} values, as many as it has channels")
        orders[channel] = _ORDERS.get(match["order"], orders[channel])
        if match["word"] in ("?", "T", "F"):
            point.append(np.nan)
            continue
        if not match["word"]:  # `*` repeats the last value or difference
            came = float(match["number"]) if match["number"] else float(int(match["hex"].replace("#", ""), 16))
            (values, speeds, changes)[orders[channel]][channel] = came
        if orders[channel] == 2:
            speeds[channel] += changes[channel]
        if orders[channel] >= 1:
            values[channel] += speeds[channel]
        point.append(values[channel])
    points = [point for point in [*points, point] if point]
    return np.array([point + [np.nan] * (channels - len(point)) for point in points]).reshape(-1, channels)
