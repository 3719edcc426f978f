"""Readers of Wacom's ink: UIM documents (3.0 and 3.1) and WILL 2 files, both by Wacom's universal-ink-library."""

import io
import logging
import warnings
import zipfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from maulstick.errors import InputError, how_to_add
from maulstick.recording.files.curves import catmull_rom, polylines
from maulstick.recording.files.page import Page
from maulstick.storage.arrays import Floats

_LARGEST = 64 * 2**20  # bytes, unpacked: no drawing is larger


@contextmanager
def _library() -> Iterator[None]:
    """Silence log and warnings of Wacom's library while it runs. Raises InputError where it is missing."""
    disabled = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except ModuleNotFoundError as error:
        raise InputError(f"reading it needs Wacom's library; {how_to_add('wacom')}") from error
    finally:
        logging.disable(disabled)


def read_uim(content: bytes) -> Page:
    """Read the page of a UIM document.

    It has the sensor data, in seconds and metres, where every stroke has some; pressures of a channel that has one
    beyond 1 are divided by its maximum. Otherwise it has the strokes' splines, sampled as in `curves.polylines`, in an
    unknown unit and without times and pressure. Strokes that share their sensor data, as after an eraser cut them,
    count as having none.
    Raises InputError, or the library's own error, where the document cannot be read.
    """
    with _library():
        from uim.codec.parser.uim import UIMParser  # type: ignore[import-untyped]

        model: Any = UIMParser().parse(content)
        strokes = model.strokes
        if strokes:
            uses = Counter(stroke.sensor_data_id for stroke in strokes)
            sensed = None not in uses and max(uses.values()) == 1
            records = [model.sensor_data.sensor_data_by_id(name) for name in uses] if sensed else []
        else:
            records = [record for record in model.sensor_data if record.state is None or record.state.name == "PLANE"]
        seen = [_sensed(model, record) for record in records]
        if seen and all(each is not None for each in seen):
            return Page(_of_full_pressure([each for each in seen if each is not None]), 1.0, None, "UIM")
        return _splines([_points(stroke.splines_x, stroke.splines_y) for stroke in strokes], "UIM")


def _sensed(model: Any, record: Any) -> tuple[Floats, Any] | None:
    """Return a stroke (m, 4) of sensor data, its pressure in the channel's unit, and that channel, if it has one.

    None where its place is not in metres.
    """
    inputs = model.input_configuration
    context = inputs.get_sensor_context(inputs.get_input_context(record.input_context_id).sensor_context_id)
    channels = {channel.type.name: channel for part in context.sensor_channels_contexts for channel in part.channels}
    values = {name: np.array(record.get_data_by_id(channel.id).values) for name, channel in channels.items()}
    places = [values.get(name, np.zeros(0)) for name in "XY"]
    if not len(places[0]) == len(places[1]) > 0 or any(channels[name].metric.name != "LENGTH" for name in "XY"):
        return None
    stroke = np.full((len(places[0]), 4), np.nan)
    stroke[:, 1], stroke[:, 2] = places
    for column, name in ((0, "TIMESTAMP"), (3, "PRESSURE")):
        if len(values.get(name, ())) == len(stroke):
            stroke[:, column] = values[name]
    if "TIMESTAMP" in channels:
        # The first time of a record is in milliseconds, but the library reads it in the channel's unit.
        steps = channels["TIMESTAMP"].resolution * 10.0 ** channels["TIMESTAMP"].precision
        stroke[:, 0] += stroke[0, 0] * (steps * 1e-3 - 1)
    return stroke, channels.get("PRESSURE")


def _of_full_pressure(seen: list[tuple[Floats, Any]]) -> list[Floats]:
    """Return the strokes with their pressure as a share of the full one of its channel."""
    largest: dict[Any, float] = {}
    for stroke, channel in seen:
        if channel is not None and not np.isnan(stroke[:, 3]).any():
            largest[channel.id] = max(largest.get(channel.id, 1.0), float(stroke[:, 3].max()))
    for stroke, channel in seen:
        if channel is not None and (most := largest.get(channel.id)) is not None:
            stroke[:, 3] = np.clip(stroke[:, 3] / (most if most == 1 else max(channel.max, most)), 0, 1)
    return [stroke for stroke, _ in seen]


def read_will(content: bytes) -> Page:
    """Read the page of a WILL 2 file: its splines (`curves.polylines`), without times and pressure, in an unknown unit.

    Raises InputError where the file cannot be read.
    """
    with _library():
        from uim.codec.format.WILL_2_0_0_pb2 import Path  # type: ignore[import-untyped]

        strokes = []
        for message in _messages(_protobuf(content)):
            path: Any = Path()
            path.ParseFromString(message)
            steps = np.array(path.data, dtype=np.float64)
            if len(steps) % 2:
                raise InputError("a stroke in it has an x without y; save it again")
            strokes.append(np.cumsum(steps.reshape(-1, 2), axis=0) / 10.0 ** min(path.decimalPrecision, 20))
    return _splines(strokes, "WILL")


def _protobuf(content: bytes) -> bytes:
    with zipfile.ZipFile(io.BytesIO(content)) as entries:
        names = [entry for entry in entries.infolist() if entry.filename.endswith("strokes.protobuf")]
        if not names:
            raise InputError("there are no strokes in it: a WILL 2 file keeps them in sections/media/strokes.protobuf")
        if sum(entry.file_size for entry in names) > _LARGEST:
            raise InputError(f"its strokes unpack to over {_LARGEST >> 20} MiB; no drawing is that large")
        return b"".join(entries.read(entry) for entry in names)


def _messages(content: bytes) -> Iterator[bytes]:
    """Yield Protobuf messages, each preceded by its length as a varint."""
    place = 0
    while place < len(content):
        length = shift = 0
        while True:
            if place >= len(content) or shift > 28:
                raise InputError("its strokes are cut short or damaged; copy it again")
            byte = content[place]
            length |= (byte & 0x7F) << shift
            place, shift = place + 1, shift + 7
            if byte < 0x80:
                break
        if place + length > len(content):
            raise InputError("its strokes are cut short or damaged; copy it again")
        yield content[place : place + length]
        place += length


def _points(x: list[float], y: list[float]) -> Floats:
    return np.column_stack([np.array(x, dtype=np.float64), np.array(y, dtype=np.float64)])


def _splines(strokes: list[Floats], kind: str) -> Page:
    """Return a page of Catmull-Rom splines, each through all of its points but the first and last."""
    points = [points if len(points) > 3 else points[:1].repeat(4, axis=0) for points in strokes if len(points)]
    lines = polylines([catmull_rom(each) for each in points])
    padded = [np.pad(line, ((0, 0), (1, 1)), constant_values=np.nan) for line in lines]
    return Page(padded, None, None, kind)
