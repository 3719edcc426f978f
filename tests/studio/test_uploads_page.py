"""Files that come to the studio several at once, or not at all, in a real browser."""

import shutil
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Browser, Page, Route, expect

from tests.studio.conftest import RunningStudio, patient
from tests.studio.test_plan_page import picture_to_bring

_LINES = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40"><path d="M5 5L35 5M5 15L35 15M5 25L35 25"/></svg>'


def test_a_file_that_did_not_arrive_is_said_and_can_be_brought_again(
    studio: RunningStudio, browser: Browser, tmp_path: Path
) -> None:
    context = studio.let_in(patient(browser.new_context()))
    tab, picture = context.new_page(), picture_to_bring(tmp_path)
    tab.goto(f"{studio.url}/plan")

    def bring() -> None:
        with tab.expect_file_chooser() as chooser:
            tab.get_by_role("button", name="Bring a picture").click()
        chooser.value.set_files(picture)

    tab.route("**/upload/*", lambda route: route.abort("connectionreset"), times=1)
    bring()
    expect(tab.get_by_text("That file did not arrive")).to_be_visible()
    bring()
    expect(tab.get_by_role("radio", name=picture.stem)).to_be_checked()
    context.close()


def test_all_files_come_that_are_brought_at_once_and_those_that_cannot_be_read_are_named(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    brought = [tmp_path / f"{name}.png" for name in ("dawn", "noon", "dusk")]
    for each in brought:
        shutil.copy(picture_to_bring(tmp_path), each)
    letter, note = tmp_path / "letter.png", tmp_path / "note.txt"
    for each in (letter, note):
        each.write_text("dear")
    tab = page("/plan")
    for _ in range(2):
        with tab.expect_file_chooser() as chooser:
            tab.get_by_role("button", name="Bring a picture").click()
        chooser.value.set_files([brought[0], letter, *brought[1:], note])
        for name in ("dawn", "noon", "dusk"):
            expect(tab.get_by_role("radio", name=name, exact=True)).to_have_count(1)
        for words in ("letter.png is not a picture", "or of another kind: note.txt"):
            error = tab.locator(".q-notification").filter(has_text=words)
            error.get_by_role("button", name="OK").click()
            expect(error).to_have_count(0)


def test_recordings_that_are_brought_at_once_come_and_each_one_that_is_none_is_told(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    lines = [tmp_path / f"{name}.svg" for name in ("lines", "more")]
    for each in lines:
        each.write_text(_LINES)
    letters = [tmp_path / f"{name}.svg" for name in ("letter", "note")]
    for each in letters:
        each.write_text("dear")
    tab = page("/")
    with tab.expect_file_chooser() as chooser:
        tab.get_by_role("button", name="Bring a recording").click()
    chooser.value.set_files([letters[0], *lines, letters[1]])
    for each in lines:
        expect(tab.get_by_role("article", name=each.stem, exact=True)).to_be_visible()
    for each in letters:
        expect(tab.get_by_role("alert").filter(has_text=each.name)).to_be_visible()


def test_what_is_told_of_a_recording_stays_while_others_of_the_same_choice_still_come(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    lines, letter = tmp_path / "lines.svg", tmp_path / "letter.svg"
    lines.write_text(_LINES)
    letter.write_text("dear")
    tab, late = page("/"), list[Route]()
    tab.route("**/upload/*", lambda route: route.continue_() if late else late.append(route))
    button = tab.get_by_role("button", name="Bring a recording")
    with tab.expect_file_chooser() as chooser:
        button.click()
    chooser.value.set_files([lines, letter])
    said = tab.get_by_role("alert").filter(has_text=letter.name)
    expect(said).to_be_visible()
    late[0].continue_()
    expect(tab.get_by_role("article", name=lines.stem, exact=True)).to_be_visible()
    expect(said).to_be_visible()
    with tab.expect_file_chooser():
        button.click()
    expect(said).to_have_count(0)


def test_nothing_is_planned_from_another_picture_while_one_is_on_its_way(
    page: Callable[..., Page], tmp_path: Path
) -> None:
    tab, late, picture = page("/plan"), list[Route](), picture_to_bring(tmp_path)
    tab.route("**/upload/*", lambda route: late.append(route))
    with tab.expect_file_chooser() as chooser:
        tab.get_by_role("button", name="Bring a picture").click()
    with tab.expect_request("**/upload/*"):
        chooser.value.set_files(picture)
    expect(tab.get_by_text("Reading it …").filter(visible=True)).to_be_visible()
    tab.get_by_role("button", name="Plan it").click()
    expect(tab.get_by_text("A picture is on its way; plan it once it is here")).to_be_visible()
    late[0].continue_()
    expect(tab.get_by_role("radio", name=picture.stem)).to_be_checked()
    expect(tab.get_by_text("Nothing is planned yet.")).to_be_visible()
    tab.get_by_role("button", name="Plan it").click()
    expect(tab.get_by_role("article", name=f"Plan {picture.stem}")).to_be_visible()
