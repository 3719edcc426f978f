"""The way on from plans in ink, of which nothing is mixed, in a real browser."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.support.robot.small_paintings import SIX
from tests.support.studio.plans_to_paint import LINES, put_plan


@pytest.fixture(autouse=True)
def plans(tmp_path: Path) -> None:
    """Put a plan of two paints, one in one ink and one in two into the folder before the studio opens."""
    two = ",".join(paint.hex for paint in SIX.paints)
    pens = SIX.provenance.model_copy(update={"options": {**SIX.provenance.options, "ink": two}})
    in_two = SIX.model_copy(update={"provenance": pens})
    for name, painting, ink in (("pens", in_two, two), ("paints", SIX, None), ("ink", LINES, "#000000")):
        request = put_plan(tmp_path / "studio", name, painting, mixed=ink is None).with_name("request.json")
        plain = json.loads(request.read_text())
        if ink is not None:
            plain["options"] |= {"paints": None, "ink": ink}
            request.write_text(json.dumps(plain))


def test_a_plan_in_one_ink_leads_to_the_machine_and_one_of_paints_to_mixing(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab = page("/plan")
    tab.get_by_role("article", name="Plan ink").get_by_role("button", name="Paint it").click()
    expect(tab.get_by_role("heading", name="Let a machine paint")).to_be_visible()
    expect(tab.get_by_label("Plan or drawing", exact=True)).to_have_value("ink")
    tab.goto(f"{studio.url}/paints?plan=ink")
    expect(tab.get_by_text("Nothing is to be mixed: the machine asks for this one.")).to_be_visible()
    tab.goto(f"{studio.url}/plan")
    tab.get_by_role("button", name="Open paints").click()
    tab.get_by_role("article", name="Plan paints").get_by_role("button", name="Mix and paint").click()
    expect(tab.get_by_role("heading", name="Mix the paints")).to_be_visible()
    expect(tab.get_by_text("Everything is ready to paint.")).to_be_visible()


def test_a_plan_in_several_inks_leads_to_a_machine_that_asks_for_each_pen_and_waits_for_no_mixing(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    tab = page("/plan")
    tab.get_by_role("button", name="Open pens").click()
    tab.get_by_role("article", name="Plan pens").get_by_role("button", name="Paint it").click()
    expect(tab.get_by_label("Plan or drawing", exact=True)).to_have_value("pens")
    expect(tab.get_by_text("Mix 2 paints first")).to_have_count(0)
    tab.goto(f"{studio.url}/paints?plan=pens")
    expect(tab.get_by_text("Nothing is to be mixed: the machine asks for each.")).to_be_visible()
    expect(tab.get_by_text("This one is mixed")).to_have_count(0)
