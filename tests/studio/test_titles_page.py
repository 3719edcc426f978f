"""Titles, small cards and the trash, in a browser."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from maulstick.studio.state.titles import retitle
from tests.studio.conftest import RunningStudio
from tests.support.studio.drawings import COMB
from tests.support.studio.plans_to_paint import put_plan, put_plan_of_a_picture

ANNA, EMOJI, PERSIAN = "Dr. Anna's <b>Кот</b>", "हिन्दी 👩‍🎨", "می‌خواهم"


@pytest.fixture(autouse=True)
def plans(tmp_path: Path) -> None:
    """Put three plans into the folder before the studio opens."""
    for name, title in (("one", ANNA), ("two", PERSIAN)):
        folder = put_plan(tmp_path / "studio", name).parent
        (folder / "painting.svg").write_text(COMB)
        (folder / "order").mkdir()
        for number in range(2):
            Image.new("RGB", (60, 40)).save(folder / "order" / f"{number:02}.jpg")
        retitle(folder, title)
    put_plan_of_a_picture(tmp_path / "studio", "three")
    Image.new("RGB", (60, 40)).save(tmp_path / "studio" / "pictures" / "three" / "small.jpg")


def test_a_plan_is_opened_renamed_noted_saved_asked_for_again_thrown_away_and_put_back_after_a_restart(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    mine, theirs = page("/plan"), page("/paint", viewport={"width": 1024, "height": 768})
    expect(mine.get_by_role("article")).to_have_count(1)
    small = mine.get_by_role("button", name=f"Open {ANNA}")
    expect(small.locator("img")).to_have_attribute("loading", "lazy")
    small.focus()
    small.press("Enter")
    card = mine.get_by_role("article", name=f"Plan {ANNA}", exact=True)
    fold = card.get_by_role("button", name=f"Make the card of {ANNA} small")
    expect(fold).to_be_focused()
    expect(card.get_by_label("Stroke by stroke")).to_be_visible()
    expect(card.get_by_text("“lines”")).to_be_visible()  # the words that it was asked for
    fold.press("Enter")
    expect(small).to_be_focused()
    small.press("Enter")

    card.get_by_role("button", name="Files").click()
    with mine.expect_download() as download:
        mine.get_by_text("For a plotter (SVG)").click()
    assert download.value.suggested_filename == "Dr. Anna's -b-Кот-b-painting.svg"
    card.get_by_role("button", name="Rename").click()
    mine.get_by_label("New name").fill(f"  {EMOJI}\u202e ")
    mine.get_by_role("button", name="Rename", exact=True).click()
    card = mine.get_by_role("article", name=f"Plan {EMOJI}", exact=True)
    expect(card).to_be_visible()
    theirs.get_by_label("Plan or drawing", exact=True).click()
    theirs.get_by_role("option", name=EMOJI).click()
    expect(theirs.get_by_label("Plan or drawing", exact=True)).to_have_value(EMOJI)
    card.get_by_label("Compared with").click()
    mine.get_by_role("option", name="three").click()
    other = card.locator(".compare .target")
    expect(other).to_have_attribute("src", re.compile(r"^/picture/plans/three/preview\.png\?\d+$"))
    before = other.get_attribute("src")
    assert before is not None
    (studio.folder / "plans" / "three" / "painting.json").touch()  # as if it was planned on
    expect(card.get_by_label("That plan or this")).to_be_visible()
    card.get_by_label("Your note").fill("the best one")
    card.get_by_role("button", name="Give it a star").click()
    expect(card.get_by_role("button", name="Take the star away")).to_be_visible()
    expect(other).not_to_have_attribute("src", before)

    mine.get_by_role("article", name="Plan three").get_by_role("button", name="Plan again like this").click()
    expect(mine.get_by_label("Strokes", exact=True)).to_have_value("30")
    expect(mine.get_by_label("Width by height")).to_have_value("60x40mm")
    expect(mine.get_by_role("radio", name="three")).to_be_checked()

    card.get_by_role("button", name=f"Throw {EMOJI} away").click()
    expect(mine.get_by_text(f"{EMOJI} is in the trash")).to_be_visible()
    studio.kill()
    put_plan(studio.folder, "one")
    studio.start()
    trash = page("/trash")
    row = trash.get_by_role("listitem", name=EMOJI)
    expect(row.get_by_text(re.compile(r"^Plan · \d+ \w+ \d{4}, \d\d:\d\d$"))).to_be_visible()
    trash.wait_for_function("[...document.querySelectorAll('.thrown img')].every((each) => each.naturalWidth > 10)")
    row.get_by_role("button", name=f"Put {EMOJI} back").click()
    expect(row.get_by_role("alert")).to_have_text(re.compile("^Another one has its name, one, by now"))
    row.get_by_role("button", name=f"Put {EMOJI} back as one-2").click()
    expect(trash.get_by_text("Nothing was thrown away.")).to_be_visible()
    trash.get_by_role("link", name="Plan", exact=True).click()
    expect(trash.get_by_role("article", name=f"Plan {EMOJI}").get_by_label("Your note")).to_have_value("the best one")
    assert (studio.folder / "plans" / "one-2" / "painting.json").is_file()


def test_a_title_that_is_one_long_word_makes_no_page_wider_than_a_phone_and_leaves_undo_within_reach(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    long = "W" * 80
    for name in ("one", "two", "three"):
        retitle(studio.folder / "plans" / name, long)
    tab = page("/plan/one", viewport={"width": 390, "height": 780})
    expect(tab.get_by_role("heading", name=f"Direct {long}")).to_be_visible()
    assert tab.evaluate("document.documentElement.scrollWidth - innerWidth") == 0
    tab.goto(f"{studio.url}/plan")
    card = tab.get_by_role("article")
    expect(card).to_have_count(1)
    card.get_by_role("button", name="Throw ").click()
    undo = tab.get_by_role("button", name="Undo")
    expect(undo).to_be_in_viewport(ratio=1)
    undo.click()
    expect(card).to_have_count(1)
    assert tab.evaluate("document.documentElement.scrollWidth - innerWidth") == 0
