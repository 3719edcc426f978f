"""Copies, and strokes to wait before, on the panel that paints, in a real browser."""

from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_copies import FOUR, PAUSE, SECOND
from tests.studio.test_machine_first_page import choose
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.studio.plans_to_paint import put_plan


def test_copies_and_pauses_are_asked_for_where_the_machine_can_make_them(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "four", FOUR)
    tab = page("/paint?plan=four", viewport={"width": 1024, "height": 768})
    tab.get_by_role("button", name="Speed, sheet, camera and copies").click()
    copies, pauses = tab.get_by_label("Copies", exact=True), tab.get_by_label("Wait before strokes")
    expect(pauses).to_be_visible()
    expect(copies).to_be_hidden()  # the simulated easel has one sheet
    choose(tab, "Machine", "AxiDraw")
    expect(tab.get_by_text("Push the pen to its home corner before the board is switched on")).to_be_visible()
    copies.fill("2")
    pauses.fill("3, many")
    with FakeEbb(pace=50.0) as board:
        port = tab.get_by_label("Port", exact=True)
        port.fill(board.port)
        port.press("Enter")
        tab.get_by_role("button", name="Check").click()
        expect(tab.get_by_text("the stroke to wait before is 'many'; it must be a number from 1 to")).to_be_visible()
        pauses.fill("5")
        tab.get_by_role("button", name="Check").click()
        expect(tab.locator(".outcome")).to_have_text(
            "The number of a stroke to wait before is 5; it must be 1 to the 4 strokes"
        )
        pauses.fill("3")
        tab.get_by_role("button", name="Check").click()
        expect(tab.locator(".outcome")).to_have_text(
            "It fits. 4 strokes, 120 mm, 1 paint, about 1 min; then another sheet."
        )
        tab.get_by_role("button", name="Start painting").click()
        for asked in ("put in the marker", PAUSE, SECOND, PAUSE):
            expect(tab.locator(".question .message").first).to_contain_text(f"Please {asked}")
            tab.get_by_role("button", name="Done").click()
        expect(tab.locator(".outcome")).to_have_text("four is painted.")
