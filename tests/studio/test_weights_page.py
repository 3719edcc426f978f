"""Sliders for what matters, on the card of a finished plan in a browser."""

from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect

from maulstick.painting.painting import read_painting
from tests.studio.conftest import RunningStudio
from tests.support.studio.plans_to_paint import put_plan_to_direct


def card(page: Page, name: str) -> Locator:
    return page.get_by_role("article", name=f"Plan {name}", exact=True)


def test_a_slider_of_a_finished_plan_makes_a_version_that_takes_over(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    file = put_plan_to_direct(studio.folder, "coast")
    planned = read_painting(file)
    studio.close()
    studio.start()
    shown = page("/plan")
    coast, version = card(shown, "coast"), card(shown, "coast, version 2")
    coast.get_by_role("button", name="What matters").click()
    outlines, tone = coast.get_by_label("Outlines"), coast.get_by_label("Light and dark")
    tone.fill("0")
    expect(shown.get_by_text("nothing matters any more")).to_be_visible()
    tone.fill("1")
    outlines.fill("1.5")

    expect(version.get_by_label("Outlines")).to_be_focused()
    expect(version.get_by_label("Outlines")).to_have_value("1.5")
    expect(version.get_by_text("Planned again, “Outlines” at 1.5 instead of 0.")).to_be_visible()
    expect(version.locator(".phase")).to_have_text("planned")
    expect(outlines).to_be_hidden()
    expect(outlines).to_have_value("0")
    assert read_painting(file) == planned
    made = read_painting(studio.folder / "plans" / "coast-version-2" / "painting.json")
    assert made.provenance.options["weights"] == {"tone": 1.0, "edges": 1.5}

    version.get_by_label("Outlines").press("ArrowRight")
    third = card(shown, "coast, version 3")
    expect(third.get_by_text("Planned again, “Outlines” at 1.75 instead of 1.5.")).to_be_visible()
    expect(third.locator(".phase")).to_have_text("planned")
