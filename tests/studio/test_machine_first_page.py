"""The machine is asked for first: what it can draw is planned, and drawn, in a browser."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_plan_page import bring_a_picture, card
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import put_plan

PENS = "Simulated easel, pens put in by you"


def choose(page: Page, label: str, name: str | re.Pattern[str]) -> None:
    page.get_by_label(label, exact=True).click()
    page.get_by_role("option", name=name).click()
    expect(page.get_by_role("listbox")).to_have_count(0)


def expect_chosen(page: Page) -> None:
    """Expect what was chosen in the first form, and no text."""
    chosen = {
        "Machine": "AxiDraw",
        "Brush or pen": "marker, held at one pressure: 2.4 mm",
        "Colours": "Ink",
        "Strokes": "12",
        "Sheet": "A5",
        "Outlines": "0.5",
        "What to paint, in words": "",
    }
    for label, value in chosen.items():
        expect(page.get_by_label(label, exact=True)).to_have_value(value)


def kept(studio: RunningStudio) -> str:
    """Return what the studio has written of what was chosen."""
    file = studio.folder / "settings.json"
    return file.read_text() if file.is_file() else ""


def test_from_the_default_form_a_plotter_draws_and_all_that_was_chosen_is_there_again(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    brush = tab.get_by_label("Brush or pen", exact=True)
    expect(brush).to_have_value("round, 0.69 to 16 mm")
    choose(tab, "Machine", "AxiDraw")
    expect(brush).to_have_value("Pen: 0.25 mm black, Sakura Pigma Micron 01")
    expect(tab.get_by_label("Colours", exact=True)).to_have_value("Ink")
    choose(tab, "Machine", "Franka arm")
    expect(brush).to_have_value("round, 0.69 to 16 mm")
    expect(tab.get_by_label("Colours", exact=True)).to_have_value("Paints")
    choose(tab, "Machine", "AxiDraw")
    choose(tab, "Brush or pen", re.compile("^marker, held at one pressure: 2.4 mm$"))
    choose(tab, "Colours", "Ink")
    choose(tab, "How carefully", re.compile("sketch"))
    choose(tab, "Sheet", re.compile("^A5$"))
    tab.get_by_label("Strokes", exact=True).fill("12")
    tab.get_by_label("What to paint, in words").fill("my secret")
    tab.get_by_label("Outlines").fill("0.5")

    other = page("/plan")
    expect_chosen(other)
    while '"edges": 0.5' not in kept(studio):
        other.wait_for_timeout(50)
    studio.kill()
    studio.start()
    tab.goto(studio.url + "/plan")
    expect_chosen(tab)
    assert "secret" not in kept(studio)

    bring_a_picture(tab, tmp_path)
    tab.get_by_role("button", name="Plan it").click()
    expect(card(tab).locator(".phase")).to_have_text("planned")
    expect(card(tab).get_by_text("loops, marker, 12 strokes, one ink, A5, lying, for AxiDraw")).to_be_visible()
    expect(card(tab).get_by_role("list", name="Notes")).to_contain_text("the brush marker is held at one pressure")

    folder = studio.folder / "plans" / "my-sunset"
    tab.goto(studio.url + "/paint?plan=my-sunset")
    expect(tab.get_by_label("Machine", exact=True)).to_have_value("AxiDraw")
    with FakeEbb(pace=100.0) as board:
        port = tab.get_by_label("Port", exact=True)
        port.fill(board.port)
        port.press("Enter")
        shutil.copy(folder / "preview.png", folder / "painting-painted.png")  # of a rehearsal, before
        tab.get_by_role("button", name="Start painting").click()
        expect(
            tab.get_by_text(re.compile(r"^Please put in the marker with paint 1 \(black\); it draws"))
        ).to_be_visible()
        tab.get_by_role("button", name="Done").click()
        expect(tab.locator(".outcome")).to_have_text("My Sunset! is painted.")
        expect(tab.get_by_text("There is no picture of the sheet yet")).to_be_visible()
    assert any(down for _, _, down in board.reached)


def test_pens_are_rehearsed_on_the_easel_in_their_order_and_nothing_has_to_be_mixed(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "six", SIX, mixed=False)
    tab = page("/paint?plan=six")
    first = tab.get_by_text("Mix 2 paints first")
    choose(tab, "Machine", "AxiDraw")
    expect(first).to_be_visible()
    choose(tab, "Machine", PENS)
    expect(first).to_be_hidden()
    tab.get_by_role("button", name="Check").click()
    order = tab.locator(".turns li")
    expect(order).to_have_text(["paint 1 (red): less than 1 min", "paint 2 (blue): less than 1 min"])
    choose(tab, "Machine", "Simulated easel, as fast as it can")
    expect(tab.locator(".turns")).to_be_hidden()  # it was about another machine
    choose(tab, "Machine", PENS)
    tab.get_by_role("button", name="Start painting").click()
    for pen in ("paint 1 (red)", "paint 2 (blue)"):
        expect(tab.get_by_text(f"Please put in the marker with {pen}; it draws for less than 1 min.")).to_be_visible()
        expect(order).to_have_count(2)
        tab.get_by_role("button", name="Done").click()
    expect(tab.locator(".outcome")).to_have_text("six is painted.")
