import logging
import re
import sys
import warnings
import zipfile
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError, how_to_add
from maulstick.recording.files.page import Page
from maulstick.recording.files.wacom import read_uim, read_will
from maulstick.storage.arrays import Floats
from tests.support.recording.wacom_files import InkSensorMetricType, uim, uim_3_0, varint, will
from tests.support.tolerances import WACOM_FILE_METRES

WACOM = Path(__file__).parents[3] / "shared" / "data" / "uil_strokes.npz"
PIXEL = 25.4e-3 / 96


def a_stroke(samples: int = 9, start: float = 1.6e9, pressure: float = 0.5) -> Floats:
    """A quarter of a circle of 20 mm, drawn in a second."""
    share = np.linspace(0, 1, samples)
    x, y = 0.03 + 0.02 * np.cos(share * np.pi / 2), 0.03 + 0.02 * np.sin(share * np.pi / 2)
    return np.column_stack([start + share, x, y, pressure * share])


def assert_same(page: Page, strokes: list[Floats], pressure: float = 1e-4) -> None:
    assert page.unit == 1
    assert len(page.strokes) == len(strokes)
    for came, drawn in zip(page.strokes, strokes, strict=True):
        assert came[:, 1:3] == pytest.approx(drawn[:, 1:3], abs=WACOM_FILE_METRES)
        assert came[:, 0] == pytest.approx(drawn[:, 0], abs=1e-3, nan_ok=True)
        assert came[:, 3] == pytest.approx(drawn[:, 3], abs=pressure, nan_ok=True)


def test_what_the_sensors_saw_is_read_in_metres_and_seconds() -> None:
    strokes = [a_stroke(), a_stroke(17, 1.6e9 + 60.25) + np.array([0, 0.01, 0, 0]), a_stroke(1, 1.6e9 + 90)]
    page = read_uim(uim(strokes))
    assert_same(page, strokes)
    assert (page.kind, page.size) == ("UIM", None)


def test_version_3_0_is_read_alike() -> None:
    strokes = [a_stroke(), a_stroke(17, 1.6e9 + 60.25)]
    page = read_uim(uim_3_0(strokes))
    assert_same(page, strokes, pressure=1e-3)


def test_sensor_data_without_strokes_are_strokes() -> None:
    assert_same(read_uim(uim([a_stroke(), a_stroke()], splines=False)), [a_stroke(), a_stroke()])


@pytest.mark.parametrize("column", [0, 3])
def test_what_the_sensors_did_not_see_is_unknown(column: int) -> None:
    stroke = a_stroke()
    stroke[:, column] = np.nan
    assert_same(read_uim(uim([stroke, a_stroke()])), [stroke, a_stroke()])


def test_a_pressure_in_other_steps_is_divided_by_its_largest() -> None:
    page = read_uim(uim([a_stroke(pressure=800.0)], pressure_metric=InkSensorMetricType.FORCE))
    assert page.strokes[0][:, 3] == pytest.approx(np.linspace(0, 1, 9), abs=1e-4)


def test_of_two_strokes_pressed_beyond_1_the_lighter_one_stays_the_lighter() -> None:
    strokes = [a_stroke(pressure=most) for most in (800.0, 400.0, 0.8)]
    page = read_uim(uim(strokes, pressure_metric=InkSensorMetricType.FORCE))
    assert [stroke[-1, 3] for stroke in page.strokes] == pytest.approx([1, 0.5, 0.001], abs=1e-4)


def test_without_sensors_the_splines_are_sampled_in_an_unknown_unit() -> None:
    (came,) = read_uim(uim([a_stroke()], sensors=False)).strokes
    page = read_uim(uim([a_stroke()], sensors=False))
    assert (page.unit, page.size) == (None, None)
    assert np.isnan(came[:, [0, 3]]).all()
    places = came[:, 1:3] * PIXEL
    assert places[[0, -1]] == pytest.approx(a_stroke()[[0, -1], 1:3], abs=WACOM_FILE_METRES)
    assert np.hypot(*(places - 0.03).T) == pytest.approx(0.02, abs=6e-5), "the spline is that near to the circle"
    assert len(came) > 9


