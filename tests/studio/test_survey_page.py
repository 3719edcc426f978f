"""Survey from the panel that builds it, with two participants, to its tables."""

from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Browser, Page, expect

from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import Match, SurveyHand, build
from tests.studio.conftest import RunningStudio, patient


@pytest.fixture
def brought(tmp_path: Path) -> list[Path]:
    """Make photographs of drawings: by Ann, by Bo, and by the machine in the style of each."""
    files = [tmp_path / f"{name}.png" for name in ("Ann", "Bo", "as Ann", "as Bo")]
    for number, file in enumerate(files):
        Image.new("RGB", (60, 40), (60 * number, 90, 120)).save(file)
    return files


def choose(shown: Page, group: str, label: str, drawing: str) -> None:
    row = shown.get_by_role("group", name=group)
    row.get_by_label(label).click()
    shown.get_by_role("option", name=drawing, exact=True).click()
    expect(row.locator(".choice").filter(has=shown.get_by_label(label)).locator("img")).to_have_count(1)
    if shown.get_by_role("listbox").count():  # where several can be chosen, it stays open
        shown.keyboard.press("Escape")
        expect(shown.get_by_role("listbox")).to_have_count(0)


def test_a_survey_is_built_answered_by_two_and_told(
    studio: RunningStudio, browser: Browser, page: Callable[..., Page], brought: list[Path]
) -> None:
    shown = page("/survey")
    for file, name in zip(brought, ("Ann", "Bo", "as Ann", "as Bo"), strict=True):
        shown.locator("input[type=file]").set_input_files(file)
        expect(shown.get_by_text(f"{name} can be chosen now.")).to_be_visible()
    shown.get_by_label("What is it called?").fill("Whose <strokes>?")
    for number, (name, drawn) in enumerate((("<b>Ann</b>", "Ann"), ("Bo", "Bo")), start=1):
        shown.get_by_role("group", name=f"Hand {number}").get_by_label("Name").fill(name)
        choose(shown, f"Hand {number}", "Drawn by this person", f"{drawn} (picture)")
        choose(shown, f"Hand {number}", "By the machine", f"as {drawn} (picture)")
    shown.get_by_role("button", name="Make the survey").click()

    shown.get_by_label("How many people?").fill("")
    shown.get_by_role("button", name="Make their links").click()
    expect(shown.get_by_text("The number of people is nothing; it must be a whole number from 1 to")).to_be_visible()
    shown.get_by_label("How many people?").fill("2")
    shown.get_by_role("button", name="Make their links").click()
    links = [shown.get_by_role("textbox", name=f"Link {number}").input_value() for number in (1, 2)]
    expect(shown.get_by_text("Nobody has answered yet.")).to_be_visible()
    for link in links:
        assert link.startswith(f"{studio.url}/survey/whose-strokes/")
        theirs = patient(browser.new_context()).new_page()
        theirs.goto(link)
        theirs.get_by_role("button", name="Begin").click()
        theirs.get_by_role("radio", name="Drawing A").check()
        theirs.get_by_role("button", name="Finish").click()
        expect(theirs.get_by_role("heading", name="Thank you!")).to_be_visible()
        theirs.context.close()

    expect(shown.get_by_text("2 links · 2 have begun · 2 have finished")).to_be_visible()
    taken = shown.get_by_role("table", name="For whose hand they were taken")
    expect(taken.get_by_role("columnheader")).to_have_text(["drawn by", "<b>Ann</b>", "Bo"])
    expect(shown.get_by_role("row", name="all hands")).to_contain_text("of 2")
    counts = [int(cell.split()[0]) for cell in taken.locator("td").all_inner_texts() if cell != "-"]
    assert sum(counts) == 2
    with shown.expect_download() as download:
        shown.get_by_role("button", name="All answers as CSV").click()
    assert len(download.value.path().read_text().splitlines()) == 3

    shown.get_by_role("button", name="Throw away").click()
    expect(shown.get_by_text("There is none yet.")).to_be_visible()
    shown.get_by_role("button", name="Undo").click()
    shown.get_by_role("button", name="Whose <strokes>?").click()
    expect(shown.get_by_text("2 links · 2 have begun · 2 have finished")).to_be_visible()


def test_links_are_copied_or_saved_where_a_browser_lets_the_page_copy_nothing(
    studio: RunningStudio, page: Callable[..., Page], brought: list[Path]
) -> None:
    ann, bo, as_ann, as_bo = brought
    hands = (
        SurveyHand(name="Ann", by_hand=ann, by_machine=(as_ann,)),
        SurveyHand(name="Bo", by_hand=bo, by_machine=(as_bo,)),
    )
    build(folder := studio.folder / "surveys" / "whose", "Whose?", Match(hands=hands), None)
    tokens = Answers(folder).mint(2)
    links = "\n".join(f"{studio.url}/survey/whose/{token}" for token in tokens)
    shown = page("/survey", permissions=["clipboard-read", "clipboard-write"])
    shown.get_by_role("button", name="Copy all links").click()
    expect(shown.get_by_text("Copied, one per line: 2.")).to_be_visible()
    assert shown.evaluate("navigator.clipboard.readText()") == links

    shown.evaluate("Object.defineProperty(navigator, 'clipboard', { value: undefined })")  # as over plain HTTP
    with shown.expect_download() as download:
        shown.get_by_role("button", name="Copy all links").click()
    assert (download.value.suggested_filename, download.value.path().read_text()) == ("links.txt", links)
    expect(shown.get_by_text("saved as links.txt instead")).to_be_visible()

    shown.get_by_label("How many people?").fill("3")
    shown.get_by_role("button", name="Make their links").dblclick()
    expect(shown.get_by_text("5 links · 0 have begun")).to_be_visible()
    expect(shown.get_by_role("button", name="Make their links")).to_be_enabled()
    assert len(Answers(folder).participants()) == 5, "a double click makes them once"


def test_what_was_put_together_stays_while_one_looks_at_other_panels(page: Callable[..., Page]) -> None:
    shown = page("/survey")
    shown.get_by_label("What people are asked").click()
    shown.get_by_role("option", name="In whose hand is this drawing?").click()
    expect(shown.get_by_text("People see a drawing by the machine beside a whole drawing by each")).to_be_visible()
    shown.get_by_role("button", name="Another hand").click()
    shown.get_by_role("group", name="Hand 3").get_by_label("Name").fill("Cy")
    shown.get_by_label("First look, as in: loops").fill("loops")
    shown.get_by_label("Second look, as in: lines").fill("lines")
    expect(shown.get_by_label("In lines")).to_be_visible()
    shown.get_by_role("link", name="Mix").click()
    expect(shown.get_by_role("heading", name="Mix the paints")).to_be_visible()
    shown.get_by_role("link", name="Survey").click()
    expect(shown.get_by_role("group", name="Hand 3").get_by_label("Name")).to_have_value("Cy")
    expect(shown.get_by_label("What people are asked")).to_have_value("In whose hand is this drawing?")
    expect(shown.get_by_label("In loops")).to_be_visible()
    expect(shown.get_by_label("In lines")).to_be_visible()
    expect(shown.get_by_text("Something in Maulstick is broken")).to_have_count(0)
