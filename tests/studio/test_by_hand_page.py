"""A plotter that is set up on the page, in a real browser."""

import re
from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.support.robot.fake_grbl import WITH_SWITCHES, FakeGrbl
from tests.support.studio.plans_to_paint import put_plan


def take_hold(page: Callable[..., Page], device: FakeGrbl) -> Page:
    """Take hold of a plotter on the panel Paint, and return its page."""
    tab = page("/paint?plan=coast", reduced_motion="reduce")  # what still unfolds moves away beneath the mouse
    tab.get_by_label("Machine", exact=True).click()
    tab.get_by_role("option", name="Pen plotter with Grbl").click()
    tab.get_by_label("Port").fill(device.port)
    tab.get_by_label("Port").press("Enter")
    tab.get_by_role("button", name="Set the machine up by hand").click()
    tab.get_by_role("button", name="Take hold of the machine").click()
    return tab


def test_a_plotter_is_moved_step_by_step_and_escape_lifts_its_pen(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "coast")
    with FakeGrbl(pace=20.0) as device:
        tab = take_hold(page, device)
        where = tab.get_by_text(re.compile(r"^x .* mm, pen"))
        expect(where).to_have_text("x 0.0, y 0.0, z 5.0 mm, pen lifted")
        expect(tab.get_by_role("button", name="Start painting")).to_be_disabled()
        tab.get_by_role("button", name="10 mm").click()
        tab.get_by_role("button", name="x +").click()
        expect(where).to_have_text("x 10.0, y 0.0, z 5.0 mm, pen lifted")
        tab.get_by_role("button", name="x \N{MINUS SIGN}").click()
        tab.get_by_role("button", name="x \N{MINUS SIGN}").click()
        expect(tab.get_by_text("The machine's x is -10 mm")).to_be_visible()
        tab.get_by_role("button", name="Lower the pen").click()
        expect(where).to_contain_text("pen lowered")
        tab.keyboard.press("Escape")
        expect(tab.get_by_text("You stopped it.")).to_be_visible()
        assert device.place[2] == 5
        expect(tab.get_by_role("button", name="Start painting")).to_be_enabled()


def test_a_locked_plotter_finds_home_on_the_page(studio: RunningStudio, page: Callable[..., Page]) -> None:
    put_plan(studio.folder, "coast")
    with FakeGrbl(pace=20.0, locked=True, **WITH_SWITCHES) as device:
        tab = take_hold(page, device)
        expect(tab.get_by_text("The machine is locked, as its place may be lost.")).to_be_visible()
        expect(tab.get_by_role("button", name="Unlock it where it is")).to_be_visible()
        expect(tab.get_by_role("button", name="x +")).to_be_hidden()
        tab.get_by_role("button", name="Find home by its switches").click()
        expect(tab.get_by_text(re.compile(r"^x .* mm, pen"))).to_have_text("x 99.0, y 99.0, z 19.0 mm, pen lifted")
        expect(tab.get_by_role("button", name="Unlock it where it is")).to_be_hidden()
        expect(tab.get_by_role("button", name="Find home by its switches")).to_be_visible()
        tab.get_by_role("button", name="Done: let the machine go").click()
        expect(tab.get_by_role("button", name="Take hold of the machine")).to_be_visible()
