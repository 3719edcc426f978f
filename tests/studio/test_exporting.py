"""Files of a plan that people take elsewhere, without the page and on it."""

import io
import zipfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image, ImageSequence
from playwright.sync_api import Page, expect

from maulstick.errors import InputError
from maulstick.jobs.export import ExportOptions
from maulstick.painting import video
from maulstick.robot.easel import Pen
from maulstick.studio.workers.export_work import export_film, export_for_machine, export_picture
from tests.studio.conftest import RunningStudio
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import LINES, put_plan

_ENCODED = 0.01  # share of the pixels that a codec may lighten


def test_one_file_comes_as_it_is_and_several_in_an_archive_that_says_which_pen_is_which(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "six", SIX)
    taken = export_for_machine(painting, "six", ExportOptions(format="gcode", servo=Pen(up=30, down=90)))
    assert (taken.name, b"M3 S90" in taken.content) == ("six.gcode", True)
    taken = export_for_machine(painting, "six", ExportOptions(format="svg", per_pen=True))
    assert taken.name == "six-svg.zip"
    with zipfile.ZipFile(io.BytesIO(taken.content)) as archive:
        assert archive.namelist() == ["six-1.svg", "six-2.svg", "pens.txt"]
        assert archive.read("six-1.svg").startswith(b"<")
        assert archive.read("pens.txt").decode().splitlines()[0].startswith("six-1.svg: ")


def test_a_picture_has_the_height_asked_for_and_a_print_its_true_size(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")
    with Image.open(io.BytesIO(export_picture(painting, "lines", 400).content)) as picture:
        assert picture.height == 400
        assert np.asarray(picture).min() < 128, "strokes are on it"
    pdf = export_picture(painting, "lines", None).content
    assert pdf.startswith(b"%PDF")
    width, height = LINES.sheet.width / 0.0254 * 72, LINES.sheet.height / 0.0254 * 72
    box = [float(side) for side in pdf.split(b"/MediaBox [")[1].split(b"]")[0].split()]
    assert box == pytest.approx([0, 0, width, height], abs=0.5)
    with pytest.raises(InputError):
        export_picture(painting, "lines", 10**6)


@pytest.mark.parametrize("kind", ["gif", "mp4"])
def test_a_film_begins_with_the_bare_sheet_and_ends_with_all_strokes(tmp_path: Path, kind: str) -> None:
    taken = export_film(put_plan(tmp_path, "lines"), "lines", kind, 1)
    assert taken.name == f"lines.{kind}"
    inked = [float((frame < 128).mean()) for frame in frames_of(taken.content, kind)]
    assert inked[0] == 0
    assert inked[-1] > 0
    assert all(after >= before - _ENCODED for before, after in pairwise(inked)), "strokes come, and stay"
    assert len({round(share, 2) for share in inked}) > 3


def frames_of(content: bytes, kind: str) -> list[NDArray[np.uint8]]:
    if kind == "gif":
        with Image.open(io.BytesIO(content)) as film:
            return [np.asarray(frame.convert("RGB")) for frame in ImageSequence.Iterator(film)]
    with pytest.importorskip("av").open(io.BytesIO(content)) as film:
        return [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]


def test_a_film_that_cannot_be_written_here_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    painting = put_plan(tmp_path, "lines")
    monkeypatch.setattr(video, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"^an mp4 video needs the package av: ask for a gif, or add"):
        export_film(painting, "lines", "mp4", 1)


def test_a_plan_is_saved_for_another_machine_on_the_page(studio: RunningStudio, page: Callable[..., Page]) -> None:
    put_plan(studio.folder, "lines")
    studio.kill()
    studio.start()  # it finds all plans when it starts
    tab = page("/plan")
    tab.get_by_role("button", name="Files").click()
    tab.get_by_text("Save as …").click()
    tab.get_by_label("What for").click()
    tab.get_by_role("option", name="G-code for Grbl").click()
    tab.get_by_role("checkbox", name="A servo lifts the pen").click()
    down = tab.get_by_label("and for down")
    down.fill("30")
    tab.get_by_role("button", name="Save", exact=True).click()
    expect(tab.get_by_text("The servo's numbers for up and down are the same")).to_be_visible()
    down.fill("90")
    with tab.expect_download() as caught:
        tab.get_by_role("button", name="Save", exact=True).click()
    assert caught.value.suggested_filename == "lines.gcode"
    assert "M3 S90" in caught.value.path().read_text()
    expect(tab.get_by_role("dialog")).to_have_count(0)

    tab.get_by_role("button", name="Files").click()
    tab.get_by_text("Save as …").click()
    tab.get_by_label("What for").click()
    tab.get_by_role("option", name="GIF").click()
    tab.get_by_label("Seconds").fill("60")
    tab.get_by_role("button", name="Save", exact=True).click()
    expect(tab.get_by_text("The seconds of a film is 60; it must be a whole number from 1 to 20")).to_be_visible()
    tab.get_by_label("Seconds").fill("1")
    with tab.expect_download() as caught:
        tab.get_by_role("button", name="Save", exact=True).click()
    assert caught.value.path().read_bytes().startswith(b"GIF89a")
