"""Sheets that the chosen machine does not reach are marked, and said, in a real browser."""

from collections.abc import Callable

from playwright.sync_api import Page, expect

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest, demo_picture
from tests.studio.conftest import RunningStudio
from tests.studio.test_machine_first_page import choose


def test_what_the_machine_does_not_reach_is_marked_among_the_sizes_and_said_of_ones_own(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab = page("/plan", viewport={"width": 1024, "height": 768})
    sheet, beyond = tab.get_by_label("Sheet", exact=True), tab.locator(".beyond")
    choose(tab, "Sheet", "A3")
    expect(sheet).to_have_value("A3")
    expect(beyond).to_be_hidden()
    choose(tab, "Machine", "AxiDraw")
    expect(sheet).to_have_value("A3: larger than the machine reaches")
    expect(beyond).to_have_text(
        "This sheet, 297 by 420 mm, is larger than the machine reaches; the largest of its shape is 300 by 212 mm."
    )
    tab.get_by_label("Sheet", exact=True).click()
    expect(tab.get_by_role("option")).to_have_text(
        ["200 by 160 mm", "160 by 160 mm", "A5", "A4", "A3: larger than the machine reaches", "Another size"]
    )
    tab.get_by_role("option", name="A4").click()
    expect(beyond).to_have_text("This sheet, 210 by 297 mm, is reached by the machine only if it lies.")
    choose(tab, "Turned", "Lying")
    expect(beyond).to_be_hidden()
    choose(tab, "Sheet", "Another size")
    tab.get_by_label("Width by height").fill("300 by 300 mm")
    expect(beyond).to_have_text(
        "This sheet, 300 by 300 mm, is larger than the machine reaches; the largest of its shape is 218 by 218 mm."
    )
    tab.get_by_label("Width by height").fill("300 by")
    expect(beyond).to_be_hidden()
    choose(tab, "Machine", "Pen plotter with Grbl")
    tab.get_by_label("Width by height").fill("300 by 300 mm")
    expect(beyond).to_be_hidden()


def test_a_plan_for_a_machine_says_that_its_sheet_is_not_reached() -> None:
    options = PlanOptions(robot="axidraw", size="A3", ink="black", brush="marker", strokes=10, px=48)
    fault = "this sheet, 297 by 420 mm, is larger than the machine reaches; the largest of its shape is 300 by 212 mm"
    assert fault in prepare(PlanRequest(demo_picture(), options)).notes
