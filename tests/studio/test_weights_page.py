"""Sliders for what matters, on the card of a finished plan in a browser."""

from collections.abc import Callable

from playwright.sync_api import Locator, Page, expect

from maulstick.painting.painting_file import read_painting
from tests.studio.conftest import RunningStudio
from tests.support.studio.plans_to_paint import put_plan_to_direct


def card(page: Page, name: str) -> Locator:
    return page.get_by_role("article", name=f"Plan {name}", exact=True)


def page_of(studio: RunningStudio, page: Callable[..., Page]) -> Page:
    """Open the plans of a studio that is started anew, so that it finds those that were put into its folder."""
    studio.close()
    studio.start()
    return page("/plan")


def test_a_slider_of_a_finished_plan_makes_a_version_that_takes_over(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    file = put_plan_to_direct(studio.folder, "coast")
    planned = read_painting(file)
    shown = page_of(studio, page)
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


def test_a_version_is_made_while_one_looks_at_another_panel(studio: RunningStudio, page: Callable[..., Page]) -> None:
    put_plan_to_direct(studio.folder, "coast")
    shown = page_of(studio, page)
    card(shown, "coast").get_by_role("button", name="What matters").click()
    card(shown, "coast").get_by_label("Outlines").fill("1")
    shown.get_by_role("link", name="Paint").click()
    expect(shown.get_by_role("heading", level=1)).to_have_text("Let a machine paint")
    shown.get_by_role("link", name="Plan").click()
    version = card(shown, "coast, version 2")
    expect(version.get_by_text("Planned again, “Outlines” at 1 instead of 0.")).to_be_visible()
    expect(shown.get_by_text("Something in Maulstick is broken")).to_have_count(0)


def test_the_card_of_a_version_says_the_weights_of_now(studio: RunningStudio, page: Callable[..., Page]) -> None:
    file = put_plan_to_direct(studio.folder, "coast")
    request = file.with_name("request.json")
    request.write_text(request.read_text().replace('"steps": 3', '"steps": 5000'))
    shown = page_of(studio, page)
    card(shown, "coast").get_by_role("button", name="What matters").click()
    card(shown, "coast").get_by_label("Outlines").fill("1")
    version = card(shown, "coast, version 2")
    expect(version.locator(".phase")).to_have_text("planning")
    version.get_by_label("Outlines").fill("2")
    expect(version.get_by_text("Planned again, “Outlines” at 2 instead of 0.")).to_be_visible()
    version.get_by_role("button", name="Stop and keep").click()
    expect(version.locator(".phase")).to_have_text("stopped early")
    assert read_painting(studio.folder / "plans" / "coast-version-2" / "painting.json")
