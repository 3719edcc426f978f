"""Form of a plan on a tablet: its button covers nothing, and several brushes are chosen in it, in a real browser."""

import json
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_machine_first_page import choose
from tests.studio.test_plan_page import bring_a_picture, card
from tests.support.studio.plans_to_paint import put_plan

EDGES = "(name => document.querySelector(name).getBoundingClientRect())"

# Moves a slider step by step and presses a button, quicker than any timer.
HASTE = """([slider, go]) => {
  for (const value of [0.5, 1, 1.5]) {
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
    slider.dispatchEvent(new Event("change"));
  }
  go.click();
}"""

PADDINGS = "[...document.querySelectorAll('.paint .side .q-field')].map((one) => getComputedStyle(one).paddingBottom)"


def test_several_brushes_are_chosen_in_colours_kept_and_named_on_the_card(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan", viewport={"width": 1024, "height": 768}, has_touch=True)
    go, more = tab.get_by_role("button", name="Plan it"), tab.get_by_label("More brushes", exact=True)
    bring_a_picture(tab, tmp_path)
    choose(tab, "Brush or pen", "fineliner")
    more.click()
    for name in ("wash", "marker"):
        tab.get_by_role("option", name=name).click()
    tab.keyboard.press("Escape")
    expect(tab.get_by_role("listbox")).to_have_count(0)
    expect(go).to_be_in_viewport(ratio=1)
    assert tab.evaluate(f"{EDGES}('.fields').bottom <= {EDGES}('.go').top"), "it covers none of them"
    choose(tab, "Colours", "Ink")
    expect(more).to_be_hidden()
    choose(tab, "Colours", "Paints")
    expect(more).to_be_visible()
    tab.get_by_label("Strokes", exact=True).fill("20")
    choose(tab, "How carefully", "A sketch, quickly")
    expect(tab.get_by_label("Strokes", exact=True)).to_have_value("20")
    expect(go).to_be_in_viewport(ratio=1)
    go.click()
    expect(card(tab).get_by_text("loops, wash, marker and fineliner, 20 strokes")).to_be_visible()
    request = studio.folder / "plans" / "my-sunset" / "request.json"
    assert json.loads(request.read_bytes())["options"]["brush"] == "fineliner,wash,marker"
    choose(tab, "Brush or pen", "round")
    tab.get_by_role("button", name="Plan again like this").click()
    expect(tab.get_by_label("Brush or pen", exact=True)).to_have_value("fineliner, 0.31 mm")
    tab.reload()
    for name in ("wash", "marker"):
        expect(tab.locator(".q-chip", has_text=name)).to_be_visible()
    card(tab).get_by_role("button", name="Stop and keep").click()


def test_several_inks_are_named_kept_and_drawn_with(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    bring_a_picture(tab, tmp_path)
    more = tab.get_by_label("More inks", exact=True)
    expect(more).to_be_hidden()
    choose(tab, "Brush or pen", "fineliner")
    choose(tab, "Colours", "Ink")
    for ink in ("#d2691e", "blue"):
        more.fill(ink)
        more.press("Enter")
        expect(tab.locator(".q-chip", has_text=ink)).to_be_visible()
    tab.get_by_label("Strokes", exact=True).fill("20")
    choose(tab, "How carefully", "A sketch, quickly")
    tab.get_by_role("button", name="Plan it").click()
    expect(card(tab).get_by_text("loops, fineliner, 20 strokes, 3 inks")).to_be_visible()
    request = studio.folder / "plans" / "my-sunset" / "request.json"
    assert json.loads(request.read_bytes())["options"]["ink"] == "#000000,#d2691e,blue"
    card(tab).get_by_role("button", name="Stop and keep").click()
    more.press("Backspace")
    expect(tab.locator(".q-chip", has_text="blue")).to_have_count(0)
    tab.get_by_role("button", name="Plan again like this").click()
    expect(tab.locator(".q-chip", has_text="blue")).to_be_visible()
    tab.reload()
    expect(tab.locator(".q-chip", has_text="blue")).to_be_visible()


def test_a_slider_counts_as_it_was_left_however_soon_the_plan_begins(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    bring_a_picture(tab, tmp_path)
    outlines, go = tab.get_by_label("Outlines"), tab.get_by_role("button", name="Plan it")
    tab.evaluate(HASTE, [outlines.element_handle(), go.element_handle()])
    card(tab).get_by_role("button", name="Stop and keep").click()
    request = studio.folder / "plans" / "my-sunset" / "request.json"
    assert json.loads(request.read_bytes())["options"]["weights"]["edges"] == 1.5


def test_trash_stays_in_sight_beside_what_is_done_and_the_plan_form_leaves_other_panels_as_they_are(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    put_plan(studio.folder, "lines")
    tab = page("/plan", viewport={"width": 1024, "height": 768})
    bring_a_picture(tab, tmp_path)
    tab.get_by_role("button", name="Plan it").click()
    expect(tab.locator(".frame .doing")).to_have_text("planning My Sunset!")
    assert tab.evaluate(f"{EDGES}('.panel-link.aside').right <= {EDGES}('.frame .doing').left")
    assert tab.evaluate(f"{EDGES}('.panel-link.aside').right <= {EDGES}('.panels').right")
    tab.get_by_role("link", name="Paint").click()
    expect(tab.get_by_role("img", name="What is painted")).to_be_visible()
    paddings = tab.evaluate(PADDINGS)
    expect(tab).to_have_url(studio.url + "/paint")  # which the browser is told after it shows the panel
    tab.reload()
    expect(tab.get_by_role("img", name="What is painted")).to_be_visible()
    assert tab.evaluate(PADDINGS) == paddings, "fields of Paint are as if Plan had never been open"
    tab.get_by_role("link", name="Plan").click()
    card(tab).get_by_role("button", name="Stop and keep").click()


def test_a_picture_however_wide_stays_inside_the_form_and_is_called_as_its_file(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan", viewport={"width": 400, "height": 800})
    Image.new("RGB", (4000, 100), "teal").save(panorama := tmp_path / 'the "long" sea.png')
    with tab.expect_file_chooser() as chooser:
        tab.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(panorama)
    chosen = tab.get_by_role("radio", name='the "long" sea', exact=True)
    expect(chosen).to_be_checked()
    assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth"), "the page is no wider than its window"
    for each in ("img", "input"):
        assert tab.evaluate(f"{EDGES}('.thumb {each}').right <= {EDGES}('.pictures').right")


def test_a_number_out_of_its_range_stays_as_it_is_typed_and_is_refused_in_a_sentence(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    bring_a_picture(tab, tmp_path)
    strokes, margin = tab.get_by_label("Strokes", exact=True), tab.get_by_label("Margin, mm")
    for typed in ("0", "2.5", "20001"):
        strokes.fill(typed)
        tab.get_by_role("button", name="Plan it").click()
        refusal = f"The number of strokes is {typed}; it must be a whole number from 1 to 20000"
        expect(tab.locator(".q-notification").get_by_text(refusal)).to_be_visible()
        expect(strokes).to_have_value(typed)
    strokes.fill("800")
    strokes.press("ArrowUp")
    expect(strokes).to_have_value("850")
    margin.fill("-3")
    margin.press("Tab")
    expect(tab.locator(".sketch").get_by_text("-3mm")).to_be_visible()
    expect(margin).to_have_value("-3")
