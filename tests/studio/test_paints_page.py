"""Panel of paints in a browser: a tick is seen on all pages, and a restart keeps it."""

from collections.abc import Callable

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_mixing import BLUE, BLUE_FIRST, RED
from tests.support.studio.plans_to_paint import put_plan


def test_a_tick_is_seen_in_another_browser_and_after_a_restart(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "cat", BLUE_FIRST, mixed=False)
    mine, theirs = page("/paints?plan=cat"), page("/paints?plan=cat")
    for shown in (mine, theirs):
        expect(shown.get_by_text("0 of 2 are mixed.")).to_be_visible()
    first, second = (mine.get_by_role("article", name=f"Paint {number}") for number in (1, 2))
    expect(first).to_contain_text(RED)
    expect(first).to_contain_text("0.0 m in 1 stroke · comes 2nd")
    expect(second).to_contain_text("comes first, taken up 2 times")
    expect(second).to_contain_text("Goes into the pen holder when the machine asks for it.")

    first.get_by_role("checkbox", name="This one is mixed").focus()
    mine.keyboard.press("Space")
    expect(theirs.get_by_text("1 of 2 are mixed.")).to_be_visible()
    expect(theirs.get_by_role("article", name="Paint 1").get_by_role("checkbox")).to_be_checked()
    theirs.get_by_role("button", name="All are mixed").click()
    expect(mine.get_by_text("Everything is ready to paint.")).to_be_visible()
    theirs.get_by_role("button", name="Paint it now").click()
    expect(theirs.get_by_role("heading", name="Let a machine paint")).to_be_visible()
    expect(theirs.get_by_label("Plan or drawing", exact=True)).to_have_value("cat")

    studio.kill()
    studio.start()
    again = page("/paints")
    expect(again.get_by_text("Everything is ready to paint.")).to_be_visible()
    expect(again.get_by_role("article", name="Paint 2")).to_contain_text(BLUE)


def test_tubes_are_changed_in_a_small_table_and_recipes_follow(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "cat", BLUE_FIRST, mixed=False)
    shown = page("/paints")
    shown.get_by_role("button", name="Change").click()
    table = shown.get_by_role("dialog", name="Your tubes")
    expect(table.get_by_label("Name")).to_have_count(12)
    for left in range(11, 0, -1):
        table.get_by_role("button", name="Remove ").first.click()
        expect(table.get_by_label("Name")).to_have_count(left)
    table.get_by_label("Colour").fill("#0000ff")
    table.get_by_label("Name").fill("")
    table.get_by_role("button", name="Keep these").click()
    expect(shown.get_by_text("the list of tubes, line 2: the name must have 1 to 80 printable")).to_be_visible()
    table.get_by_label("Name").fill("<b>my blue</b>")
    table.get_by_role("button", name="Add a tube").click()
    table.get_by_role("button", name="Keep these").click()
    tubes = shown.get_by_role("region", name="Your tubes").get_by_role("listitem")
    expect(tubes).to_have_count(1)
    expect(tubes).to_have_text("<b>my blue</b>")
    expect(shown.get_by_role("article", name="Paint 2")).to_contain_text("<b>my blue</b> alone")
    assert (studio.folder / "tubes.csv").read_text() == "name,colour\n<b>my blue</b>,#0000ff\n"


def test_tubes_that_cannot_be_read_are_said_and_replaced_in_the_table(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "cat", BLUE_FIRST, mixed=False)
    (studio.folder / "tubes.csv").write_text("name,colour\number,brownish\n")
    shown = page("/paints")
    tubes = shown.get_by_role("region", name="Your tubes")
    expect(tubes).to_contain_text("tubes.csv, line 2: 'brownish' is not a colour")
    tubes.get_by_role("button", name="Change").click()
    table = shown.get_by_role("dialog", name="Your tubes")
    expect(table.get_by_label("Name")).to_have_count(0)
    table.get_by_role("button", name="The usual dozen").click()
    table.get_by_role("button", name="Keep these").click()
    expect(tubes.get_by_role("listitem")).to_have_count(12)
    expect(shown.get_by_role("article", name="Paint 2")).to_contain_text("this gives")


def test_a_plan_in_one_ink_has_nothing_to_tick_since_the_machine_asks_for_its_pen(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    put_plan(studio.folder, "line", mixed=False)
    shown = page("/paints")
    expect(shown.get_by_text("Nothing is to be mixed: the machine asks for this one.")).to_be_visible()
    expect(shown.get_by_text("Goes into the pen holder when the machine asks for it.")).to_be_visible()
    expect(shown.get_by_role("checkbox")).to_have_count(0)


def test_without_a_plan_one_is_told_where_paints_come_from(page: Callable[..., Page]) -> None:
    shown = page("/paints")
    expect(shown.get_by_text("No painting is planned yet.")).to_be_visible()
    shown.get_by_role("button", name="Plan a painting").click()
    expect(shown.get_by_label("Hand", exact=True)).to_be_visible()
