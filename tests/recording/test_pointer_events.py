import codecs
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.files.pointer_events import read_pointer_events

DOCUMENT = Path(__file__).parents[2] / "docs" / "pointer-events.md"


def a_point(**change: object) -> dict[str, Any]:
    return {"timeStamp": 1500.0, "x": 10.0, "y": 20, "pressure": 0.25, **change}


def recording(*strokes: object, **change: object) -> bytes:
    return json.dumps({"schema_version": 1, "size_mm": [200, 150.5], "strokes": strokes, **change}).encode()


def fault(content: bytes) -> str:
    with pytest.raises(InputError) as caught:
        read_pointer_events(content)
    return str(caught.value)


def test_points_are_read_in_seconds_and_millimetres() -> None:
    page = read_pointer_events(recording([a_point(), a_point(timeStamp=1508.5, pressure=1, tiltX=30)], [a_point(x=-1)]))
    assert page.strokes[0].tolist() == [[1.5, 10, 20, 0.25], [1.5085, 10, 20, 1]]
    assert page.strokes[1].tolist() == [[1.5, -1, 20, 0.25]]
    assert (page.unit, page.size, page.kind) == (1e-3, (200, 150.5), "pointer events")


def test_a_file_that_an_editor_began_with_a_byte_order_mark_is_read_alike() -> None:
    content = recording([a_point()])
    assert read_pointer_events(codecs.BOM_UTF8 + content).strokes[0].tolist() == [[1.5, 10, 20, 0.25]]


def test_a_pressure_of_one_half_throughout_a_stroke_was_not_recorded() -> None:
    mouse = [a_point(pressure=0.5), a_point(pressure=0.5)]
    pen = [a_point(pressure=0.5), a_point(pressure=0.75)]
    page = read_pointer_events(recording(mouse, pen))
    assert np.isnan(page.strokes[0][:, 3]).all()
    assert page.strokes[1][:, 3].tolist() == [0.5, 0.75]


def test_a_recording_without_strokes_has_none() -> None:
    assert read_pointer_events(recording()).strokes == []


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (recording(schema_version=2), "schema_version: Input should be 1 (got 2)"),
        (recording(size_mm=[200, 0]), "size_mm[1]: Input should be greater than 0 (got 0)"),
        (recording(size_mm=[200]), "size_mm[1]: Field required (got [200])"),
        (recording([]), "strokes[0] has no points; leave it out"),
        (recording([a_point(x="1")]), "strokes[0][0].x: Input should be a valid number (got '1')"),
        (
            recording([a_point(), a_point(pressure=1.5)]),
            "strokes[0][1].pressure: Input should be less than or equal to 1",
        ),
        (recording([a_point(timeStamp=None)]), "strokes[0][0].timeStamp: Input should be a valid number (got None)"),
        (recording([{"x": 1, "y": 2, "timeStamp": 3}]), "strokes[0][0].pressure: Field required (got {'x': 1, 'y': 2,"),
        (recording(pointerType="pen"), "pointerType: Extra inputs are not permitted (got 'pen')"),
        (recording([a_point(y=float("nan"))]), "strokes[0][0].y: Input should be a finite number (got nan)"),
        (b"{", "the file: Invalid JSON: EOF while parsing an object at line 1 column 1"),
        (b'{"schema_version": 1}', "size_mm: Field required"),
    ],
)
def test_a_fault_is_told_by_the_name_of_its_field(content: bytes, text: str) -> None:
    assert fault(content).startswith(text)


@pytest.mark.parametrize(
    ("points", "text"),
    [
        ([a_point(x=1430), a_point(x=900, y=160)], "x to 1430 mm"),
        ([a_point(x=210, y=1100.5)], "y to 1100 mm"),
        ([a_point(x=-300), a_point(x=-50), a_point()], "x from -300 mm"),
        ([a_point(y=-0.5)], "y from -0.5 mm"),
    ],
)
def test_strokes_of_which_most_lie_off_the_sheet_are_refused(points: list[dict[str, Any]], text: str) -> None:
    assert fault(recording(points, size_mm=[200, 150])) == (
        f"its strokes lie off the sheet of 200 x 150 mm ({text}); x and y must be millimetres"
    )


def test_strokes_may_run_off_the_sheet_by_half() -> None:
    edge = [a_point(x=200, y=150.5), a_point(x=0, y=0)]
    page = read_pointer_events(recording([*edge, a_point(x=1430), a_point(y=-5)]))
    assert page.strokes[0][:, 1].tolist() == [200, 0, 1430, 10]


def test_the_example_of_the_documentation_is_a_recording() -> None:
    (example,) = re.findall(r"```json\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), flags=re.DOTALL)
    page = read_pointer_events(example.encode())
    assert [len(stroke) for stroke in page.strokes] == [2, 1]
    assert page.strokes[0][1].tolist() == pytest.approx([1.5074, 21.9, 40.5, 0.36])
    assert np.isnan(page.strokes[1][0, 3])


def test_the_page_of_the_documentation_writes_all_that_is_required() -> None:
    (page,) = re.findall(r"```html\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert "JSON.stringify({ schema_version: 1, size_mm: mm, strokes })" in page
    assert "push({ timeStamp, x, y, pressure })" in page
