"""Photographs that the browser's own camera takes, and pictures that are pasted, in a real browser."""

import base64
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_plan_page import picture_to_bring

PASTE = """([onto, encoded]) => {
  const bytes = Uint8Array.from(atob(encoded), (letter) => letter.charCodeAt(0));
  const clipboardData = new DataTransfer();
  clipboardData.items.add(new File([bytes], "pasted.png", { type: "image/png" }));
  document.querySelector(onto).dispatchEvent(new ClipboardEvent("paste", { clipboardData, bubbles: true }));
}"""


def encoded(picture: Path) -> str:
    return base64.b64encode(picture.read_bytes()).decode()


def test_a_photograph_is_taken_and_a_picture_is_pasted(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    tab.get_by_role("button", name="Take a photograph").click()
    tab.get_by_role("button", name="Take it").click()
    expect(tab.get_by_role("radio", name="photograph")).to_be_checked()
    expect(tab.get_by_role("dialog")).to_have_count(0)
    with Image.open(studio.folder / "pictures" / "photograph" / "picture.png") as taken:
        assert min(taken.size) >= 120
        assert len(taken.convert("RGB").getcolors(2**24) or []) > 10, "it is what the camera shows, and no black frame"

    tab.evaluate(PASTE, ["body", encoded(picture_to_bring(tmp_path))])
    expect(tab.get_by_role("radio", name="pasted")).to_be_checked()


def test_a_picture_that_comes_with_text_or_under_a_dialog_is_not_pasted(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    picture = encoded(picture_to_bring(tmp_path))
    tab.evaluate(PASTE, ["input[type=number]", picture])
    tab.get_by_role("button", name="Take a photograph").click()
    expect(tab.get_by_role("dialog")).to_be_visible()
    tab.evaluate(PASTE, ["body", picture])
    tab.get_by_role("button", name="Leave it").click()
    expect(tab.get_by_role("dialog")).to_have_count(0)
    tab.evaluate(PASTE, ["input[readonly]", picture])
    expect(tab.get_by_role("radio", name="pasted")).to_be_checked()
    assert [path.name for path in (studio.folder / "pictures").iterdir()] == ["pasted"]


def test_a_camera_that_is_let_in_after_it_was_left_is_switched_off(page: Callable[..., Page]) -> None:
    tab = page("/plan")
    tab.evaluate("""() => {
      const ask = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
      const allowed = new Promise((allow) => { window.allow = allow; });
      navigator.mediaDevices.getUserMedia = async (wanted) => {
        await allowed;
        return window.seen = await ask(wanted);
      };
    }""")
    tab.get_by_role("button", name="Take a photograph").click()
    tab.get_by_role("button", name="Leave it").click()
    expect(tab.get_by_role("dialog")).to_have_count(0)
    tab.evaluate("allow()")
    tab.wait_for_function("window.seen?.getTracks().every((each) => each.readyState === 'ended')")


def test_a_camera_that_is_left_is_switched_off(page: Callable[..., Page]) -> None:
    tab = page("/plan")
    tab.get_by_role("button", name="Take a photograph").click()
    expect(tab.get_by_role("button", name="Take it")).to_be_enabled()
    stream = tab.locator("video").evaluate_handle("(video) => video.srcObject")
    tab.get_by_role("button", name="Leave it").click()
    tab.wait_for_function("(seen) => seen.getTracks().every((each) => each.readyState === 'ended')", arg=stream)


def test_a_browser_without_a_camera_is_told_so(studio: RunningStudio, page: Callable[..., Page]) -> None:
    tab = page("/plan")
    tab.evaluate(
        "() => { navigator.mediaDevices.getUserMedia = async () => { throw new DOMException('', 'NotFoundError'); }; }"
    )
    tab.get_by_role("button", name="Take a photograph").click()
    expect(tab.get_by_text("There is no camera; connect one")).to_be_visible()
    expect(tab.get_by_role("dialog")).to_have_count(0)
