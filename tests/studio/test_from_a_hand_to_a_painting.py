"""Whole session on the page: draw, learn, plan, mix, paint, with a power cut in the middle, to the end."""

import re
import time
from collections.abc import Callable
from math import cos, pi, sin
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from maulstick.painting.painting_file import read_painting
from maulstick.robot.journal import Journal, journal_of
from maulstick.style.cards import read_card
from tests.studio.conftest import RunningStudio
from tests.studio.test_pen import FORCES, count, pressure
from tests.studio.test_plan_page import bring_a_picture
from tests.support.studio.processes import wait_until_nobody_paints

_PATIENCE = 90_000.0  # milliseconds, for a machine that does much else
_STROKES, _DRAWN = 30, 20


@pytest.fixture
def kind() -> type[RunningStudio]:
    """Start the studio as its users do."""
    return RunningStudio


def curl(number: int) -> list[tuple[float, float]]:
    """Points of a stroke like a comma; each number gives a slightly different one."""
    column, row = number % 5, number // 5
    size, turn = 0.04 + 0.01 * (number % 3), number * 0.7
    return [
        (0.12 + 0.17 * column + size * cos(turn + a) * a / 4, 0.15 + 0.2 * row + 1.4 * size * sin(turn + a) * a / 4)
        for a in (1.3 * pi * step / (len(FORCES) - 1) + 0.5 for step in range(len(FORCES)))
    ]


def lines(journal: Path) -> int:
    return journal.read_text().count('"event": "end"') if journal.is_file() else 0


def test_a_hand_becomes_a_painting_though_the_studio_is_killed_while_the_machine_paints(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page()
    for number in range(_DRAWN):
        pressure(tab, curl(number), FORCES)
    count(tab, f"^{_DRAWN} strokes, enough for a good style$")
    tab.get_by_label("Name of this hand").fill("Änna")
    tab.get_by_role("button", name="Learn this hand").click()
    expect(tab.get_by_role("heading", name="This is how Änna draws")).to_be_visible()
    expect(tab.get_by_text("It was learned from")).to_have_count(0)  # so many are enough, as the page said
    card = read_card(studio.data / "styles" / "anna.json")
    assert (card.name, card.title, card.strokes) == ("anna", "Änna", _DRAWN)

    tab.get_by_role("button", name="Plan a picture with it").click()
    bring_a_picture(tab, tmp_path)
    expect(tab.get_by_label("Hand", exact=True)).to_have_value("Änna")
    tab.get_by_label("Strokes", exact=True).fill(f"{_STROKES}")
    tab.get_by_label("How many", exact=True).fill("3")
    tab.get_by_label("How carefully").click()
    tab.get_by_role("option", name=re.compile("sketch")).click()
    tab.get_by_role("button", name="Plan it").click()
    tab.get_by_role("button", name="Mix and paint").click()
    path = studio.folder / "plans" / "my-sunset" / "painting.json"
    painting = read_painting(path)
    assert {stroke.style.name for stroke in painting.strokes if stroke.style} == {"anna"}

    expect(tab.get_by_role("heading", name="Mix the paints")).to_be_visible()
    tab.goto(studio.url + "/paint?plan=my-sunset")
    tab.get_by_label("Machine", exact=True).click()
    tab.get_by_role("option", name="AxiDraw").click()
    tab.get_by_role("button", name="Start painting").click()
    expect(tab.get_by_text("must be mixed first; tick what is mixed under Mix")).to_be_visible()
    assert not journal_of(path).exists()
    tab.goto(studio.url + "/paints?plan=my-sunset")
    tab.get_by_role("button", name="All are mixed").click()
    expect(tab.locator(".tick [aria-checked=true], .tick[aria-checked=true]")).to_have_count(len(painting.paints))

    tab.goto(studio.url + "/paint?plan=my-sunset")
    tab.get_by_role("button", name="Start painting").click()
    expect(tab.locator(".doing")).to_have_text(re.compile("painting My Sunset!: stroke"))
    until = time.monotonic() + _PATIENCE / 1e3
    while lines(journal_of(path)) < 3 and time.monotonic() < until:
        time.sleep(0.05)
    studio.kill()
    wait_until_nobody_paints(path)  # the machine, alone now, is to stop by itself
    painted = lines(journal_of(path))
    assert 3 <= painted < len(painting.strokes)

    studio.start()
    tab.goto(studio.url + "/paint?plan=my-sunset")
    expect(tab.get_by_text(f"{painted} of {len(painting.strokes)} strokes are painted")).to_be_visible()
    again = tab.get_by_text("No, paint it again")
    if again.is_visible():
        again.click()
    tab.get_by_role("button", name="Go on where it stopped").click()
    expect(tab.get_by_text("My Sunset! is painted.")).to_be_visible()
    with Journal.open(journal_of(path)) as journal:
        assert journal.painted == {stroke.id for stroke in painting.strokes}
    assert path.with_name("painting-painted.png").is_file()
    assert tab.get_by_alt_text("The sheet as it was last seen").evaluate("each => each.naturalWidth") > 100
