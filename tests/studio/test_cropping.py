"""Frame around what is kept of a picture, in the form of a plan: its geometry, and its handles in a browser."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from playwright.sync_api import Page, expect

from maulstick.painting.edit import Crop, PictureEdit
from maulstick.studio.panels.plan.cropping import crop_of, shaped
from tests.studio.conftest import RunningStudio
from tests.studio.test_everybody import faults_by_axe
from tests.studio.test_sheet_page import bring

EDGES = ("Left", "Upper", "Right", "Lower")
ROUNDED = 2e-4  # shares of a side: two roundings to four places
_PIXEL = 6e-3  # shares of a side that a pixel of the page is, and its rounding


@given(
    st.lists(st.floats(0, 1), min_size=2, max_size=2, unique=True),
    st.lists(st.floats(0, 1), min_size=2, max_size=2, unique=True),
    st.floats(0.2, 5),
)
def test_a_frame_of_the_sheets_shape_is_the_largest_inside_the_one_that_was_drawn(
    across: list[float], down: list[float], ratio: float
) -> None:
    (left, right), (top, bottom) = sorted(across), sorted(down)
    kept = shaped((left, top, right, bottom), ratio)
    wide, high = kept[2] - kept[0], kept[3] - kept[1]
    assert wide == pytest.approx(high * ratio, abs=ROUNDED * (1 + ratio))
    assert min(kept[0] - left, kept[1] - top, right - kept[2], bottom - kept[3]) > -ROUNDED
    assert min(right - left - wide, bottom - top - high) < ROUNDED
    assert kept[0] + kept[2] == pytest.approx(left + right, abs=ROUNDED)


@pytest.mark.parametrize(
    "sent", [None, "0,0,1,1", [0, 0, 1], [0, 0, 1, "1"], [0, 0, float("nan"), 1], [0.5, 0, 0.5, 1], [0, -0.1, 1, 1]]
)
def test_what_is_no_crop_is_not_taken_from_a_browser(sent: object) -> None:
    assert crop_of(sent) is None
    assert PictureEdit(crop=crop_of([0, 0.25, 1, 1]) or (0, 0, 1, 1)).crop == (0, 0.25, 1, 1)


def test_a_picture_is_cut_by_a_mouse_a_finger_and_keys_and_in_the_shape_of_the_sheet(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan", has_touch=True)
    Image.new("RGB", (400, 300), (90, 60, 30)).save(tmp_path / "lying.png")
    bring(tab, tmp_path / "lying.png")
    tab.get_by_text("Correct the picture").click()
    picture = tab.get_by_alt_text("The picture as it is corrected")
    expect(picture).to_be_visible()
    tab.wait_for_function("picture => picture.complete && picture.naturalWidth", arg=picture.element_handle())
    told = tab.locator(".sketch .hint")
    expect(told).to_contain_text("6% of the picture is cut off")
    tab.get_by_label("Upper left corner").hover()  # once it rests: the part of the page unfolds
    box = picture.bounding_box()
    assert box is not None

    def middle(name: str) -> tuple[float, float]:
        at = tab.get_by_label(name).bounding_box()
        assert at is not None
        assert min(at["width"], at["height"]) >= 24, "a finger finds it"
        return at["x"] + at["width"] / 2, at["y"] + at["height"] / 2

    def expect_kept(*edges: float) -> None:
        for name, edge, side in zip(EDGES, edges, ("left", "top") * 2, strict=True):
            near = "(each, [side, wanted]) => Math.abs(parseFloat(each.style[side]) - wanted) < 0.6"
            element = tab.get_by_label(f"{name} edge").element_handle()
            tab.wait_for_function(f"([each, ...more]) => ({near})(each, more)", arg=[element, side, 100 * edge])

    def kept() -> Crop:
        edges = [
            tab.get_by_label(f"{edge} edge").evaluate("each => [each.style.left, each.style.top]") for edge in EDGES
        ]
        left, top, right, bottom = (float(at[i % 2].removesuffix("%")) / 100 for i, at in enumerate(edges))
        return left, top, right, bottom

    x, y = middle("Upper left corner")
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x + box["width"] / 4, y + box["height"] / 5, steps=5)
    tab.mouse.up()
    expect_kept(0.25, 0.2, 1, 1)
    expect(told).to_have_text("A sheet of 200 by 160 mm.")  # a shorter text, so that all below it has moved
    tab.get_by_label("Right edge").hover()
    x, y = middle("Right edge")
    finger = tab.context.new_cdp_session(tab)
    for kind, there in (("touchStart", x), ("touchMove", x - box["width"] / 10), ("touchEnd", None)):
        points = [] if there is None else [{"x": there, "y": y}]
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    expect_kept(0.25, 0.2, 0.9, 1)
    tab.get_by_label("What is kept").focus()
    tab.keyboard.press("ArrowLeft")
    tab.keyboard.press("Shift+ArrowUp")
    expect_kept(0.24, 0.199, 0.89, 0.999)

    assert faults_by_axe(tab) == {}

    tab.get_by_role("checkbox", name="Keep the sheet's shape").click()
    expect(told).to_have_text("A sheet of 200 by 160 mm.")  # and nothing is cut off, nor bare
    x, y = middle("Lower right corner")
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x - box["width"] / 6, y, steps=5)
    tab.mouse.move(x + 2 * box["width"], y, steps=5)  # as far as the picture goes, in this shape
    tab.mouse.up()
    left, top, right, bottom = kept()
    assert (right - left) * 400 / (bottom - top) / 300 == pytest.approx(200 / 160, rel=0.01)
    assert max(right, bottom) == pytest.approx(1, abs=_PIXEL)
    tab.get_by_label("How carefully").click()
    tab.get_by_role("option", name="A sketch, quickly").click()
    expect(told).to_have_text("A sheet of 200 by 160 mm.")
    tab.get_by_role("button", name="Plan it").click()
    expect(tab.get_by_role("article", name="Plan lying")).to_be_visible()
    options = json.loads((studio.folder / "plans" / "lying" / "request.json").read_bytes())["options"]
    assert options["crop"] == pytest.approx([left, top, right, bottom], abs=_PIXEL)
