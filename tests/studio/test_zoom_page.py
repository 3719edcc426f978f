"""Closer look at a plan in a browser: two pictures are zoomed and moved together, by all that a person has."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from maulstick.painting.brush import load_brush
from maulstick.painting.svg import painting_svg
from maulstick.studio.workers.plan_pictures import LARGE, keep_large_picture
from tests.studio.conftest import RunningStudio
from tests.studio.test_everybody import faults_of_dialog
from tests.support.studio.plans_to_paint import LINES, put_plan

MILLIMETRE = 96 / 25.4  # CSS pixels
_WIDE = 60.0  # mm, of the sheet of these plans
LARGE_PX = 3072
_ROUNDED = 1e-3  # share of a length: browsers lay out by 64ths of a pixel
PLACES = """() => [...document.querySelectorAll(".zoomed img")].map((each) => {
  const [box, view] = [each, each.closest(".zoomed")].map((one) => one.getBoundingClientRect());
  return [box.left - view.left, box.top - view.top, box.width];
})"""


def put_plan_with_lines(root: Path, name: str) -> None:
    painting = put_plan(root, name, LINES)
    painting.with_name("painting.svg").write_text(painting_svg(LINES))


def test_two_plans_are_zoomed_and_moved_together_and_lines_stay_sharp(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan_with_lines(studio.folder, "lines")
    put_plan_with_lines(studio.folder, "other")
    studio.kill()
    studio.start()  # it finds all plans when it starts
    tab = page("/plan", has_touch=True)
    card = tab.get_by_role("article", name="Plan other")
    card.get_by_label("Compared with").click()
    tab.get_by_role("option", name="lines").click()
    card.get_by_role("button", name="Look closer").click()
    view = tab.get_by_role("group", name="other, which arrow keys move")
    expect(view).to_be_visible()
    expect(view.get_by_alt_text("The strokes of other")).to_have_attribute(
        "src", re.compile("^/picture/plans/other/large.png")
    )
    tab.get_by_role("checkbox", name="As sharp lines").click()
    for name in ("other", "lines"):
        expect(tab.locator(f".zoomed img[src^='/file/plans/{name}/painting.svg']")).to_have_count(1)
    tab.wait_for_function("[...document.querySelectorAll('.zoomed img')].every((each) => each.naturalWidth > 0)")

    def place() -> tuple[float, float, float]:
        first, second = tab.evaluate(PLACES)
        assert first == pytest.approx(second), "both move together"
        x, y, wide = first
        return x, y, wide / MILLIMETRE / _WIDE

    whole = place()
    tab.get_by_role("button", name="True size").click()
    assert place()[2] == pytest.approx(1, rel=_ROUNDED)
    tab.get_by_role("button", name="All of it").click()
    assert place() == pytest.approx(whole, rel=_ROUNDED)
    tab.get_by_role("button", name="Nearer").click()
    tab.get_by_role("button", name="Farther").click()
    assert place() == pytest.approx(whole, rel=_ROUNDED)

    box = view.bounding_box()
    assert box is not None
    middle = box["width"] / 2, box["height"] / 2
    x, y = box["x"] + middle[0], box["y"] + middle[1]
    pinch(view, x, y, 40, 160)
    fingers = place()
    assert fingers[2] == pytest.approx(4 * whole[2], rel=0.05)
    under = [(middle[i] - fingers[i]) / fingers[2] for i in (0, 1)]
    assert under == pytest.approx([(middle[i] - whole[i]) / whole[2] for i in (0, 1)], abs=5), "it grows between them"
    tab.mouse.move(x, y)
    tab.mouse.wheel(0, -500)
    tab.wait_for_function(f"({PLACES})()[0][2] > {1.5 * fingers[2] * _WIDE * MILLIMETRE}")
    near = place()
    tab.mouse.down()
    tab.mouse.move(x + 30, y - 20, steps=3)
    tab.mouse.up()
    assert place() == pytest.approx((near[0] + 30, near[1] - 20, near[2]), abs=1)
    view.focus()
    for key in ("ArrowRight", "ArrowDown", "+", "-", "1"):
        view.press(key)
    assert place()[2] == pytest.approx(1, rel=_ROUNDED)
    view.press("0")
    assert place() == pytest.approx(whole, rel=_ROUNDED)
    tab.get_by_label("This or lines").fill("30")
    assert view.locator(".over").evaluate("each => each.style.clipPath") == "inset(0px 0px 0px 30%)"
    assert faults_of_dialog(tab) == {}
    tab.keyboard.press("Escape")
    expect(view).to_have_count(0)


def test_a_larger_picture_is_made_once_and_anew_for_a_plan_that_was_planned_again(tmp_path: Path) -> None:
    folder = put_plan(tmp_path, "lines", LINES).parent
    assert keep_large_picture(folder)
    with Image.open(folder / LARGE) as picture:
        assert picture.width == LARGE_PX
        assert np.asarray(picture).min() < 128, "strokes are on it"
    made = (folder / LARGE).stat().st_mtime_ns
    assert keep_large_picture(folder)
    assert (folder / LARGE).stat().st_mtime_ns == made
    os.utime(folder / LARGE, ns=(0, 0))
    assert keep_large_picture(folder)
    assert (folder / LARGE).stat().st_mtime_ns > 0


def test_strokes_that_would_take_too_long_get_no_larger_picture(tmp_path: Path) -> None:
    wide = load_brush("round").model_copy(update={"alpha": 1e3})
    folder = put_plan(tmp_path, "lines", LINES.model_copy(update={"brushes": {LINES.paints[0].brush: wide}})).parent
    assert not keep_large_picture(folder)
    assert not (folder / LARGE).exists()


def pinch(view: Locator, x: float, y: float, before: float, after: float) -> None:
    """Spread two fingers, whose middle is at (x, y), from so many CSS pixels apart to others."""
    fingers = view.page.context.new_cdp_session(view.page)
    for kind, apart in (("touchStart", before), ("touchMove", (before + after) / 2), ("touchMove", after)):
        ends = [{"x": x - apart / 2, "y": y, "id": 0}, {"x": x + apart / 2, "y": y, "id": 1}]
        fingers.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": ends})
    fingers.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_on_a_phone_dialogs_and_what_stays_in_sight_lie_below_the_frame_of_the_page(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan_with_lines(studio.folder, "lines")
    studio.kill()
    studio.start()  # it finds all plans when it starts
    tab = page("/plan", viewport={"width": 390, "height": 640})
    frame = tab.get_by_role("banner").bounding_box()
    assert frame is not None

    def lies_below(shown: Locator) -> bool:
        expect(shown).to_be_visible()
        box = shown.bounding_box()
        assert box is not None
        return frame["y"] + frame["height"] <= box["y"] <= 640 - box["height"]

    tab.get_by_role("button", name="Look closer").click()
    assert lies_below(tab.locator(".closer"))
    tab.get_by_role("button", name="Close", exact=True).click()
    tab.get_by_role("link", name="Mix").click()
    tab.get_by_role("button", name="Change").click()
    assert lies_below(tab.locator(".tube-table"))
    tab.get_by_role("button", name="Leave as it was").click()
    tab.get_by_role("link", name="Styles").click()
    tab.get_by_role("button", name="Look closer at scribble").scroll_into_view_if_needed()
    assert lies_below(tab.get_by_role("button", name="Compare", exact=True))
    tab.get_by_role("link", name="Paint", exact=True).click()
    tab.get_by_role("button", name="Check").click()
    outcome = tab.locator(".outcome")
    expect(outcome).to_be_visible()
    outcome.evaluate("(shown) => scrollTo(0, scrollY + shown.getBoundingClientRect().top)")
    assert lies_below(outcome)
