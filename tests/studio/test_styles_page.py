"""Panel of styles in a browser: by pointer, by keyboard, and with names that look like markup or paths."""

import os
import re
from collections.abc import Callable
from dataclasses import replace

import pytest
from playwright.sync_api import Page, expect

from maulstick.style.store import write_style
from tests.studio.conftest import RunningStudio
from tests.support.style.synthetic_hands import circle, exemplar_of


@pytest.fixture
def own(studio: RunningStudio) -> str:
    """Write a style of the user's own, whose recording has a name like markup; return the style's name."""
    write_style(replace(exemplar_of(circle, 8), name="cat"), "<img src=x onerror=alert(1)>", studio.data / "styles")
    return "cat"


def test_a_gallery_leads_to_the_strokes_of_a_hand_by_mouse_and_by_keyboard(page: Callable[..., Page]) -> None:
    shown = page("/styles")
    expect(shown.locator(".style-card h2")).to_have_text(
        ["contour", "cursive", "elephant", "hatching", "loops", "marks", "moscow", "scribble"]
    )
    expect(shown.get_by_role("button", name="Compare", exact=True)).to_be_disabled()
    expect(shown.locator(".style-card img")).to_have_count(8)

    shown.get_by_role("button", name="Look closer at marks").press("Enter")
    told = shown.locator(".large-stroke")
    expect(told).to_contain_text("No stroke is chosen yet.")
    assert shown.get_by_role("button", name="Delete").count() == 0, "it comes with Maulstick"
    strokes = shown.locator(".stroke-map path[data-stroke]")
    expect(strokes).to_have_count(62)
    strokes.nth(3).click(force=True)
    expect(told).to_contain_text("by marks")
    expect(shown.locator(".large-stroke path")).to_have_count(2)
    shown.keyboard.press("Home")
    expect(told).to_contain_text("Stroke 1 of 62")
    shown.keyboard.press("PageDown")
    expect(told).to_contain_text("Stroke 2 of 62")
    towards = next(
        way for way in ("Left", "Right", "Up", "Down") if strokes.nth(1).get_attribute(f"data-{way.lower()}") != "1"
    )
    to = int(strokes.nth(1).get_attribute(f"data-{towards.lower()}") or "")
    shown.keyboard.press(f"Arrow{towards}")
    expect(told).to_contain_text(f"Stroke {to + 1} of 62")

    shown.get_by_role("button", name="All hands").click()
    for name in ("loops", "hatching"):
        shown.get_by_role("checkbox", name=f"Compare {name}").click()
    shown.get_by_role("button", name="Compare", exact=True).click()
    expect(shown.get_by_role("row", name="loops 4.0")).to_be_visible()
    expect(shown.get_by_text("Beside loops, the strokes of hatching")).to_be_visible()
    expect(shown.locator(".stroke-map path.whose-1")).to_have_count(80)


def test_the_address_leads_back_and_forward_and_stands_a_reload(page: Callable[..., Page]) -> None:
    shown = page("/styles")
    shown.get_by_role("button", name="Look closer at marks").click()
    marks = shown.get_by_role("heading", name="marks", exact=True)
    expect(marks.and_(shown.locator("h1"))).to_be_visible()
    expect(shown).to_have_url(re.compile(r"/styles\?style=marks$"))
    expect(shown.get_by_role("button", name="All hands")).to_be_focused()
    shown.go_back()
    expect(shown.get_by_role("button", name="Look closer at marks")).to_be_focused()
    shown.go_forward()
    expect(marks.and_(shown.locator("h1"))).to_be_visible()
    shown.go_back()
    for name in ("loops", "hatching"):
        shown.get_by_role("checkbox", name=f"Compare {name}").click()
    shown.get_by_role("button", name="Compare", exact=True).click()
    both = shown.get_by_role("heading", name="loops and hatching")
    expect(both).to_be_visible()
    expect(shown).to_have_url(re.compile(r"/styles\?compare=loops,hatching$"))
    shown.reload()
    expect(both).to_be_visible()
    shown.get_by_role("button", name="All hands").click()
    expect(shown.get_by_role("checkbox", name="Compare loops")).to_be_checked()
    expect(shown).to_have_url(re.compile(r"/styles$"))
    shown.go_back()
    expect(both).to_be_visible()


def test_an_address_that_asks_for_nobody_leads_to_the_gallery(studio: RunningStudio, page: Callable[..., Page]) -> None:
    shown = page("/styles?style=nobody")
    for asked in ("style=", "compare=", "compare=nobody,../loops", "compare=,,"):
        expect(shown.get_by_role("heading", name="Hands to paint with")).to_be_visible()
        shown.goto(f"{studio.url}/styles?{asked}")
    expect(shown.get_by_role("heading", name="Hands to paint with")).to_be_visible()


def test_a_hand_of_ones_own_is_renamed_and_deleted_and_had_again_on_all_pages(
    own: str, studio: RunningStudio, page: Callable[..., Page]
) -> None:
    shown, other = page("/styles?style=cat"), page("/styles")
    asked: list[str] = []
    shown.on("dialog", lambda dialog: (asked.append(dialog.message), dialog.dismiss()))
    expect(shown.get_by_role("heading", name=own, exact=True)).to_be_visible()
    expect(shown.get_by_text("from <img src=x onerror=alert(1)>")).to_be_visible()

    shown.get_by_role("button", name="Rename").click()
    field = shown.get_by_role("dialog", name=f"Another name for {own}").get_by_label("New name")
    field.fill(" ")
    field.press("Enter")
    expect(shown.get_by_text("there is no title yet; write one")).to_be_visible()
    field.fill("<script>alert(2)</script>")
    field.press("Enter")
    expect(other.get_by_role("article", name="<script>alert(2)</script>")).to_be_visible()
    expect(shown.get_by_role("dialog")).to_have_count(0)
    shown.get_by_role("button", name="Rename").click()
    field = shown.get_by_role("dialog").get_by_label("New name")
    field.fill("Ännä")
    field.press("Enter")
    expect(shown.get_by_role("heading", name="Ännä", exact=True)).to_be_visible()
    expect(shown).to_have_url(re.compile(r"/styles\?style=anna$"))
    expect(other.get_by_role("article", name="Ännä")).to_be_visible()
    expect(other.get_by_role("article", name=own)).to_have_count(0)

    shown.get_by_role("button", name="Delete").click()
    expect(other.get_by_role("article", name="Ännä")).to_have_count(0)
    expect(shown.get_by_text("Ännä is deleted.")).to_be_visible()
    expect(shown.get_by_role("button", name="Undo")).to_be_focused()
    shown.keyboard.press("Enter")
    expect(other.get_by_role("article", name="Ännä")).to_be_visible()
    expect(other.get_by_text("Ännä is deleted.")).to_have_count(0)
    assert sorted(os.listdir(studio.data / "styles")) == ["anna.json", "anna.safetensors"]
    assert asked == [], "nothing that was a name ran"
