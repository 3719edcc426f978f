"""Frame of the page: its tab's title, addresses that lead nowhere, and where a new plan's card begins, in a browser."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from maulstick.robot.journal import journal_of
from tests.studio.conftest import RunningStudio, patient
from tests.support.studio.plans_to_paint import put_plan

SIZE = {"width": 1280, "height": 600}


@pytest.fixture(autouse=True)
def _plans(tmp_path: Path) -> None:
    for number in range(6):
        put_plan(tmp_path / "studio", f"lines-{number}")


def test_the_tab_says_how_far_it_is_at_any_panel_and_a_new_plan_comes_into_view(
    page: Callable[..., Page], studio: RunningStudio
) -> None:
    tab = page("/paint?plan=lines-3", viewport=SIZE)
    expect(tab).to_have_title("Paint · Maulstick")
    tab.get_by_role("button", name="Start painting").click()
    expect(tab).to_have_title(re.compile(r"^\d+% lines-3 · Maulstick$"))
    tab.get_by_role("link", name="Plan").click()
    expect(tab).to_have_title(re.compile("lines-3"))
    tab.get_by_role("button", name="STOP").click()
    expect(tab).to_have_title("Plan · Maulstick")
    tab.get_by_role("button", name="Try an example picture").click()
    expect(tab.get_by_role("radio", name="portrait")).to_be_checked()
    tab.locator(".side .sheet").last.scroll_into_view_if_needed()
    tab.mouse.wheel(0, 4000)
    expect(tab.locator(".plan h2").first).not_to_be_in_viewport()
    tab.get_by_role("button", name="Plan it").click()
    new = tab.get_by_role("article", name="Plan portrait")
    expect(new.get_by_role("heading", name="portrait")).to_be_in_viewport()
    expect(tab).to_have_title(re.compile(r"^\d+% Portrait · Maulstick$"))
    new.get_by_role("button", name="Stop and keep").click()


def test_a_click_that_waits_for_a_broken_line_does_nothing_after_a_stop(
    page: Callable[..., Page], studio: RunningStudio
) -> None:
    tab = page("/paint?plan=lines-3", viewport=SIZE)
    start = tab.get_by_role("button", name="Start painting")
    expect(start).to_be_enabled()
    tab.evaluate("window.socket.disconnect()")
    start.click()
    tab.get_by_role("button", name="STOP").click()
    expect(tab.get_by_text("Nothing moves: there was nothing to stop.")).to_be_visible()
    tab.evaluate("window.socket.connect()")
    tab.get_by_role("link", name="Plan").click()
    expect(tab).to_have_title("Plan · Maulstick")
    assert not journal_of(studio.folder / "plans" / "lines-3" / "painting.json").exists()


def test_an_address_that_leads_nowhere_says_so_and_leads_back(studio: RunningStudio, browser: Browser) -> None:
    tab = studio.let_in(patient(browser.new_context())).new_page()
    tab.goto(f"{studio.url}/nowhere")
    expect(tab.get_by_role("heading", name="There is no such page")).to_be_visible()
    expect(tab.locator(".panel-link[aria-current]")).to_have_count(0)
    expect(tab).to_have_title("No such page · Maulstick")
    tab.get_by_role("button", name="Go to the beginning").click()
    expect(tab.get_by_role("heading", name="Show how you draw")).to_be_visible()
    tab.context.close()


def test_on_a_small_phone_all_panels_are_within_reach_and_none_is_wider_than_the_window(
    page: Callable[..., Page],
) -> None:
    tab = page("/trash", viewport={"width": 320, "height": 640}, is_mobile=True, has_touch=True)
    for name in ("Draw", "Styles", "Plan", "Mix", "Paint", "Survey", "Trash"):
        link = tab.get_by_role("navigation").get_by_role("link", name=name)
        expect(link).to_be_in_viewport(ratio=1)
        link.tap()
        expect(link).to_have_attribute("aria-current", "page")
        assert tab.evaluate("document.documentElement.scrollWidth") == 320, name


def test_errors_however_many_leave_half_of_a_phone_s_page_in_sight(page: Callable[..., Page]) -> None:
    tab = page("/plan", viewport={"width": 360, "height": 640}, is_mobile=True, has_touch=True)
    tab.get_by_role("button", name="Try an example picture").tap()
    expect(tab.get_by_role("radio", name="portrait")).to_be_checked()
    for strokes in (0, 1.5, 2.5, 3.5, 4.5, 5.5):
        tab.get_by_label("Strokes", exact=True).fill(str(strokes))
        tab.get_by_role("button", name="Plan it").evaluate("(go) => go.click()")
        error = tab.get_by_role("alert").filter(has_text=f"The number of strokes is {strokes};")
        expect(error).to_be_in_viewport()
    box = tab.locator(".q-notifications__list--top.items-center").bounding_box()
    assert box is not None
    assert box["y"] + box["height"] < 0.6 * 640
    first = tab.get_by_role("alert").filter(has_text="The number of strokes is 0;").get_by_role("button", name="OK")
    first.scroll_into_view_if_needed()
    first.tap()
    expect(tab.get_by_role("alert").filter(has_text="The number of strokes is")).to_have_count(5)
