"""What hands and keys do on the canvas on which a plan is directed, in a browser."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, Route, expect

from maulstick.painting.painting_file import read_painting
from tests.studio.conftest import RunningStudio
from tests.studio.test_directing_page import sharp
from tests.support.planned import STROKES
from tests.support.studio.plans_to_paint import put_plan_to_direct

# Places are millimetres of the sheet. Pointers that no hand holds cannot be captured, and must not be asked to.
_POINTERS = """() => {
Element.prototype.setPointerCapture = () => {};
window.point = (type, x, y, told = {}) => {
  const view = document.querySelector(".strokes-view"), box = view.getBoundingClientRect();
  const scale = Math.min(box.width, box.height) / 60;
  const clientX = box.left + box.width / 2 + scale * (x - 30), clientY = box.top + box.height / 2 + scale * (y - 30);
  const pen = { pointerId: 7, pointerType: "pen", button: 0, buttons: 1, pressure: 0.4, bubbles: true };
  view.dispatchEvent(new PointerEvent(type, { ...pen, clientX, clientY, ...told }));
};
}"""


@pytest.fixture(autouse=True)
def _coast(tmp_path: Path) -> None:
    put_plan_to_direct(tmp_path / "studio", "coast")


def opened(page: Callable[..., Page], tool: str = "Choose") -> tuple[Page, Locator]:
    """Open the canvas with a tool and pointers that a script moves; return the page and the view."""
    tab = page("/plan/coast")
    view = tab.get_by_role("group", name="The strokes of coast")
    sharp(view, 0)
    tab.get_by_role("button", name=tool, exact=True).click()
    expect(view).to_have_class(f"strokes-view {tool.lower()}")
    tab.evaluate(_POINTERS)
    return tab, view


def middle_of(view: Locator) -> tuple[float, float]:
    box = view.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def acts(studio: RunningStudio) -> list[dict[str, Any]]:
    """Return what was done, as the studio has kept it."""
    (file,) = (studio.folder / "plans" / "coast").glob("edits-*.jsonl")
    return [json.loads(line) for line in file.read_text().splitlines()]


def opened_with_a_chosen_stroke(page: Callable[..., Page]) -> tuple[Page, Locator]:
    tab, view = opened(page)
    view.focus()
    view.press(".")
    expect(view).to_have_attribute("data-chosen", "")
    return tab, view


def test_a_stroke_ends_at_the_edge_of_the_sheet(studio: RunningStudio, page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Draw")
    tab.evaluate("""() => {
      point("pointerdown", 50, 20);
      for (const [x, y] of [[55, 20], [65, 20], [65, 50], [55, 50], [50, 50]]) point("pointermove", x, y);
      point("pointerup", 50, 50);
    }""")
    sharp(view, 1)
    (act,) = acts(studio)
    assert max(y for _, y, _ in act["edit"]["trajectory"]) < 0.025


def test_palms_leave_a_pen_alone(studio: RunningStudio, page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Draw")
    tab.evaluate("""() => {
      const palm = { pointerType: "touch", pointerId: 20 }, other = { ...palm, pointerId: 21 };
      point("pointerdown", 40, 50, palm);
      point("pointerdown", 10, 20);
      point("pointermove", 12, 20);
      point("pointerdown", 45, 50, other);
      for (const each of [palm, other]) point("pointermove", 48, 55, each);
      point("pointercancel", 48, 55, palm);
      point("pointermove", 20, 20);
      point("pointerup", 20, 20);
      point("pointerup", 48, 55, other);
    }""")
    sharp(view, 1)
    drawn = acts(studio)[0]["edit"]["trajectory"]
    assert max(x for x, _, _ in drawn) - min(x for x, _, _ in drawn) > 0.009
    assert max(y for _, y, _ in drawn) < 0.025


def test_the_sheet_is_as_sharp_as_the_screen_to_which_its_window_is_moved(page: Callable[..., Page]) -> None:
    tab, view = opened(page)
    screen = {"width": 1280, "height": 720, "deviceScaleFactor": 2, "mobile": False}
    tab.context.new_cdp_session(tab).send("Emulation.setDeviceMetricsOverride", screen)
    tab.wait_for_function("devicePixelRatio === 2")
    view.press("m")
    canvas = view.locator("canvas").first
    tab.wait_for_function("(canvas) => canvas.width === 2 * canvas.clientWidth", arg=canvas.element_handle())
    sharp(view, 0)


def test_a_key_that_is_held_acts_once_and_none_undoes_behind_a_dialog(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    for _ in range(4):
        tab.keyboard.down("l")
    tab.keyboard.up("l")
    sharp(view, 1)
    tab.get_by_role("button", name="Save this as it is").click()
    expect(tab.get_by_role("dialog")).to_be_visible()
    tab.keyboard.press("Control+z")
    tab.keyboard.press("Escape")
    expect(tab.get_by_role("dialog")).to_have_count(0)
    view.press("Shift+ArrowLeft")
    sharp(view, 2)
    assert [act["edit"]["kind"] for act in acts(studio)] == ["lock", "move"]


def test_keys_are_the_canvas_s_after_a_click_beside_it_and_a_tool_is_in_hand_at_once(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab, view = opened(page)
    expect(view).to_be_focused()
    tab.evaluate("""() => {
      document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key: "b", bubbles: true }));
      point("pointerdown", 10, 20);
      for (const x of [15, 20]) point("pointermove", x, 20);
      point("pointerup", 20, 20);
    }""")
    sharp(view, 1)
    assert acts(studio)[0]["edit"]["kind"] == "add"
    expect(view).to_have_class("strokes-view draw")
    tool = tab.get_by_role("button", name="Look around", exact=True)
    tool.press("Enter")
    expect(view).to_have_class("strokes-view pan")
    expect(tool).to_be_focused()


def test_letters_are_keys_with_caps_lock_too_and_with_shift_strokes_are_added_on_either_side_of_the_last_one(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    said = tab.locator(".said")
    view.press("L")
    sharp(view, 1)
    for _ in range(2):
        view.press(".")
    for key, strokes in ((".", 2), (",", 2), (",", 3), (",", 4)):
        view.press(f"Shift+{'Period' if key == '.' else 'Comma'}")
        expect(said).to_have_text(re.compile(f"^{strokes} strokes: "))
    expect(said).to_have_text(re.compile("; 1 locked$"))
    view.press("Delete")
    sharp(view, 2)
    planned = [stroke.id for stroke in read_painting(studio.folder / "plans" / "coast" / "painting.json").strokes]
    assert [act["edit"]["kind"] for act in acts(studio)] == ["lock", "remove"]
    assert sorted(acts(studio)[1]["edit"]["strokes"]) == sorted(planned[:4])


def test_on_an_upright_tablet_the_canvas_stays_in_view_above_its_tools(page: Callable[..., Page]) -> None:
    tab, view = opened(page)
    tab.set_viewport_size({"width": 768, "height": 1024})
    keys = tab.get_by_text("Keys", exact=True)
    keys.scroll_into_view_if_needed()
    expect(keys).to_be_in_viewport(ratio=1)
    expect(view).to_be_in_viewport(ratio=1)
    tools, canvas = keys.bounding_box(), view.bounding_box()
    assert tools is not None
    assert canvas is not None
    assert tools["y"] > canvas["y"] + canvas["height"]


def test_on_a_phone_that_lies_the_canvas_does_not_cover_its_tools(page: Callable[..., Page]) -> None:
    tab, view = opened(page)
    tab.set_viewport_size({"width": 844, "height": 390})
    keys = tab.get_by_text("Keys", exact=True)
    keys.scroll_into_view_if_needed()
    tools, canvas = keys.bounding_box(), view.bounding_box()
    assert tools is not None
    assert canvas is not None
    assert tools["y"] > canvas["y"] + canvas["height"]


def test_what_an_arrow_key_has_moved_is_not_lost_to_what_is_done_next(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    view.press("l")
    sharp(view, 1)
    undo = tab.get_by_role("button", name="Undo")
    expect(undo).to_be_enabled()
    view.evaluate(
        """(view, undo) => {
          view.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
          undo.focus();
          undo.click();
        }""",
        undo.element_handle(),
    )
    sharp(view, 3)
    view.evaluate("""(view) => {
      view.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
      for (const type of ["pointerdown", "pointerup"]) point(type, 30, 30, { pointerType: "mouse", button: 1 });
    }""")
    sharp(view, 4)
    kinds = [act["edit"]["kind"] if "edit" in act else act["act"] for act in acts(studio)]
    assert kinds == ["lock", "move", "undo", "move"]


def test_what_is_moved_or_turned_while_another_page_takes_it_out_is_left_alone(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    x, y, _ = read_painting(studio.folder / "plans" / "coast" / "painting.json").strokes[-1].trajectory[0]
    other = page("/plan/coast").get_by_role("group", name="The strokes of coast")
    place = """(view, on) => {
      const { stage } = getElement(Number(view.id.slice(1))), box = view.getBoundingClientRect();
      const { scale, x, y } = stage.view;
      const [left, upper] = on ? on.map((side, i) => side * scale + [x, y][i]) : stage.handle();
      return [left + box.left, upper + box.top];
    }"""
    for done, on in ((0, [1e3 * x, 1e3 * y]), (2, None)):
        view.press("Control+a")
        expect(tab.locator(".said")).to_have_text(re.compile(f"^{STROKES} strokes"))
        expect(view).to_have_attribute("data-chosen", "")  # its picture has come
        x, y = view.evaluate(place, on)
        tab.mouse.move(x, y)
        tab.mouse.down()
        tab.mouse.move(x + 10, y)
        sharp(other, done)
        other.press("Control+a")
        expect(other.page.locator(".said")).to_have_text(re.compile(f"^{STROKES} strokes"))
        other.press("Delete")
        sharp(view, done + 1)
        expect(tab.locator(".said")).to_have_text(re.compile("^Nothing is chosen"))
        tab.mouse.move(x + 20, y)
        tab.mouse.up()
        view.press("Control+z")
        sharp(view, done + 2)
        assert tab.locator(".q-notification").all_inner_texts() == []


def test_a_plan_that_is_thrown_away_meanwhile_is_directed_no_more(page: Callable[..., Page]) -> None:
    tab, _ = opened(page)
    page("/plan").get_by_role("button", name="Throw coast away").click()
    expect(tab.get_by_role("heading", name="There is nothing to direct")).to_be_visible()
    expect(tab.get_by_text("There is no plan coast any more.")).to_be_visible()


def test_what_is_typed_of_a_region_stays_while_another_page_acts_and_what_cannot_be_does_not(
    page: Callable[..., Page],
) -> None:
    tab, view = opened(page, "Importance")
    brush, told = tab.get_by_label("Brush", exact=True), tab.locator(".q-notification")
    brush.fill("-2")
    tab.mouse.move(*middle_of(view))
    tab.evaluate("""() => { for (const type of ["down", "up"]) point(`pointer${type}`, 30, 30); }""")
    expect(told).to_contain_text("The width of the brush is -2 mm; it must be from 0.1 to 1000 mm")
    told.get_by_role("button", name="OK").click()
    brush.fill("20")
    tab.evaluate("""() => { for (const type of ["down", "up"]) point(`pointer${type}`, 30, 30); }""")
    sharp(view, 1)
    name, size = tab.get_by_label("Name"), tab.get_by_label("Size of the hand")
    name.fill("ey")
    other = page("/plan/coast").get_by_role("group", name="The strokes of coast")
    sharp(other, 1)
    other.press("Control+a")
    expect(other.page.locator(".said")).to_have_text(re.compile(f"^{STROKES} strokes"))
    other.press("l")
    sharp(view, 2)
    name.press("End")
    name.press_sequentially("es")
    name.press("Enter")
    sharp(view, 3)
    expect(name).to_have_value("eyes")
    size.fill("0")
    size.press("Enter")
    expect(told).to_contain_text("The size of the hand is 0 times; it must be from 0.02 to 50 times")
    expect(size).to_have_value("1")
    for field, holds in ((name, "eyes"), (tab.get_by_label("Counts").last, "3"), (tab.get_by_label("Soft edge"), "0")):
        field.fill("")
        field.press("Enter")
        expect(field).to_have_value(holds)


def test_an_error_lies_above_the_sheet(page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Region")
    tab.evaluate(
        """() => { point("pointerdown", 10, 10); point("pointermove", 40, 10); point("pointerup", 40, 10); }"""
    )
    error = tab.locator(".q-notification")
    expect(error).to_contain_text("There is no area in that")
    lies, sheet = error.bounding_box(), view.bounding_box()
    assert lies is not None
    assert sheet is not None
    assert lies["y"] + lies["height"] <= sheet["y"]


def test_a_double_click_makes_one_version(studio: RunningStudio, page: Callable[..., Page]) -> None:
    tab, _ = opened(page)
    tab.get_by_role("button", name="Keep as a version").dblclick()
    tab.wait_for_url("**/plan")
    expect(tab.get_by_role("article", name="Plan coast, version 2")).to_be_visible()
    assert sorted(each.name for each in (studio.folder / "plans").iterdir()) == ["coast", "coast-version-2"]


def test_a_region_is_chosen_and_left_again_in_the_list_by_the_keyboard(page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Region")
    tab.evaluate("""() => {
      point("pointerdown", 10, 10);
      for (const [x, y] of [[30, 10], [30, 30], [10, 30]]) point("pointermove", x, y);
      point("pointerup", 10, 10);
    }""")
    sharp(view, 1)
    row = tab.get_by_role("list", name="Regions and guides").get_by_role("button", name="Region", exact=True)
    expect(row).to_have_attribute("aria-pressed", "true")
    row.focus()
    for pressed in ("false", "true"):
        tab.keyboard.press("Enter")
        expect(row).to_have_attribute("aria-pressed", pressed)
        expect(row).to_be_focused()


def test_what_an_arrow_key_has_moved_is_kept_where_the_tab_is_closed_at_once(page: Callable[..., Page]) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    view.press("ArrowLeft")
    tab.close(run_before_unload=True)
    sharp(page("/plan/coast").get_by_role("group", name="The strokes of coast"), 1)


def test_an_answer_that_breaks_off_is_asked_for_again(page: Callable[..., Page]) -> None:
    tab, view = opened_with_a_chosen_stroke(page)
    tab.evaluate("""() => {
      const { arrayBuffer } = Response.prototype;
      Response.prototype.arrayBuffer = function () {
        Response.prototype.arrayBuffer = arrayBuffer;
        return Promise.reject(new TypeError("the line is broken"));
      };
    }""")
    view.press("Delete")
    sharp(view, 1)


def test_strokes_that_did_not_come_are_asked_for_again(page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Draw")
    tab.evaluate("""() => {
      const { fetch } = window;
      window.fetch = (...asked) => { window.fetch = fetch; return Promise.reject(new TypeError("there is no line")); };
      for (const [type, x] of [["down", 10], ["move", 20], ["up", 20]]) point(`pointer${type}`, x, 10);
    }""")
    sharp(view, 1)


def test_each_stroke_is_seen_until_the_studio_has_it(page: Callable[..., Page]) -> None:
    tab, view = opened(page, "Draw")
    held: list[Route] = []
    tab.route("**/strokes/coast/*", lambda route: held.append(route), times=1)
    with tab.expect_request("**/strokes/coast/*"):
        bare, first, both = (
            view.evaluate(
                """async (view, y) => {
                  const line = y ? [["down", 10], ["move", 30], ["up", 30]] : [];
                  for (const [type, x] of line) point(`pointer${type}`, x, y);
                  for (let frames = 0; frames < 3; frames++) await new Promise(requestAnimationFrame);
                  const upper = document.createElement("canvas"), sheet = view.querySelector("canvas");
                  [upper.width, upper.height] = [sheet.width, sheet.height / 2];
                  upper.getContext("2d").drawImage(sheet, 0, 0);
                  return upper.toDataURL();
                }""",
                y,
            )
            for y in (0, 10, 50)
        )
    assert bare != first
    assert first == both
    while not held:
        tab.wait_for_timeout(20)  # a request is told before its route is
    held[0].continue_()
    sharp(view, 2)
