"""Canvas on which a plan is directed, in a browser: from opening it to a version that is planned around an act."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, Route, expect

from maulstick.painting.painting_file import read_painting
from maulstick.robot.journal import Journal, journal_of
from tests.studio.conftest import RunningStudio
from tests.studio.test_zoom_page import pinch
from tests.support.planned import STROKES
from tests.support.studio.plans_to_paint import put_plan_to_direct

_SIDE = 60.0  # mm, of the sheet


def sharp(view: Locator, acts: int) -> None:
    """Wait until the page shows the strokes after so many acts, drawn as vectors."""
    expect(view).to_have_attribute("data-acts", str(acts))
    expect(view).to_have_attribute("data-sharp", "")


def colours_seen(page: Page) -> int:
    """Count the colours on the canvas: where strokes are drawn there are several."""
    return int(
        page.evaluate("""() => {
          const sheet = document.querySelector(".strokes-view canvas");
          const { data } = sheet.getContext("2d").getImageData(0, 0, sheet.width, sheet.height);
          return new Set(new Uint32Array(data.buffer)).size;
        }""")
    )


@pytest.fixture
def coast(tmp_path: Path) -> Path:
    """Put a plan where the studio finds it when it starts, which can be planned again; return its painting.json."""
    return put_plan_to_direct(tmp_path / "studio", "coast")


@pytest.fixture
def begun(coast: Path, tmp_path: Path) -> Path:
    """The same plan, of which ten strokes are painted, and a photograph of its sheet among the pictures."""
    with Journal.open(journal_of(coast)) as journal:
        journal.revise(coast, [stroke.id for stroke in read_painting(coast).strokes[:10]])
    photograph = tmp_path / "studio" / "pictures" / "sheet" / "picture.png"
    photograph.parent.mkdir()
    Image.new("RGB", (48, 48), "white").save(photograph)
    shutil.copy(photograph, photograph.with_name("small.jpg"))
    return coast


def test_strokes_and_places_are_directed_undone_after_a_reload_planned_around_and_painted(
    coast: Path, studio: RunningStudio, page: Callable[..., Page]
) -> None:
    planned = read_painting(coast)
    tab = page("/plan", has_touch=True, viewport={"width": 1280, "height": 800})
    tab.get_by_role("article", name="Plan coast").get_by_role("button", name="Direct it").click()
    view = tab.get_by_role("group", name="The strokes of coast")
    sharp(view, 0)
    assert colours_seen(tab) > 10
    said = tab.locator(".said")
    expect(said).to_have_text(re.compile("^Nothing is chosen"))

    view.focus()
    view.press(".")
    expect(said).to_have_text(re.compile("^1 stroke: #[0-9a-f]{6}, marker$"))
    view.press("Control+a")
    expect(said).to_have_text(re.compile(f"^{STROKES} strokes: #[0-9a-f]{{6}}, marker and #[0-9a-f]{{6}}, marker$"))
    view.press("n")
    expect(said).to_have_text(re.compile("^Nothing is chosen"))

    def at(x: float, y: float) -> tuple[float, float]:
        box = view.bounding_box()  # which moves as the page scrolls
        assert box is not None
        scale = min(box["width"], box["height"]) / _SIDE
        return box["x"] + box["width"] / 2 + scale * (x - _SIDE / 2), box["y"] + box["height"] / 2 + scale * (
            y - _SIDE / 2
        )

    def drag(*places: tuple[float, float]) -> None:
        tab.mouse.move(*at(*places[0]))
        tab.mouse.down()
        for place in places[1:]:
            tab.mouse.move(*at(*place), steps=3)
        tab.mouse.up()

    def take_up(key: str, tool: str) -> None:
        view.focus()
        view.press(key)
        expect(view).to_have_class(re.compile(tool))

    scaled = view.locator(".scale")
    fits = scaled.inner_text()
    pinch(view, *at(30, 30), 40, 160)
    expect(scaled).not_to_have_text(fits)
    view.press("1")
    expect(scaled).to_have_text("100 % of its size")
    view.press("0")
    expect(scaled).to_have_text(fits)
    view.press("m")
    tab.mouse.move(*at(30, 30))
    expect(view.locator(".loupe")).to_be_visible()
    view.press("m")
    expect(view.locator(".loupe")).to_be_hidden()
    sharp(view, 0)

    first = planned.strokes[-1]  # nothing lies over it
    x, y, _ = first.trajectory[0]
    tab.mouse.click(*at(1e3 * x, 1e3 * y))
    expect(said).to_have_text(re.compile("^1 stroke: "))
    view.press("l")
    expect(said).to_have_text(re.compile("; locked$"))
    expect(tab.get_by_role("button", name="Unlock")).to_be_visible()
    sharp(view, 1)
    view.press("Shift+ArrowLeft")
    sharp(view, 2)

    tab.get_by_role("button", name="None", exact=True).click()
    drag((1, 1), (59, 1), (59, 30), (1, 30), (1, 1))
    expect(said).to_have_text(re.compile("^[0-9]+ strokes?: "))
    lassoed = int(said.inner_text().split()[0])
    inside = [
        sum(p[1] < 0.03 for p in s.trajectory) > len(s.trajectory) / 2 for s in planned.strokes if s.id != first.id
    ]
    assert abs(lassoed - sum(inside)) <= 2, "marks lie a little beside what is commanded"
    view.press("Delete")
    sharp(view, 3)
    tab.get_by_role("button", name="Undo").click()
    sharp(view, 4)
    expect(view).to_have_attribute("data-strokes", str(STROKES))
    view.press("Control+z")
    sharp(view, 5)

    tab.reload()
    sharp(view, 5)
    tab.get_by_role("button", name="Redo").click()
    sharp(view, 6)
    tab.get_by_role("button", name="Draw", exact=True).click()
    expect(view).to_have_class(re.compile("draw"))
    drag((5, 5), (20, 8))
    sharp(view, 7)
    expect(view).to_have_attribute("data-strokes", str(STROKES + 1))

    take_up("r", "region")
    drag((5, 5), (35, 5), (35, 38), (5, 38), (5, 5))
    expect(view).to_have_attribute("data-regions", "1")
    expect(tab.get_by_label("Name")).to_have_value("Region")
    tab.get_by_label("Name").fill("Gesicht")
    tab.get_by_label("Name").press("Enter")
    places = tab.get_by_role("list", name="Regions and guides")
    expect(places.get_by_role("button", name="Gesicht", exact=True)).to_have_attribute("aria-pressed", "true")
    tab.get_by_label("Brushes").click()
    tab.get_by_role("option", name=re.compile("^fineliner")).click()
    sharp(view, 10)
    tab.keyboard.press("Escape")
    expect(tab.get_by_role("listbox")).to_have_count(0)  # it takes the focus once more when it closes
    take_up("p", "bare")
    drag((2, 42), (28, 42), (28, 58), (2, 58), (2, 42))
    expect(view).to_have_attribute("data-regions", "2")
    take_up("i", "importance")
    drag((45, 8), (50, 12))
    expect(view).to_have_attribute("data-regions", "3")
    take_up("g", "guide")
    drag((34, 55), (56, 50))
    expect(view).to_have_attribute("data-guides", "1")
    view.press("Delete")
    expect(view).to_have_attribute("data-guides", "0")
    tab.reload()
    sharp(view, 14)
    tab.get_by_role("button", name="Undo").click()
    expect(view).to_have_attribute("data-guides", "1")
    take_up("r", "region")
    tab.mouse.click(*at(20, 20))
    expect(tab.get_by_label("Name")).to_have_value("Gesicht")
    assert read_painting(coast) == planned

    with tab.expect_download() as download:
        tab.get_by_role("button", name="Save this as it is").click()
        tab.get_by_role("dialog").get_by_role("button", name="Save").click()
    assert len(re.findall("<path", download.value.path().read_text())) == STROKES + 1
    tab.get_by_role("button", name="Plan again around this").click()
    card = tab.get_by_role("article", name="Plan coast, version 2")
    expect(card.locator(".phase")).to_have_text(re.compile("^planned$"))
    version = studio.folder / "plans" / "coast-version-2"
    assert '"studio:/plans/coast-version-2/again.json"' in (version / "request.json").read_text(), "it can be moved"
    again = read_painting(version / "painting.json")
    moved = np.array(first.trajectory) - (1e-4, 0, 0)
    kept = {stroke.id: stroke for stroke in again.strokes if stroke.locked}
    assert np.array(kept[first.id].trajectory) == pytest.approx(moved, abs=2e-6)
    assert sorted(stroke.origin for stroke in kept.values()) == ["person", "planned"]
    assert {paint.brush for paint in again.paints} == {"marker", "fineliner"}
    assert {"Gesicht"} < {stroke.region for stroke in again.strokes} <= {"Gesicht", "Important", "rest", None}
    told = "1 stroke drawn, 1 moved; a region “Gesicht”, with fineliner; bare paper “Bare paper”; a region “Important”"
    expect(card.locator(".changes")).to_contain_text(told)
    card.get_by_role("button", name="Direct it").click()
    view = tab.get_by_role("group", name="The strokes of coast, version 2")
    sharp(view, 0)
    expect(view).to_have_attribute("data-regions", "3")
    expect(view).to_have_attribute("data-guides", "1")

    tab.goto(f"{studio.url}/paint?plan=coast-version-2")
    tab.get_by_label("Machine", exact=True).click()
    tab.get_by_role("option", name="Simulated easel, as fast as it can").click()
    tab.get_by_role("button", name="Start painting").click()
    expect(tab.locator(".outcome")).to_have_text("coast, version 2 is painted.")
    assert Journal.read(journal_of(version / "painting.json")).painted == {stroke.id for stroke in again.strokes}


def test_what_is_moved_while_an_act_is_still_on_its_way_is_moved_afterwards(
    coast: Path, studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab = page("/plan/coast")
    view = tab.get_by_role("group", name="The strokes of coast")
    sharp(view, 0)
    view.focus()
    view.press(".")
    expect(view).to_have_attribute("data-chosen", "")
    held: list[Route] = []
    tab.route("**/strokes/coast/1?*", lambda route: held.append(route))
    with tab.expect_request("**/strokes/coast/1?*"):
        view.press("l")
    view.press("ArrowLeft")
    held[0].continue_()
    sharp(view, 2)


def test_the_rest_is_planned_over_a_photograph_of_the_sheet(
    begun: Path, studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab = page("/plan")
    tab.get_by_role("article", name="Plan coast").get_by_role("button", name="Direct it").click()
    tab.get_by_role("button", name="Plan over a photograph").click()
    dialog = tab.get_by_role("dialog", name="A photograph of the sheet")
    expect(dialog.get_by_role("button", name="Plan the rest")).to_be_disabled()
    dialog.get_by_label("Photograph of the sheet").click()
    tab.get_by_role("option", name="sheet").click()
    dialog.get_by_role("button", name="Plan the rest").click()
    card = tab.get_by_role("article", name="Plan coast, version 2")
    expect(card.locator(".phase")).to_have_text(re.compile("^planned$"))
    expect(card.locator(".changes")).to_contain_text("Planned again over a photograph of the sheet.")
    again = read_painting(studio.folder / "plans" / "coast-version-2" / "painting.json")
    assert len(again.strokes) == STROKES - len(Journal.read(journal_of(begun)).painted)
