"""Picture under or beside the sheet on the panel Draw, in a browser; nothing of it is recorded."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from maulstick.studio.state.reference import Reference
from tests.studio.conftest import RunningStudio
from tests.studio.test_everybody import OVERLAPS, SIZES, faults_by_axe
from tests.studio.test_plan_page import picture_to_bring

ALPHA = """() => {
  const sheet = document.querySelector(".pen canvas");
  return sheet.getContext("2d").getImageData(sheet.width / 2, sheet.height - 10, 1, 1).data[3];
}"""


def test_pages_are_told_of_a_look_that_changed_alone() -> None:
    reference, told = Reference(), list[float]()
    reference.changed.subscribe(lambda: told.append(reference.look.strength))
    for strength in (0.4, 0.5, 7.0, 1.0, -1.0):
        reference.fade(strength)
    reference.place(under=True)
    assert told == [0.5, 1, 0]


def test_a_picture_lies_under_the_sheet_and_beside_it_on_all_pages_and_is_not_drawn(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    mine, theirs = page("/"), page("/", color_scheme="dark")
    mine.get_by_role("button", name="Picture").click()
    with mine.expect_file_chooser() as chooser:
        mine.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(picture_to_bring(tmp_path))
    for each in (mine, theirs):
        shown = each.get_by_alt_text("My Sunset!, to look at")
        expect(shown).to_be_visible()
        expect(shown).to_have_css("opacity", "0.4")
    mine.get_by_label("How strong").press("ArrowRight")
    expect(theirs.get_by_alt_text("My Sunset!, to look at")).to_have_css("opacity", "0.45")
    theirs.get_by_role("button", name="Picture").click()
    expect(theirs.get_by_label("How strong")).to_have_js_property("value", "0.45")
    theirs.keyboard.press("Escape")
    assert faults_by_axe(mine) == {}
    mine.keyboard.press("Escape")
    expect(mine.get_by_role("dialog")).to_have_count(0)

    sheet = mine.locator(".pen canvas").bounding_box()
    picture = mine.locator(".reference").bounding_box()
    assert sheet is not None
    assert picture == pytest.approx(sheet, abs=1), "it lies where the sheet does"
    x, y = sheet["x"] + sheet["width"] / 4, sheet["y"] + sheet["height"] / 4
    mine.mouse.move(x, y)
    mine.mouse.down()
    mine.mouse.move(2 * x, y, steps=5)
    mine.mouse.up()
    expect(theirs.locator(".count")).to_contain_text("1 stroke")
    assert mine.evaluate(ALPHA) == 0, "the sheet itself is bare there"

    mine.get_by_role("button", name="Picture").click()
    mine.get_by_role("radio", name="Beside it").click()
    expect(theirs.get_by_alt_text("My Sunset!, to look at")).to_have_css("opacity", "1")
    for width, height in SIZES:
        theirs.set_viewport_size({"width": width, "height": height})
        assert theirs.evaluate(OVERLAPS) == []
    mine.reload()
    expect(mine.get_by_alt_text("My Sunset!, to look at")).to_be_visible()
    mine.get_by_role("button", name="Picture").click()
    mine.get_by_label("Picture", exact=True).and_(mine.get_by_role("combobox")).click()
    mine.get_by_role("option", name="No picture").click()
    expect(theirs.get_by_alt_text("My Sunset!, to look at")).to_be_hidden()
    drawn = json.loads((studio.folder / "hands" / "my-hand" / "drawing.json").read_bytes())
    assert sorted(drawn) == ["schema_version", "size_mm", "strokes"]
    assert len(drawn["strokes"]) == 1
