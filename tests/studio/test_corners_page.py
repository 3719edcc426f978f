"""Corners of the sheet that a person shows a camera on the panel Paint."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from maulstick.calibration.camera import read_view
from maulstick.jobs.paint.options import PaintOptions
from maulstick.studio.panels.paint.corners import corners_of, with_view
from tests.studio.conftest import RunningStudio
from tests.studio.test_everybody import faults_of_dialog
from tests.support.studio import usb_camera
from tests.support.studio.plans_to_paint import put_plan_of_a_picture
from tests.support.studio.usb_camera.sheet_seen import CORNERS, SIZE

_NAMES = ("Upper left", "Upper right", "Lower right", "Lower left")
_DRAGGED = 1e-3  # metres on a sheet of 60 by 40 mm: two pixels of the page


@pytest.fixture
def studio(tmp_path: Path) -> Iterator[RunningStudio]:
    running = RunningStudio(tmp_path, environment={"PYTHONPATH": usb_camera.__path__[0]})
    try:
        yield running
    finally:
        running.close()
    assert "Traceback" not in running.output, running.output


@pytest.mark.parametrize("sent", [None, [[0, 0]] * 3, [[0, 0, 0]] * 4, [[0, 2]] * 4, [[0, "0"]] * 4, [0, 0, 0, 0]])
def test_what_are_no_corners_is_not_taken_from_a_browser(sent: object) -> None:
    assert corners_of(sent) is None
    assert corners_of([[0, 0], [1, 0], [1, 1], [0, 1.0]]) == ((0, 0), (1, 0), (1, 1), (0, 1))


def test_a_run_uses_the_corners_that_are_there_and_else_what_it_had(tmp_path: Path) -> None:
    options, path = PaintOptions(camera="usb:0"), tmp_path / "view.json"
    assert with_view(options, path, None) == options
    assert "view" not in with_view(options, path, PaintOptions(view=Path("/theirs.json"))).model_fields_set
    gone = with_view(options, path, PaintOptions(view=path))
    assert (gone.view, "view" in gone.model_fields_set) == (None, True)
    path.touch()
    assert with_view(options, path, PaintOptions(view=Path("/theirs.json"))).view == path


def test_corners_are_dragged_onto_the_sheet_kept_shown_again_and_given_up(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan_of_a_picture(studio.folder, "coast")
    studio.kill()
    studio.start()  # it finds all plans when it starts
    tab = page("/paint?plan=coast")
    tab.get_by_label("Machine", exact=True).click()
    tab.get_by_role("option", name="Grbl").click()
    tab.get_by_role("button", name="Expand").first.click()
    expect(tab.get_by_role("button", name="Show it the corners")).to_have_count(0)
    tab.get_by_role("combobox", name="Camera").click()
    tab.get_by_role("option", name="Second USB camera").click()
    tab.get_by_role("button", name="Show it the corners").click()
    expect(tab.get_by_text("there is no camera usb:1")).to_be_visible()
    tab.get_by_role("combobox", name="Camera").click()
    tab.get_by_role("option", name="First USB camera").click()
    expect(tab.get_by_text("The camera finds the sheet by the tags beside it.")).to_be_visible()

    tab.get_by_role("button", name="Show it the corners").click()
    photograph = tab.get_by_alt_text("What the camera sees")
    expect(photograph).to_be_visible()
    tab.wait_for_function("document.querySelector('.corners img').naturalWidth > 0")
    tab.wait_for_function("document.getAnimations().length === 0")  # the dialog grows as it opens
    box = photograph.bounding_box()
    assert box is not None
    for name, (x, y) in zip(_NAMES, CORNERS, strict=True):
        handle = tab.get_by_role("button", name=f"{name} corner of the sheet")
        at = handle.bounding_box()
        assert at is not None
        assert min(at["width"], at["height"]) >= 24
        tab.mouse.move(at["x"] + at["width"] / 2, at["y"] + at["height"] / 2)
        tab.mouse.down()
        tab.mouse.move(box["x"] + x / SIZE[0] * box["width"], box["y"] + y / SIZE[1] * box["height"], steps=3)
        tab.mouse.up()
    expect(tab.locator(".magnifier")).to_be_visible()
    before = handle.evaluate("each => parseFloat(each.style.left)")
    handle.press("ArrowRight")
    handle.press("Shift+ArrowLeft")
    assert handle.evaluate("each => parseFloat(each.style.left)") == pytest.approx(before + 0.2 - 0.02)
    handle.press("ArrowLeft")
    assert faults_of_dialog(tab) == {}
    tab.get_by_role("button", name="Keep these corners").click()
    expect(tab.get_by_text("The camera finds the sheet by the corners that you showed it.")).to_be_visible()
    (file,) = (studio.folder / "cameras").iterdir()
    view = read_view(file)
    assert view.size == SIZE
    wanted = np.array([[0, 0], [0.06, 0], [0.06, 0.04], [0, 0.04]])
    assert view.to_canvas(np.array(CORNERS, dtype=float)) == pytest.approx(wanted, abs=_DRAGGED)

    tab.get_by_role("button", name="Show it the corners").click()
    expect(handle).to_be_visible()
    assert handle.evaluate("each => parseFloat(each.style.left)") == pytest.approx(before - 0.02, abs=0.1)
    tab.keyboard.press("Escape")
    tab.get_by_role("button", name="Use the tags").click()
    expect(tab.get_by_text("The camera finds the sheet by the tags beside it.")).to_be_visible()
    assert not file.exists()
