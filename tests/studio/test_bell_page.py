"""Notifications of the browser, in a real one whose notifications are written down."""

from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_machine_first_page import PENS, choose
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import put_plan

_WRITTEN_DOWN = """
  window.told = [];
  window.asked = 0;
  window.Notification = class {
    static permission = sessionStorage.getItem("permission") ?? "ANSWER_BEFORE";
    static async requestPermission() {
      window.asked += 1;
      sessionStorage.setItem("permission", this.permission = "ANSWER");
      return this.permission;
    }
    constructor(title, options) { window.told.push([title, options.body, options.tag]); }
  };
  window.isAway = false;
  document.hasFocus = () => !window.isAway;
"""
_LABEL = "Tell me when it waits or is finished"


def opened(page: Callable[..., Page], path: str, before: str, answer: str) -> Page:
    """Open a page in a browser that gives an answer when it is asked."""
    tab = page("/trash")
    tab.add_init_script(_WRITTEN_DOWN.replace("ANSWER_BEFORE", before).replace("ANSWER", answer))
    tab.goto(tab.url.replace("/trash", path))
    tab.wait_for_selector(".panel h1")
    return tab


def leave(tab: Page) -> None:
    """Look elsewhere from now on: menus close under the pointer then, so choose first."""
    tab.evaluate("isAway = true")


def test_a_person_who_asks_is_told_what_a_machine_waits_for_and_its_end(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "six", SIX)
    tab = opened(page, "/paint?plan=six", "default", "granted")
    silent = opened(page, "/plan", "granted", "granted")
    refused = opened(page, "/plan", "default", "denied")
    bell = tab.get_by_role("button", name=_LABEL)
    expect(bell).to_have_attribute("aria-pressed", "false")
    assert tab.evaluate("asked") == 0
    bell.click()
    expect(bell).to_have_attribute("aria-pressed", "true")
    assert tab.evaluate("asked") == 1
    refused.get_by_role("button", name=_LABEL).click()
    expect(refused.get_by_role("button", name=_LABEL)).to_be_hidden()

    tab.reload()
    tab.wait_for_selector(".panel h1")
    expect(bell).to_have_attribute("aria-pressed", "true")
    choose(tab, "Machine", PENS)
    for each in (tab, silent, refused):
        leave(each)
    tab.get_by_role("button", name="Start painting").click()
    for pen in ("paint 1 (red)", "paint 2 (blue)"):
        expect(tab.locator(".question .message").first).to_contain_text(pen)
        tab.get_by_role("button", name="Done").click()
    tab.wait_for_function("told.length === 3")
    first, second, end = tab.evaluate("told")
    assert first[0] == second[0] == "six waits for you"
    assert first[1].startswith("Please put in the marker with paint 1 (red); it draws")
    assert end == ["six is painted", "six is painted.", "run"]
    assert [silent.evaluate("told"), refused.evaluate("told")] == [[], []]
    bell.click()
    expect(bell).to_have_attribute("aria-pressed", "false")


def test_a_browser_that_refuses_has_no_button(studio: RunningStudio, page: Callable[..., Page]) -> None:
    refused = opened(page, "/plan", "denied", "denied")
    expect(refused.get_by_role("button", name="STOP")).to_be_visible()
    expect(refused.get_by_role("button", name=_LABEL)).to_be_hidden()
