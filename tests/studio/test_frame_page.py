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
