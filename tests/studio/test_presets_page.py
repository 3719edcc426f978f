"""Settings that are kept, chosen again and shared as a file, in a real browser."""

import base64
import json
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.studio.test_machine_first_page import choose
from tests.studio.test_plan_page import bring_a_picture

_DROP = """([base64, name]) => {
  const files = new DataTransfer();
  files.items.add(new File([Uint8Array.from(atob(base64), (each) => each.charCodeAt(0))], name));
  document.querySelector(".desk").dispatchEvent(
    new DragEvent("drop", { dataTransfer: files, bubbles: true, cancelable: true }));
}"""


_HOLD = """() => {
  const send = WebSocket.prototype.send, held = [], pong = "3";
  WebSocket.prototype.send = function (words) {
    if (words === pong) send.call(this, words);
    else held.push(() => send.call(this, words));
  };
  window.letGo = () => {
    WebSocket.prototype.send = send;
    for (const each of held) each();
  };
}"""
"""Holds what the page says until it is let go, so that files overtake what is said of them, as on a busy machine."""


def drop(page: Page, content: bytes, name: str) -> None:
    page.evaluate(_DROP, [base64.b64encode(content).decode(), name])


def expect_ink_on_a5(page: Page) -> None:
    for label, value in {"Machine": "AxiDraw", "Colours": "Ink", "Sheet": "A5", "Outlines": "0.5"}.items():
        expect(page.get_by_label(label, exact=True)).to_have_value(value)


def test_settings_are_kept_chosen_again_saved_as_a_file_and_loaded_where_what_they_name_is_not(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    tab = page("/plan")
    bring_a_picture(tab, tmp_path)
    choose(tab, "Machine", "AxiDraw")
    choose(tab, "Sheet", "A5")
    tab.get_by_label("Outlines", exact=True).fill("0.5")
    tab.get_by_role("button", name="Kept settings").click()
    keep = tab.get_by_role("button", name="Keep", exact=True)
    keep.click()
    expect(tab.get_by_text("these settings have no name yet; write one", exact=False)).to_be_visible()
    tab.get_by_label("Name for these settings").fill("Ink <b>安娜</b>")
    keep.click()
    with tab.expect_download() as download:
        tab.get_by_role("button", name="Save these settings as a file").click()
    assert download.value.suggested_filename == "Ink -b-安娜-b.json"
    written = download.value.path().read_bytes()
    assert "sunset" not in written.decode().lower()

    other = page("/plan")
    choose(other, "Machine", "Franka arm")
    choose(other, "Sheet", "A3")
    other.get_by_label("What to paint, in words").fill("a boat")
    other.get_by_label("Outlines", exact=True).fill("2")
    other.get_by_role("button", name="Kept settings").click()
    other.get_by_role("button", name="Ink <b>安娜</b>", exact=True).click()
    expect(other.get_by_text("The form is set as in Ink <b>安娜</b>.")).to_be_visible()
    expect_ink_on_a5(other)
    expect(other.get_by_label("What to paint, in words")).to_have_value("a boat")

    plain = json.loads(written)
    plain["settings"] |= {"style": "somebody", "brush": "sable", "strokes": 77, "unmixed": True}
    choose(other, "Machine", "Franka arm")
    expect(other.get_by_label("Colours", exact=True)).to_have_value("Paints")
    other.evaluate(_HOLD)
    drop(other, json.dumps(plain).encode(), "Theirs.JSON")
    expect(
        other.get_by_text(
            "This studio has no hand “somebody” and no brush or pen “sable” for that machine and no tubes of paint; "
            "all else is set."
        )
    ).to_be_visible()
    expect_ink_on_a5(other)
    expect(other.get_by_label("Strokes", exact=True)).to_have_value("77")
    expect(other.get_by_label("Hand", exact=True)).to_have_value("loops")
    other.evaluate("letGo()")
    choose(other, "Turned", "Lying")
    expect(other.get_by_label("Turned", exact=True)).to_have_value("Lying")  # so all is heard, and no button waits
    with other.expect_file_chooser() as chooser:
        other.get_by_role("button", name="Load settings from a file").click()
    (tmp_path / "other.json").write_text('{"strokes": 3}')
    chooser.value.set_files(tmp_path / "other.json")
    expect(other.get_by_text("Other.json holds no settings of a plan: format: Field required")).to_be_visible()
    drop(other, (tmp_path / "My Sunset!.png").read_bytes(), "dawn.png")
    expect(other.get_by_role("radio", name="dawn")).to_be_checked()

    other.get_by_role("button", name="Throw the settings Ink <b>安娜</b> away").click()
    expect(tab.get_by_role("button", name="Ink <b>安娜</b>", exact=True)).to_have_count(0)
    tab.goto(studio.url + "/trash")
    tab.get_by_role("button", name="Put Ink <b>安娜</b> back").click()
    expect(other.get_by_role("button", name="Ink <b>安娜</b>", exact=True)).to_be_visible()
