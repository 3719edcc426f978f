"""Ways in, in a browser: the page that leads on to the link, and the picture of it for a tablet's camera."""

from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import pytest
from playwright.sync_api import Browser, Page, expect

from maulstick.studio.server.link import page_that_leads_to
from tests.studio.conftest import RunningStudio, patient


@pytest.fixture
def abroad(tmp_path: Path) -> Iterator[RunningStudio]:
    running = RunningStudio(tmp_path, "--host", "0.0.0.0")
    try:
        yield running
    finally:
        running.close()


def test_a_file_leads_into_the_studio_and_stop_works_there(
    studio: RunningStudio, browser: Browser, tmp_path: Path
) -> None:
    tab = patient(browser.new_context()).new_page()
    with page_that_leads_to(studio.link, tmp_path) as file:
        tab.goto(file)
        expect(tab.get_by_role("heading", level=1)).to_be_visible()
    assert tab.url == f"{studio.url}/"
    tab.get_by_role("button", name="STOP").click()
    expect(tab.get_by_text("Nothing moves: there was nothing to stop.")).to_be_visible()
    other = tab.context.new_page()
    other.goto(f"{studio.url}/styles")  # as from a bookmark
    expect(other.get_by_role("heading", level=1)).to_be_visible()
    tab.context.close()


def test_a_studio_of_this_computer_alone_says_how_a_tablet_can_come_in(
    page: Callable[..., Page], studio: RunningStudio
) -> None:
    shown = page()
    shown.get_by_role("button", name="On a tablet").click()
    dialog = shown.get_by_role("dialog")
    expect(dialog).to_contain_text("Only this computer can open the studio now")
    expect(dialog).to_contain_text(f"maulstick studio {studio.folder} --host 0.0.0.0")
    assert studio.token not in shown.content()
    dialog.get_by_role("button", name="Close").click()
    expect(dialog).to_be_hidden()


def test_a_tablet_reads_the_link_from_the_page(abroad: RunningStudio, browser: Browser) -> None:
    here = abroad.link.replace(abroad.url, f"http://127.0.0.1:{abroad.port}")
    tab = patient(browser.new_context()).new_page()
    tab.goto(here)
    tab.get_by_role("button", name="On a tablet").click()
    picture = tab.get_by_role("img", name="The link")
    expect(picture).to_be_visible()
    expect(tab.get_by_role("dialog")).to_contain_text(abroad.link)
    picture.screenshot(path=abroad.folder / "seen.png")
    read, _, _ = cv2.QRCodeDetector().detectAndDecode(cv2.imread(str(abroad.folder / "seen.png")))
    assert read == abroad.link
    tab.context.close()
