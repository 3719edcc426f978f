"""Paper, the look of another picture, the tubes and the tries of a plan, in a real browser."""

import json
from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_plan_page import card


def test_a_plan_is_asked_for_with_paper_a_look_and_the_tubes_of_the_studio_and_again_like_that(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    (studio.folder / "tubes.csv").write_text("black,#101010\nsand,#c8a46e\nsea,#2a6a8c\n")
    tab = page("/plan")
    tab.get_by_role("button", name="Try an example picture").click()
    expect(tab.get_by_role("radio", name="portrait")).to_be_checked()
    tab.get_by_role("button", name="More: paper, look, tubes, tries").click()
    tab.get_by_label("Colour of the paper").fill("#f0e6d2")
    tab.get_by_label("With the look of").click()
    tab.get_by_role("option", name="portrait").click()
    expect(tab.get_by_role("listbox")).to_have_count(0)
    tab.get_by_role("checkbox", name="Only the paints of your tubes").click()
    tab.get_by_label("Tries, the best one is kept").fill("3")
    tab.get_by_label("Strokes", exact=True).fill("40")
    tab.get_by_role("button", name="Plan it").click()
    plan = card(tab, "Portrait")
    expect(plan).to_be_visible()
    request = json.loads((studio.folder / "plans" / "portrait" / "request.json").read_text())
    options = request["options"]
    assert request["tries"] == 3
    expect(plan.get_by_text("the best of 3 tries")).to_be_visible()
    assert (options["paper"], options["paints_from"]) == ("#f0e6d2", "studio:/tubes.csv")
    assert options["look"] == "studio:/pictures/portrait/picture.png"
    plan.get_by_role("button", name="Do not plan it").or_(plan.get_by_role("button", name="Stop and keep")).click()

    again = page("/plan")
    again.get_by_role("button", name="Plan again like this").click()
    again.get_by_role("button", name="More: paper, look, tubes, tries").click()
    expect(again.get_by_label("Colour of the paper")).to_have_value("#f0e6d2")
    expect(again.get_by_label("With the look of")).to_have_value("Portrait")
    expect(again.get_by_role("checkbox", name="Only the paints of your tubes")).to_be_checked()
    expect(again.get_by_label("Tries, the best one is kept")).to_have_value("3")
