"""Wacom's files, written from strokes: UIM with Wacom's own encoder, WILL 2 from its zip and protobuf."""

import io
import uuid
import zipfile
from collections.abc import Sequence

import numpy as np

from maulstick.recording.files.wacom import _library
from maulstick.storage.arrays import Floats

with _library():
    from uim.codec.format.UIM_3_0_0_pb2 import LENGTH, NORMALIZED, STROKE, STROKE_GROUP, TIME, InkObject
    from uim.codec.format.WILL_2_0_0_pb2 import Path
    from uim.codec.writer.encoder.encoder_3_1_0 import UIMEncoder310
    from uim.model.ink import InkModel, InkTree
    from uim.model.inkdata.strokes import LayoutMask, Spline, Stroke
    from uim.model.inkinput.inputdata import (
        Environment,
        InkInputProvider,
        InkInputType,
        InkSensorMetricType,
        InkSensorType,
        InputContext,
        InputDevice,
        SensorChannel,
        SensorChannelsContext,
        SensorContext,
    )
    from uim.model.inkinput.sensordata import InkState, SensorData
    from uim.model.semantics.node import StrokeGroupNode, StrokeNode


def uim(
    strokes: Sequence[Floats],
    sensors: bool = True,
    splines: bool = True,
    pressure_metric: InkSensorMetricType = InkSensorMetricType.NORMALIZED,
    place_metric: InkSensorMetricType = InkSensorMetricType.LENGTH,
    shared: bool = False,
) -> bytes:
    """A document of strokes (m, 4) of (t, x, y, pressure), metres and seconds; pressure NaN is left out.

    Splines are in device-independent pixels. shared: all strokes point to the sensor data of the first.
    """
    model = InkModel()
    provider, device, environment = InkInputProvider(input_type=InkInputType.PEN), InputDevice(), Environment()
    kinds = [(InkSensorType.X, place_metric, 1e6), (InkSensorType.Y, place_metric, 1e6)]
    kinds += [(InkSensorType.TIMESTAMP, InkSensorMetricType.TIME, 1e3), (InkSensorType.PRESSURE, pressure_metric, 1e4)]
    channels = [
        SensorChannel(
            channel_type=kind,
            metric=metric,
            resolution=resolution,
            channel_min=0.0,
            channel_max=1.0,
            ink_input_provider_id=provider.id,
            input_device_id=device.id,
        )
        for kind, metric, resolution in kinds
    ]
    sensed = SensorChannelsContext(channels=channels, ink_input_provider_id=provider.id, input_device_id=device.id)
    sensor_context = SensorContext(sensor_channels_contexts=[sensed])
    context = InputContext(environment_id=environment.id, sensor_context_id=sensor_context.id)
    inputs = model.input_configuration
    inputs.add_environment(environment)
    inputs.add_input_provider(provider)
    inputs.add_ink_device(device)
    inputs.add_sensor_context(sensor_context)
    inputs.add_input_context(context)
    root = StrokeGroupNode(uuid.UUID(int=1))
    model.ink_tree = InkTree()
    model.ink_tree.root = root
    mask = LayoutMask.X.value | LayoutMask.Y.value | LayoutMask.SIZE.value
    first = None
    for number, stroke in enumerate(strokes):
        data = SensorData(uuid.UUID(int=1000 + number), context.id, InkState.PLANE, timestamp=0)
        data.add_data(channels[0], stroke[:, 1].tolist())
        data.add_data(channels[1], stroke[:, 2].tolist())
        if not np.isnan(stroke[0, 0]):
            data.add_timestamp_data(channels[2], stroke[:, 0].tolist())
        if not np.isnan(stroke[0, 3]):
            data.add_data(channels[3], stroke[:, 3].tolist())
        if sensors:
            model.sensor_data.add(data)
        if splines:
            first = first or data.id
            points = np.pad(stroke[:, 1:3], ((1, 1), (0, 0)), mode="edge") * 96 / 25.4e-3
            spline = Spline(mask, np.column_stack([points, np.ones(len(points))]).ravel().tolist())
            seen = (first if shared else data.id) if sensors else None
            root.add(StrokeNode(Stroke(uuid.UUID(int=10**6 + number), sensor_data_id=seen, spline=spline)))
    content: bytes = UIMEncoder310().encode(model)
    return content


def will(strokes: Sequence[Floats], name: str = "sections/media/strokes.protobuf") -> bytes:
    """A WILL 2 file of strokes (m, 2 or more) with x, y in columns 0 and 1, to a hundredth of a pixel."""
    messages = b""
    for number, stroke in enumerate(strokes):
        steps = np.round(np.pad(stroke[:, :2], ((1, 1), (0, 0)), mode="edge") * 100).astype(int)
        path = Path(decimalPrecision=2, strokeWidth=[100], strokeColor=[255], id=number)
        path.data.extend(np.diff(steps, axis=0, prepend=0).ravel().tolist())
        message = path.SerializeToString()
        messages += varint(len(message)) + message
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as entries:
        entries.writestr("sections/section0.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>")
        entries.writestr(name, messages)
    return file.getvalue()


def varint(number: int) -> bytes:
    low = bytes([number & 0x7F | (0x80 if number > 0x7F else 0)])
    return low + varint(number >> 7) if number > 0x7F else low


def uim_3_0(strokes: Sequence[Floats]) -> bytes:
    """A document of version 3.0, which Wacom's library reads but no longer writes; metres, seconds and pressure."""
    document = InkObject()
    inputs = document.inputData
    names = {name: str(uuid.UUID(int=number)) for number, name in enumerate("abcdefgh", start=1)}
    inputs.inputContextData.inputContexts.add(id=names["a"], environmentID=names["b"], sensorContextID=names["c"])
    part = inputs.inputContextData.sensorContexts.add(id=names["c"]).sensorChannelsContext.add(id=names["d"])
    part.inputDeviceID = names["e"]
    metrics = {"X": LENGTH, "Y": LENGTH, "Timestamp": TIME, "Pressure": NORMALIZED}
    for number, (name, metric) in enumerate(metrics.items()):
        resolution = 1e6 if metric == LENGTH else 1e3
        part.channels.add(
            id=str(uuid.UUID(int=20 + number)),
            type=f"will://input/3.0/channel/{name}",
            metric=metric,
            resolution=resolution,
        )
    document.inkTree.add(id=names["f"], type=STROKE_GROUP)
    for number, stroke in enumerate(strokes):
        data = inputs.sensorData.add(id=str(uuid.UUID(int=100 + number)), inputContextID=names["a"])
        data.timestamp = round(stroke[0, 0] * 1e3)
        for channel, column in enumerate((1, 2, 0, 3)):
            steps = np.round(stroke[:, column] * (1e6 if column in (1, 2) else 1e3)).astype(int)
            first = 0 if column == 0 else steps[0]
            values = [first, *np.diff(steps)]
            data.dataChannels.add(sensorChannelID=str(uuid.UUID(int=20 + channel)), values=values)
        points = document.inkData.strokes.add(id=str(uuid.UUID(int=1000 + number)), sensorDataID=data.id)
        points.splineX.extend(stroke[:, 1])
        points.splineY.extend(stroke[:, 2])
        document.inkTree.add(id=points.id, type=STROKE, index=number, depth=1)
    message = document.SerializeToString()
    data_chunk = b"DATA" + len(message).to_bytes(4, "little") + message
    body = b"UINKHEAD" + (3).to_bytes(4, "little") + bytes([3, 0, 0, 0]) + data_chunk
    return b"RIFF" + len(body).to_bytes(4, "little") + body