@pytest.mark.parametrize("options", [{"shared": True}, {"place_metric": InkSensorMetricType.NORMALIZED}])
def test_sensor_data_of_no_use_are_passed_over_for_the_splines(options: dict[str, object]) -> None:
    page = read_uim(uim([a_stroke(), a_stroke() + np.array([0, 0.05, 0, 0])], **options))  # type: ignore[arg-type]
    assert page.unit is None
    assert [np.round(stroke[0, 1] * PIXEL, 6) for stroke in page.strokes] == [0.05, 0.1]


def test_a_document_without_ink_has_no_strokes() -> None:
    assert read_uim(uim([])).strokes == []


def test_will_is_read_to_a_hundredth_of_a_pixel() -> None:
    corners = [np.array([[10, 20], [110.25, 20], [110.25, 90.5]]), np.array([[5.0, 5.0]]), np.array([[0, 0], [1, -3]])]
    page = read_will(will(corners))
    assert (page.kind, page.unit, page.size) == ("WILL", None, None)
    for came, drawn in zip(page.strokes, corners, strict=True):
        assert np.isnan(came[:, [0, 3]]).all()
        assert came[[0, -1], 1:3] == pytest.approx(drawn[[0, -1]], abs=1e-9)
        assert np.linalg.norm(came[:, None, 1:3] - drawn, axis=2).min(axis=0) == pytest.approx(0, abs=1e-9)


def test_a_will_file_cut_short_is_refused() -> None:
    for tail in (b"\xff", varint(9) + b"\0" * 8, b"\xff" * 9):
        file = BytesIO()
        with zipfile.ZipFile(file, "w") as entries:
            entries.writestr("sections/media/strokes.protobuf", tail)
        with pytest.raises(InputError, match="its strokes are cut short or damaged; copy it again"):
            read_will(file.getvalue())


def test_a_will_file_with_a_bomb_in_it_is_not_unpacked() -> None:
    file = BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as entries:
        entries.writestr("sections/media/strokes.protobuf", bytes(65 * 2**20))
    with pytest.raises(InputError, match="its strokes unpack to over 64 MiB; no drawing is that large"):
        read_will(file.getvalue())


def test_a_zip_without_strokes_is_refused() -> None:
    with pytest.raises(InputError, match="there are no strokes in it: a WILL 2 file keeps them in"):
        read_will(will([], name="sections/media/other.protobuf"))


def test_without_wacoms_library_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    for content, reader in ((uim([a_stroke()]), read_uim), (will([]), read_will)):
        for name in [name for name in sys.modules if name.split(".")[0] == "uim"]:
            monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(InputError, match=re.escape(f"reading it needs Wacom's library; {how_to_add('wacom')}")):
            reader(content)
        monkeypatch.undo()


def test_reading_leaves_warnings_and_logging_as_they_were(capfd: pytest.CaptureFixture[str]) -> None:
    disabled, filters = logging.root.manager.disable, list(warnings.filters)
    read_uim(uim([a_stroke()]))
    with pytest.raises(Exception, match=r".+"):
        read_uim(uim([a_stroke()])[:300])
    assert (logging.root.manager.disable, list(warnings.filters)) == (disabled, filters)
    assert capfd.readouterr() == ("", "")


@pytest.mark.skipif(not WACOM.exists(), reason="shared data absent: uil_strokes.npz")
@pytest.mark.parametrize("source", ["special/ink.uim", "schemas/math-structures.uim"])
def test_real_pen_strokes_come_back_out_of_a_document(source: str) -> None:
    with np.load(WACOM, allow_pickle=False) as data:
        strokes = np.split(data["data"][:, [2, 0, 1, 3]], np.cumsum(data["lens"])[:-1])
        drawn = [stroke for stroke, name in zip(strokes, data["source"], strict=True) if name == source]
    assert_same(read_uim(uim(drawn)), drawn)
