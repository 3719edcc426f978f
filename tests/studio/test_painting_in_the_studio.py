"""Panel where a machine paints, in a real browser."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from maulstick.robot.journal import Journal, journal_of
from tests.studio.conftest import RunningStudio
from tests.support.studio.plans_to_paint import STROKES, put_plan
from tests.support.studio.processes import wait_until_nobody_paints

QUICK = "Simulated easel, as fast as it can"


@pytest.fixture(autouse=True)
def painting(tmp_path: Path) -> Path:
    """Put a plan into the folder before the studio opens."""
    return put_plan(tmp_path / "studio", "lines")


def wait_for_stroke(page: Page, number: int) -> None:
    expect(page.locator(".now")).to_have_text(re.compile(rf"^Stroke ({number}|{number + 1}|{number + 2}) of {STROKES}"))


def outcome(page: Page) -> str:
    """Wait for the outcome, and return its text."""
    expect(page.locator(".outcome")).to_have_text(re.compile("lifted|is painted|It fits"))
    return page.locator(".outcome").inner_text()


def go_on(page: Page) -> None:
    """Go on with the rest, on a quick machine."""
    expect(page.get_by_text("It was begun")).to_be_visible()  # what was asked before is filled in by then
    page.get_by_label("Machine", exact=True).click()
    page.get_by_role("option", name=QUICK).click()
    if page.get_by_text("Is it on the paper?").is_visible():
        page.get_by_role("radio", name="No, paint it again").click()
    page.get_by_role("button", name="Go on where it stopped").click()
    expect(page.locator(".outcome")).to_have_text("lines is painted.")
    expect(page.get_by_text(f"All {STROKES} strokes are painted.")).to_be_visible()


def painted(painting: Path) -> set[int]:
    return Journal.read(journal_of(painting)).painted


def test_two_tabs_show_the_same_machine_and_each_can_stop_it(page: Callable[..., Page], painting: Path) -> None:
    one, other = page("/paint"), page("/paint", color_scheme="dark")
    one.get_by_role("button", name="Check").click()
    assert outcome(other) == f"It fits. {STROKES} strokes, 900 mm, 1 paint, about 1 min."
    one.get_by_label("Machine", exact=True).click()
    one.get_by_role("option", name="AxiDraw").click()
    expect(one.locator(".outcome")).to_be_hidden()  # it was about another machine
    expect(other.locator(".outcome")).to_be_visible()
    one.get_by_label("Machine", exact=True).click()
    one.get_by_role("option", name="Simulated easel, at an arm's pace").click()
    one.get_by_role("button", name="Start painting").click()
    for tab in (one, other):
        wait_for_stroke(tab, 2)
        expect(tab.get_by_alt_text("The sheet as it was last seen")).to_be_visible()
    other.get_by_role("button", name="Pause").click()
    expect(one.locator(".now")).to_contain_text("Paused")
    one.get_by_role("button", name="Go on").click()
    other.get_by_role("button", name="STOP").click()
    assert outcome(one) == outcome(other) == "You stopped it. The pen is lifted."
    assert 0 < len(painted(painting)) < STROKES
    go_on(one)
    expect(other.locator(".outcome")).to_have_text("lines is painted.")
    assert painted(painting) == set(range(STROKES))


def test_what_was_begun_is_said_no_more_once_the_plan_is_gone(page: Callable[..., Page], painting: Path) -> None:
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
        journal.begin(0)
        journal.end(0)
    tab, planning = page("/paint?plan=lines"), page("/plan")
    expect(tab.locator(".begun")).to_have_text(
        f"It was begun: 1 of {STROKES} strokes are painted. So far on the simulated easel: nothing of it is on paper."
    )
    expect(tab.get_by_role("button", name="Go on where it stopped")).to_be_visible()
    tab.get_by_label("Machine", exact=True).click()
    tab.get_by_role("option", name="AxiDraw").click()
    expect(tab.get_by_role("button", name="Start painting")).to_be_visible()  # a rehearsal is nothing on paper
    expect(tab.get_by_role("button", name="Start again on a new sheet")).to_be_hidden()
    planning.get_by_role("button", name="Throw lines away").click()
    expect(tab.get_by_text("There is nothing to paint yet")).to_be_visible()
    expect(tab.locator(".begun")).to_be_hidden()


def test_stop_says_what_it_stopped_and_has_a_second_way_where_no_connection_can_be_had(
    page: Callable[..., Page], painting: Path
) -> None:
    tab = page("/paint?plan=lines")
    heard = tab.locator(".heard")
    tab.get_by_role("button", name="STOP").click()
    expect(heard).to_have_text("Nothing moves: there was nothing to stop.")
    expect(heard).to_have_text("")
    tab.get_by_role("button", name="Start painting").click()
    wait_for_stroke(tab, 1)
    tab.evaluate("() => { window.fetch = () => Promise.reject(new Error('no more connections')); }")
    tab.get_by_role("button", name="STOP").click()
    expect(heard).to_have_text("The machine stops and lifts its pen.")
    assert outcome(tab) == "You stopped it. The pen is lifted."
    assert len(painted(painting)) < STROKES


def test_escape_stops_it_from_any_panel_and_a_killed_studio_goes_on_when_it_is_back(
    page: Callable[..., Page], studio: RunningStudio, painting: Path
) -> None:
    tab, elsewhere = page("/paint?plan=lines"), page("/survey")
    tab.get_by_role("button", name="Start painting").click()
    wait_for_stroke(tab, 1)
    elsewhere.keyboard.press("Escape")
    assert outcome(tab) == "You stopped it. The pen is lifted."
    tab.get_by_role("button", name="Start again on a new sheet").click()
    expect(tab.get_by_text("The sheet so far counts as thrown away.")).to_be_visible()
    tab.get_by_role("button", name="Take a new sheet").click()
    wait_for_stroke(tab, 2)
    studio.kill()
    wait_until_nobody_paints(painting)
    studio.start()
    back = page("/paint")
    expect(back.get_by_text(re.compile(f"It was begun: .* of {STROKES} strokes are painted"))).to_be_visible()
    expect(back.get_by_alt_text("The sheet as it was last seen")).to_be_visible()
    go_on(back)
    assert painted(painting) == set(range(STROKES))
    assert (painting.parent / "painting.run1").is_dir()
