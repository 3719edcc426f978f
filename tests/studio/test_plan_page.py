"""Panel where paintings are planned, in a browser."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Locator, Page, Route, expect

from tests.studio.conftest import RunningStudio


def picture_to_bring(root: Path) -> Path:
    x, y = np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 1, 48))
    colours = (np.stack([x, y, (x - 0.5) ** 2 + (y - 0.5) ** 2 < 0.1], axis=2) * 255).astype(np.uint8)
    Image.fromarray(colours).save(path := root / "My Sunset!.png")
    return path


def bring_a_picture(page: Page, root: Path) -> None:
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(picture_to_bring(root))
    expect(page.get_by_role("radio", name="My Sunset!")).to_be_checked()


def ask_for_little(page: Page) -> None:
    page.get_by_label("Strokes", exact=True).fill("25")
    page.get_by_label("How many", exact=True).fill("3")
    page.get_by_label("Sheet").click()
    page.get_by_role("option", name="A5", exact=True).click()


def card(page: Page, name: str = "My Sunset!") -> Locator:
    return page.get_by_role("article", name=f"Plan {name}", exact=True)


def test_a_picture_is_planned_before_all_eyes_stopped_kept_thrown_away_and_taken_back(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    mine, theirs = page("/plan"), page("/plan", color_scheme="dark", viewport={"width": 1024, "height": 600})
    expect(mine.get_by_text("Nothing is planned yet")).to_be_visible()
    mine.get_by_role("button", name="Plan it").click()
    expect(mine.get_by_text("there is nothing to paint yet; bring a picture, or say in words")).to_be_visible()
    bring_a_picture(mine, tmp_path)
    ask_for_little(mine)
    mine.get_by_label("How carefully").click()
    mine.get_by_role("option", name=re.compile("Fine")).click()
    mine.get_by_role("button", name="Plan it").click()
    for each in (mine, theirs):
        expect(card(each).locator(".compare img").first).to_have_attribute("src", re.compile("/live/my-sunset/[1-9]"))
        expect(each.locator(".doing")).to_have_text("planning My Sunset!")
    card(theirs).get_by_role("button", name="What matters").click()
    outlines = card(theirs).get_by_label("Outlines")
    outlines.focus()
    for _ in range(4):
        outlines.press("ArrowRight")
    expect(card(mine).locator("figcaption")).to_contain_text("Outlines")
    card(theirs).get_by_role("button", name="Stop and keep").click()
    expect(card(mine).locator(".phase")).to_have_text("stopped early")
    expect(card(mine).get_by_text(re.compile("^25 strokes, "))).to_be_visible()

    shown = card(mine).locator(".compare img").first
    expect(shown).to_have_attribute("src", re.compile("preview.png"))
    order = card(mine).get_by_label("Stroke by stroke")
    order.focus()
    for _ in range(30):
        order.press("ArrowLeft")
    expect(shown).to_have_attribute("src", re.compile("/order/00.jpg"))
    card(mine).get_by_label("Picture or plan").fill("40")
    assert card(mine).locator(".compare").evaluate("each => each.style.getPropertyValue('--split')") == "40%"
    mine.wait_for_function("[...document.querySelectorAll('.compare img')].every((each) => each.naturalWidth > 100)")

    card(mine).get_by_role("button", name="Throw My Sunset! away").click()
    for each in (mine, theirs):
        expect(card(each)).to_have_count(0)
    mine.get_by_role("button", name="Undo").click()
    for each in (mine, theirs):
        expect(card(each)).to_be_visible()
    theirs.reload()
    expect(card(theirs).get_by_text(re.compile("^25 strokes, "))).to_be_visible()
    with mine.expect_download() as download:
        card(mine).get_by_role("button", name="Files").click()
        mine.get_by_text("For a plotter (SVG)").click()
    assert download.value.suggested_filename == "My Sunset!-painting.svg"
    assert b"<svg" in download.value.path().read_bytes()


def test_a_wish_that_cannot_be_is_refused_in_a_sentence(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    opened = page("/plan")
    (tmp_path / "letter.png").write_text("dear")
    with opened.expect_file_chooser() as chooser:
        opened.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(tmp_path / "letter.png")
    expect(opened.get_by_text(re.compile("^letter.png is not a picture that can be read"))).to_be_visible()
    assert list((studio.folder / "pictures").iterdir()) == []
    assert [path.name for path in studio.folder.iterdir() if path.name.startswith(".incoming")] == []
    held: list[Route] = []
    opened.route("**/upload/*", lambda route: held.append(route))
    with opened.expect_file_chooser() as chooser:
        opened.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(picture_to_bring(tmp_path))
    expect(opened.get_by_text("Reading it …").filter(visible=True)).to_be_visible()
    expect(opened.get_by_role("button", name="Bring a picture")).to_be_disabled()
    held[0].continue_()
    opened.unroute("**/upload/*")
    expect(opened.get_by_role("radio", name="My Sunset!")).to_be_checked()
    expect(opened.get_by_text("Reading it …").filter(visible=True)).to_have_count(0)
    both = opened.get_by_text("They count beside the picture")
    expect(both).to_be_hidden()
    opened.get_by_label("What to paint, in words").fill("a boat at dusk")
    expect(both).to_be_visible()
    opened.get_by_role("radio", name="No picture").check()
    expect(both).to_be_hidden()
    opened.get_by_role("radio", name="My Sunset!").check()
    opened.get_by_label("What to paint, in words").fill("")
    opened.get_by_label("Light and dark").fill("0")
    opened.get_by_role("button", name="Plan it").click()
    expect(opened.get_by_text("nothing matters any more")).to_be_visible()
    opened.get_by_label("Light and dark").fill("1")
    opened.get_by_label("Strokes", exact=True).fill("")
    opened.get_by_role("button", name="Plan it").click()
    expect(opened.get_by_text("the number of strokes is nothing; it must be a whole number from 1 to")).to_be_visible()


def test_choices_that_open_over_the_frame_can_be_clicked(page: Callable[..., Page]) -> None:
    opened = page("/plan")
    opened.set_viewport_size({"width": 1280, "height": 520})
    hand = opened.get_by_label("Hand", exact=True)
    hand.evaluate("field => field.closest('.q-field').scrollIntoView({ block: 'center' })")
    hand.click()
    hand.evaluate("field => scrollBy(0, field.getBoundingClientRect().top - 300)")
    free = opened.get_by_role("option", name="free")
    expect(free).to_be_in_viewport()
    free.click()
    expect(opened.get_by_role("listbox")).to_have_count(0)


def test_a_drawing_in_one_ink_can_be_asked_for_as_on_the_command_line_and_its_notes_stay_with_it(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    opened = page("/plan?style=elephant")
    drawing, strokes = opened.get_by_label("What it draws"), opened.get_by_label("Strokes", exact=True)
    enough = opened.get_by_role("checkbox", name="As many strokes as the picture needs")
    arranged = opened.get_by_label("As the hand arranges")

    def choose(label: str, name: str) -> None:
        opened.get_by_label(label, exact=True).click()
        opened.get_by_role("option", name=name).click()
        expect(opened.get_by_role("listbox")).to_have_count(0)

    choose("Colours", "Ink")
    expect(arranged).to_be_visible()
    expect(drawing).to_be_hidden()  # there is no picture that has lines
    bring_a_picture(opened, tmp_path)
    choose("What it draws", "Lines alone")
    choose("Hand", "loops")
    expect(arranged).to_be_hidden()
    choose("Hand", "free")
    expect(enough).to_be_hidden()
    choose("Hand", "elephant")
    expect(arranged).to_be_visible()
    expect(opened.get_by_text("darks stay pale")).to_be_visible()
    enough.click()
    expect(strokes).to_be_disabled()
    expect(opened.get_by_text("darks stay pale")).to_be_hidden()
    choose("Colours", "Paints")
    for each in (drawing, enough, arranged):
        expect(each).to_be_hidden()
    expect(strokes).to_be_enabled()
    choose("Colours", "Ink")
    expect(strokes).to_be_disabled()

    opened.get_by_label("Hand size").fill("")
    opened.get_by_role("button", name="Plan it").click()
    expect(opened.get_by_text("hand size is nothing; it must be a number of times")).to_be_visible()
    opened.get_by_label("Hand size").fill("0.001")
    opened.get_by_role("button", name="Plan it").click()
    expect(opened.get_by_text("hand size is 0.001; it must be from 0.02 to 50")).to_be_visible()
    opened.get_by_label("Hand size").fill("0.4")
    arranged.press("ArrowLeft")
    choose("Brush or pen", "fineliner")
    choose("How carefully", "Fine, and slowly")
    opened.get_by_role("button", name="Plan it").click()
    notes = card(opened).get_by_role("list", name="Notes")
    expect(notes).to_contain_text("strokes, chosen for the picture's ink")
    asked = (
        "elephant at 0.4 times its size, fineliner, as many strokes as it needs, one ink, 200 by 160 mm, lines alone"
    )
    expect(card(opened).get_by_text(f"{asked}, 75% as the hand arranges")).to_be_visible()
    options = json.loads((studio.folder / "plans" / "my-sunset" / "request.json").read_bytes())["options"]
    wanted = {"strokes": "auto", "hand_size": 0.4, "drawing": "lines", "arrange": 0.75, "ink": "#000000"}
    assert {name: options[name] for name in wanted} == wanted

    card(opened).get_by_role("button", name="Stop and keep").click()
    expect(card(opened).locator(".phase")).to_have_text("stopped early")
    expect(notes).to_contain_text("strokes, chosen for the picture's ink")
    opened.reload()
    expect(notes).to_contain_text("strokes, chosen for the picture's ink")
