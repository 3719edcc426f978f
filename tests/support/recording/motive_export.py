"""A writer of Motive's CSV exports, as Motive 2 (format 1.23 and before) and Motive 3 (1.24 and later) lay them out."""

import numpy as np
from scipy.spatial.transform import Rotation

from maulstick.recording.mocap.take import Take
from maulstick.storage.arrays import Floats

_UNITS = {"m": ("Meters", 1.0), "cm": ("Centimeters", 1e2), "mm": ("Millimeters", 1e3)}

Column = tuple[str, str, str, str, Floats]  # type, name, rotation or position, axis, values


def motive_csv(
    take: Take,
    *,
    version: str = "1.23",
    rotation: str = "Quaternion",
    unit: str = "m",
    delimiter: str = ",",
    pen_name: str = "Pen",
    canvas_name: str | None = "Canvas",
    measured: bool = True,
) -> bytes:
    """What Motive would export of the take.

    version: 1.24 and later have a row of parents and call markers "Pen:Marker 001" rather than "Pen:Marker1".
    rotation: Quaternion, or the order of Euler angles, as XYZ.  unit: m, cm or mm.
    delimiter: with a semicolon goes the decimal comma.
    canvas_name: the canvas's rigid body; None where its three markers are loose.
    measured: whether the columns of measured markers are there, beside those of the rigid bodies; if they are, the
    latter are 1 mm beside the truth, so that it can be told which were read.
    """
    modern = tuple(map(int, version.split("."))) >= (1, 24)
    units, scale = _UNITS[unit]
    beside = 1e-3 if measured else 0.0
    bodies, solved, loose = [], [], []
    for body, positions, rotations, markers in (
        (pen_name, take.pen_positions, take.pen_rotations, take.pen_markers),
        (
            canvas_name,
            take.canvas_markers.mean(axis=1),
            np.tile([0.0, 0.0, 0.0, 1.0], (len(take), 1)),
            take.canvas_markers,
        ),
    ):
        if body is not None:
            bodies += _rotation(body, rotations, rotation) + _position("Rigid Body", body, positions * scale)
            bodies.append(("Rigid Body", body, "Mean Marker Error", "", np.full(len(take), 1e-4 * scale)))
        for number in range(markers.shape[1]):
            if body is None:
                loose += _position("Marker", f"Unlabeled {1000 + number}", markers[:, number] * scale)
                continue
            name = f"{body}:Marker {number + 1:03}" if modern else f"{body}:Marker{number + 1}"
            solved += _position("Rigid Body Marker", name, (markers[:, number] + beside) * scale)
            solved.append(("Rigid Body Marker", name, "Marker Quality", "", np.ones(len(take))))
            if measured:
                loose += _position("Marker", name, markers[:, number] * scale)
    columns: list[Column] = bodies + solved + loose
    facts = {
        "Format Version": version,
        "Take Name": "Take 2026-03-01 02.00.00 PM",
        "Take Notes": "",
        "Capture Frame Rate": "240.000000",
        "Export Frame Rate": "240.000000",
        "Capture Start Time": "2026-03-01 02.00.00.000 PM",
        "Capture Start Frame": "0",
        "Total Frames in Take": str(len(take)),
        "Total Exported Frames": str(len(take)),
        "Rotation Type": rotation,
        "Length Units": units,
        "Coordinate Space": "Global",
    }
    rows = [
        [cell for fact in facts.items() for cell in fact],
        [],
        ["", "Type", *(column[0] for column in columns)],
        ["", "Name", *(column[1] for column in columns)],
        ["", "ID", *(f'"{sum(column[1].encode()):032X}"' for column in columns)],
        *(
            [["", "Parent", *(column[1].partition(":")[0] * (":" in column[1]) for column in columns)]]
            if modern
            else []
        ),
        ["", "", *(column[2] for column in columns)],
        ["Frame", "Time (Seconds)", *(column[3] for column in columns)],
    ]
    values = np.stack([column[4] for column in columns], axis=1)
    for frame, (time, cells) in enumerate(zip(take.times.tolist(), values.tolist(), strict=True)):
        numbers = ["" if cell != cell else f"{cell:.6f}" for cell in (time, *cells)]
        if delimiter == ";":
            numbers = [number.replace(".", ",") for number in numbers]
        rows.append([str(frame), *numbers])
    return "".join(delimiter.join(row) + "\r\n" for row in rows).encode()


def _position(kind: str, name: str, values: Floats) -> list[Column]:
    return [(kind, name, "Position", axis, values[:, place]) for place, axis in enumerate("XYZ")]


def _rotation(name: str, quaternions: Floats, rotation: str) -> list[Column]:
    if rotation == "Quaternion":
        return [("Rigid Body", name, "Rotation", axis, quaternions[:, place]) for place, axis in enumerate("XYZW")]
    seen = np.isfinite(quaternions).all(axis=1)
    angles = np.full((len(quaternions), 3), np.nan)
    angles[seen] = Rotation.from_quat(quaternions[seen]).as_euler(rotation, degrees=True)
    return [("Rigid Body", name, "Rotation", axis, angles[:, rotation.index(axis)]) for axis in "XYZ"]
