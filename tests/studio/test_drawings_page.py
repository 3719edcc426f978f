"""Drawings on the panel Paint, in a real browser."""

import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

from maulstick.robot.journal import Journal, journal_of
from tests.studio.conftest import RunningStudio
from tests.studio.test_painting_in_the_studio import QUICK, wait_until_nobody_paints
from tests.support.studio.drawings import BOAT, COMB, ROWS, WITH_TEXT, svg

DROP = """([content, name]) => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([content], name, { type: "image/svg+xml" }));
  document.querySelector(".desk.paint h2").dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true }));
}"""


def bring(page: Page, root: Path, name: str, content: str) -> None:
    (root / name).write_text(content)
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Bring an SVG").click()
    chooser.value.set_files(root / name)


def card(page: Page, name: str) -> Locator:
    return page.get_by_role("article", name=f"Drawing {name}", exact=True)


def choose(page: Page, label: str, option: str) -> None:
    page.get_by_label(label, exact=True).click()
    page.get_by_role("option", name=option, exact=True).click()


def test_a_drawing_is_brought_read_with_hatches_thrown_away_taken_back_and_painted(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    mine, theirs = page("/paint"), page("/paint", color_scheme="dark", viewport={"width": 1024, "height": 600})
    bring(mine, tmp_path, "letter.svg", WITH_TEXT)
    expect(mine.get_by_text("Cannot draw letter.svg: it has text; a pen draws paths")).to_be_visible()
    mine.get_by_role("button", name="OK").click()
    mine.evaluate(DROP, [BOAT, "My Boat.svg"])
    for each in (mine, theirs):
        expect(card(each, "My Boat").get_by_text("60 x 40 mm, 2 paths, 111 mm, 2 pens")).to_be_visible()
        expect(card(each, "My Boat").get_by_role("listitem")).to_have_text(re.compile("^Lines that reach beyond"))
    assert mine.request.get(f"{studio.url}/picture/drawings/my-boat/drawing.svg").status == 404  # it may hold scripts
    shown = mine.get_by_alt_text("My Boat as a pen draws it")
    before = shown.get_attribute("src")
    mine.get_by_role("button", name="How the drawing is read").click()
    choose(mine, "Sheet", "A5, lying")
    mine.get_by_label("Hatching, mm between lines").fill("2")
    for each in (mine, theirs):
        expect(card(each, "My Boat").get_by_text(re.compile(r"^210\sx\s148\smm, .*, 2\spens$"))).to_be_visible()
        expect(card(each, "My Boat").get_by_text("2 paths")).to_be_hidden()
    assert shown.get_attribute("src") != before
    expect(theirs.get_by_label("Sheet", exact=True)).to_have_value("A5, lying")
    mine.get_by_label("Hatching, mm between lines").fill("500")
    mine.get_by_role("button", name="Check").click()
    expect(mine.get_by_text("The distance between hatching lines is 500 mm; it must be").first).to_be_visible()
    mine.get_by_label("Hatching, mm between lines").fill("")
    expect(card(theirs, "My Boat").get_by_text(re.compile(r"^210\sx\s148\smm, 2\spaths"))).to_be_visible()
    card(theirs, "My Boat").get_by_role("button", name="Throw My Boat away").click()
    expect(card(mine, "My Boat")).to_have_count(0)
    theirs.get_by_role("button", name="Undo").click()
    expect(card(mine, "My Boat")).to_be_visible()
    expect(mine.get_by_label("Plan or drawing", exact=True)).to_have_value("My Boat")
    choose(mine, "Machine", QUICK)
    mine.get_by_role("button", name="Start painting").click()
    expect(theirs.locator(".outcome")).to_have_text("My Boat is painted.")
    expect(theirs.get_by_alt_text("The sheet as it was last seen")).to_be_visible()
    expect(mine.get_by_text("All 2 strokes are painted.")).to_be_visible()


def test_ends_that_meet_are_joined_on_the_page_and_a_distance_that_cannot_be_is_told(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    mine, theirs = page("/paint"), page("/paint")
    bring(mine, tmp_path, "comb.svg", COMB)
    expect(card(mine, "comb").get_by_text(re.compile(f", {ROWS}\\spaths"))).to_be_visible()
    mine.get_by_role("button", name="How the drawing is read").click()
    mine.get_by_label("Join ends nearer than, mm").fill("1.1")
    expect(card(theirs, "comb").get_by_text(re.compile(r", 1\spath\b"))).to_be_visible()
    expect(theirs.get_by_label("Join ends nearer than, mm")).to_have_value("1.1")
    mine.get_by_label("Join ends nearer than, mm").fill("30000")
    mine.get_by_role("button", name="Check").click()
    expect(mine.get_by_text("The distance of ends that are joined is 30000 mm; it must be").first).to_be_visible()
    mine.get_by_label("Join ends nearer than, mm").fill("")
    expect(card(theirs, "comb").get_by_text(re.compile(f", {ROWS}\\spaths"))).to_be_visible()


def test_an_outcome_stands_beside_what_it_is_of_or_names_it(page: Callable[..., Page], tmp_path: Path) -> None:
    tab = page("/paint")
    bring(tab, tmp_path, "boat.svg", BOAT)
    choose(tab, "Machine", QUICK)
    tab.get_by_role("button", name="Check").click()
    outcome, order = tab.locator(".outcome"), tab.get_by_role("heading", name="In this order")
    expect(outcome).to_have_text(re.compile(r"^It fits\. 2 strokes"))
    expect(order).to_be_visible()
    bring(tab, tmp_path, "comb.svg", COMB)
    expect(tab.get_by_label("Plan or drawing", exact=True)).to_have_value("comb")
    expect(outcome).to_be_hidden()
    expect(order).to_be_hidden()
    tab.goto(tab.url.partition("?")[0] + "?plan=comb")
    expect(outcome).to_have_text(re.compile(r"^boat: It fits\. 2 strokes"))
    expect(order).to_be_hidden()
    card(tab, "boat").get_by_role("button", name="Paint boat").click()
    expect(outcome).to_be_hidden()


def test_a_drawing_that_is_brought_again_has_pens_of_its_own(page: Callable[..., Page], tmp_path: Path) -> None:
    tab = page("/paint")
    for colour, word in (("#d02020", "red"), ("#2040c0", "blue")):
        pens = (f'<path d="M 5 {y} H 40" fill="none" stroke="{pen}"/>' for y, pen in ((5, "#000"), (15, colour)))
        bring(tab, tmp_path, "pens.svg", svg("".join(pens)))
        expect(card(tab, "pens")).to_be_visible()
        choose(tab, "Machine", "Simulated easel, pens put in by you")
        tab.get_by_role("button", name="Start painting").click()
        expect(tab.locator(".next")).to_have_text(f"Next: paint 2 ({word})")
        tab.get_by_role("button", name="STOP").click()
        card(tab, "pens").get_by_role("button", name="Throw pens away").click()
        expect(card(tab, "pens")).to_have_count(0)


def test_a_drawing_goes_on_after_the_studio_was_killed(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/paint")
    bring(tab, tmp_path, "comb.svg", COMB)
    expect(card(tab, "comb")).to_be_visible()
    tab.get_by_role("button", name="Start painting").click()
    expect(tab.locator(".now")).to_have_text(re.compile(rf"^Stroke [2-9] of {ROWS}"))
    drawing = studio.folder / "drawings" / "comb" / "drawing.svg"
    studio.kill()
    wait_until_nobody_paints(drawing)
    studio.start()
    back = page("/paint")
    expect(back.get_by_text(re.compile(f"It was begun: .* of {ROWS} strokes are painted"))).to_be_visible()
    choose(back, "Machine", QUICK)
    if back.get_by_text("Is it on the paper?").is_visible():
        back.get_by_role("radio", name="No, paint it again").click()
    back.get_by_role("button", name="Go on where it stopped").click()
    expect(back.locator(".outcome")).to_have_text("comb is painted.")
    assert Journal.read(journal_of(drawing)).painted == set(range(ROWS))
