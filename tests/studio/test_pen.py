"""Sheet on the page, drawn on in a real browser."""

import json
import re
import time
from collections.abc import Callable, Sequence
from math import pi, sin

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from maulstick.recording.files.ink_files import read_ink_file
from maulstick.strokes.ink import read_ink
from maulstick.studio.workers.drawn_sheet import MOST_OF_A_STROKE
from tests.studio.conftest import RunningStudio
from tests.support.tolerances import PEN_METRES

Opened = Callable[..., Page]

# Pointers that no hand holds cannot be captured, and the drawing must not ask to.
_POINTERS = """() => {
Element.prototype.setPointerCapture = () => {};
window.point = (type, x, y, told = {}, coalesced = []) => {
  const sheet = document.querySelector(".pen canvas"), box = sheet.getBoundingClientRect();
  const at = ([x, y]) => ({ clientX: box.left + x * box.width, clientY: box.top + y * box.height });
  const all = { pointerId: 7, pointerType: "pen", button: 0, buttons: 1, pressure: 0.4, bubbles: true, ...told };
  const parts = coalesced.map((place) => new PointerEvent(type, { ...all, ...at(place) }));
  sheet.dispatchEvent(new PointerEvent(type, { ...all, ...at([x, y]), coalescedEvents: parts }));
};
}"""


def pressure(page: Page, places: Sequence[tuple[float, float]], forces: Sequence[float], kind: str = "pen") -> None:
    """Draw with a stylus through the browser's own input; places are shares of the sheet."""
    box = page.locator(".pen canvas").bounding_box()
    assert box is not None
    devtools = page.context.new_cdp_session(page)
    for number, ((x, y), force) in enumerate(zip(places, forces, strict=True)):
        devtools.send(
            "Input.dispatchMouseEvent",
            {
                "type": "mouseMoved" if number else "mousePressed",
                "x": box["x"] + x * box["width"],
                "y": box["y"] + y * box["height"],
                "button": "left",
                "buttons": 1,
                "clickCount": 0 if number else 1,
                "pointerType": kind,
                "force": force,
                "tiltX": 30,
                "tiltY": -20,
            },
        )
    end = {"type": "mouseReleased", "x": 0, "y": 0, "button": "left", "buttons": 0, "pointerType": kind}
    devtools.send("Input.dispatchMouseEvent", end)


def line(y: float) -> list[tuple[float, float]]:
    return [(0.2 + 0.03 * step, y + 0.05 * sin(step)) for step in range(20)]


_SILENCE = "The studio does not answer; strokes would be lost."
FORCES = [0.1 + 0.8 * sin(pi * step / 19) for step in range(20)]


def count(page: Page, text: str) -> None:
    expect(page.locator(".draw .count")).to_have_text(re.compile(text))


def on_disk(studio: RunningStudio, strokes: int) -> list[list[dict[str, float]]]:
    """Wait until the drawing's file has so many strokes, and return them."""
    until = time.monotonic() + 30
    drawn: list[list[dict[str, float]]] = []
    while time.monotonic() < until:
        for path in studio.folder.glob("hands/my-hand/drawing.json"):
            drawn = json.loads(path.read_text())["strokes"]
        if len(drawn) == strokes:
            break
        time.sleep(0.05)
    assert len(drawn) == strokes
    return drawn


def ink(page: Page) -> int:
    """Count the inked pixels of the sheet."""
    pixels: int = page.evaluate(
        """() => {
          const sheet = document.querySelector(".pen canvas");
          const copy = Object.assign(document.createElement("canvas"), { width: sheet.width, height: sheet.height });
          const context = copy.getContext("2d", { willReadFrequently: true });
          context.drawImage(sheet, 0, 0);
          const data = context.getImageData(0, 0, copy.width, copy.height).data;
          return data.filter((value, index) => index % 4 === 3 && value > 127).length;
        }"""
    )
    return pixels


def inked(page: Page, is_so: Callable[[int], bool]) -> None:
    """Wait until the ink of the sheet satisfies a condition: strokes appear a little after they are counted."""
    until = time.monotonic() + 30
    while not is_so(ink(page)) and time.monotonic() < until:
        page.wait_for_timeout(50)
    assert is_so(ink(page))


def test_strokes_reach_the_ink_with_their_places_pressures_and_tilts(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    count(tab, "An empty sheet")
    for y in (0.2, 0.5, 0.8):
        pressure(tab, line(y), FORCES)
    count(tab, "^3 strokes; 20 make a good style$")
    (_, drawn, _) = on_disk(studio, 3)
    assert [point["pressure"] for point in drawn] == pytest.approx(FORCES, abs=1e-3)
    assert {(point["tiltX"], point["tiltY"]) for point in drawn} == {(30, -20)}
    strokes = read_ink_file(studio.folder / "hands/my-hand/drawing.json")[0].strokes()
    np.testing.assert_allclose(strokes[1][:, 1:3], np.array(line(0.5)) * [0.21, 0.148], atol=PEN_METRES)
    assert (np.diff(strokes[1][:, 0]) >= 0).all()


def test_two_tabs_show_the_same_sheet(page: Opened) -> None:
    one, two = page(), page()
    pressure(one, line(0.3), FORCES)
    pressure(two, line(0.6), FORCES, "mouse")
    for tab in (one, two):
        count(tab, "^2 strokes")
    three = page()
    count(three, "^2 strokes")
    inked(one, lambda pixels: pixels > 1000)
    inked(two, lambda pixels: pixels == ink(one))
    drawn = ink(one)
    for tab in (one, two, three):
        inked(tab, lambda pixels: pixels == drawn)
    two.get_by_role("button", name="Undo", exact=True).click()
    for tab in (one, two, three):
        count(tab, "^1 stroke;")
    for tab in (one, two, three):
        inked(tab, lambda pixels: 0 < pixels < drawn)


def test_strokes_are_undone_redone_and_rubbed_out(page: Opened) -> None:
    tab = page()
    for y in (0.2, 0.5, 0.8):
        pressure(tab, line(y), FORCES)
    count(tab, "^3 strokes")
    tab.keyboard.press("Control+z")
    count(tab, "^2 strokes")
    tab.keyboard.press("Control+Shift+Z")
    count(tab, "^3 strokes")
    rub = tab.get_by_role("button", name="Rub out", exact=True)
    rub.click()
    expect(rub).to_have_attribute("aria-pressed", "true")
    pressure(tab, [(0.5, 0.4), (0.5, 0.6)], [0.5, 0.5])
    count(tab, "^2 strokes")
    pressure(tab, [(0.05, 0.5), (0.1, 0.5)], [0.5, 0.5])  # where nothing is
    tab.keyboard.press("Control+z")
    count(tab, "^3 strokes")
    draw = tab.get_by_role("button", name="Draw", exact=True)
    draw.click()
    expect(draw).to_have_attribute("aria-pressed", "true")
    pressure(tab, line(0.6), FORCES)
    count(tab, "^4 strokes")


def test_keys_undo_nothing_behind_a_dialog(page: Opened) -> None:
    tab = page()
    pressure(tab, line(0.2), FORCES)
    count(tab, "^1 stroke;")
    tab.get_by_role("button", name="New sheet").click()
    expect(tab.get_by_role("dialog", name="A new sheet")).to_be_visible()
    tab.keyboard.press("Control+z")
    tab.keyboard.press("Escape")
    expect(tab.get_by_role("dialog")).to_have_count(0)
    pressure(tab, line(0.5), FORCES)
    count(tab, "^2 strokes")


def test_the_eraser_end_of_a_pen_rubs_out_and_palms_do_not_draw(page: Opened) -> None:
    tab = page()
    tab.evaluate(_POINTERS)
    stroke = """(told) => {
      point("pointerdown", 0.3, 0.3, told);
      for (let x = 0.3; x < 0.7; x += 0.02) point("pointermove", x, 0.3, told);
      point(told.ends ?? "pointerup", 0.7, 0.3, told);
    }"""
    tab.evaluate(stroke, {"pointerType": "touch"})
    count(tab, "^1 stroke;")  # a finger draws as long as no pen was seen
    tab.evaluate(stroke, {})
    count(tab, "^2 strokes")
    tab.evaluate(stroke, {"pointerType": "touch"})
    tab.evaluate(stroke, {"ends": "pointercancel"})
    tab.evaluate(stroke, {"button": 2, "buttons": 2})
    tab.evaluate(stroke, {})
    count(tab, "^3 strokes")
    tab.evaluate(stroke, {"button": 5, "buttons": 32})
    count(tab, "An empty sheet")
    inked(tab, lambda pixels: pixels == 0)


def test_two_fingers_undo_three_redo_and_the_sheet_fills_the_screen(page: Opened) -> None:
    tab = page()
    tap = """(fingers) => {
      for (const type of ["pointerdown", "pointerup"])
        for (let finger = 0; finger < fingers; finger++)
          point(type, 0.3 + finger / 10, 0.5, { pointerType: "touch", pointerId: 20 + finger });
    }"""
    pressure(tab, line(0.2), FORCES)
    pressure(tab, line(0.4), FORCES)
    count(tab, "^2 strokes")
    tab.evaluate(_POINTERS)
    tab.evaluate(tap, 2)
    count(tab, "^1 stroke;")
    tab.evaluate(tap, 2)
    count(tab, "An empty sheet")
    tab.evaluate(tap, 3)
    count(tab, "^1 stroke;")
    tab.evaluate(tap, 1)
    count(tab, "^1 stroke;")  # a palm, since there is a pen

    sheet, stop = tab.locator(".pen canvas"), tab.get_by_role("button", name="STOP")
    before = sheet.bounding_box()
    tab.get_by_role("button", name="Full screen").click()
    expect(tab.get_by_label("Name of this hand")).to_be_hidden()
    after = sheet.bounding_box()
    assert before is not None
    assert after is not None
    assert after["width"] > before["width"]
    expect(stop).to_be_in_viewport()
    tab.get_by_role("button", name="Full screen").click()
    expect(tab.get_by_label("Name of this hand")).to_be_visible()


def test_two_fingers_undo_where_a_finger_draws_and_leave_no_dot(page: Opened) -> None:
    tab = page()
    tab.evaluate(_POINTERS)
    touch = {"pointerType": "touch", "pointerId": 1}
    for type, x in (("pointerdown", 0.2), ("pointermove", 0.4), ("pointermove", 0.6), ("pointerup", 0.6)):
        tab.evaluate("([type, x, told]) => point(type, x, 0.3, told)", [type, x, touch])
    count(tab, "^1 stroke;")
    for type in ("pointerdown", "pointerup"):
        for finger in (1, 2):
            told = {**touch, "pointerId": finger}
            tab.evaluate("([type, x, told]) => point(type, x, 0.6, told)", [type, 0.2 + finger / 10, told])
    count(tab, "An empty sheet")


def test_a_stroke_ends_at_the_longest_and_at_the_edge(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    tab.evaluate(_POINTERS)
    tab.evaluate(
        """() => {
          point("pointerdown", 0.5, 0.5);
          const around = (_, i) => [0.5 + 0.4 * Math.sin(i / 99), 0.5 + 0.4 * Math.cos(i / 70)];
          const places = Array.from({ length: 60000 }, around);
          point("pointermove", 0.5, 0.5, {}, places);
          point("pointerup", 0.5, 0.5);
          point("pointerdown", 0.9, 0.5);
          for (const x of [0.95, 0.99, 1.05, 0.9, 0.8]) point("pointermove", x, 0.5);
          point("pointerup", 0.8, 0.5);
        }"""
    )
    count(tab, "^2 strokes")
    assert [len(stroke) for stroke in on_disk(studio, 2)] == [MOST_OF_A_STROKE, 3]
    again = page()
    count(again, "^2 strokes")
    drawn = ink(tab)
    inked(again, lambda pixels: pixels == drawn)


def test_a_stroke_that_is_refused_vanishes_and_the_reason_stands_beside_the_sheet_until_the_next(page: Opened) -> None:
    tab, other = page(), page()
    tab.evaluate(_POINTERS)
    stroke = """(pressure) => {
      point("pointerdown", 0.2, 0.2, { pressure });
      point("pointermove", 0.5, 0.5, { pressure });
      point("pointerup", 0.5, 0.5);
    }"""
    tab.evaluate(stroke, 1.5)
    trouble = tab.locator(".draw .trouble")
    expect(trouble).to_have_text("pressure of a point of a stroke is 1.5; it must be from 0 to 1")
    count(tab, "An empty sheet")
    inked(tab, lambda pixels: pixels == 0)
    assert tab.locator(".q-notification").count() == 0, "it would lie on the sheet"
    pressure(other, line(0.3), FORCES)
    count(tab, "^1 stroke;")
    expect(trouble).to_be_visible()
    tab.evaluate(stroke, 0.5)
    count(tab, "^2 strokes")
    expect(trouble).to_be_hidden()
    expect(other.locator(".draw .trouble")).to_be_hidden()


def test_the_drawing_survives_a_killed_server(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    pressure(tab, line(0.3), FORCES)
    pressure(tab, line(0.6), FORCES)
    drawn = on_disk(studio, 2)
    before = ink(tab)
    studio.kill()
    warning = tab.get_by_text(_SILENCE)
    expect(warning).to_be_visible()
    pressure(tab, line(0.8), FORCES)
    assert ink(tab) == before, "it could not be kept"
    studio.start()
    expect(warning).to_have_count(0)
    count(tab, "^2 strokes")
    inked(tab, lambda pixels: pixels == before)
    pressure(tab, line(0.8), FORCES)
    assert on_disk(studio, 3)[:2] == drawn


def test_the_pen_draws_again_when_a_broken_line_is_mended(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    count(tab, "An empty sheet")
    tab.evaluate("window.isTheSamePage = true")
    tab.evaluate("window.socket.io.engine.close()")
    expect(tab.get_by_text(_SILENCE)).to_be_visible()
    expect(tab.get_by_text(_SILENCE)).to_have_count(0)
    pressure(tab, line(0.3), FORCES)
    count(tab, "^1 stroke;")
    on_disk(studio, 1)
    assert tab.evaluate("window.isTheSamePage")


def test_what_is_drawn_before_a_silence_is_noticed_is_kept_once_and_what_is_rubbed_out_stays_away(
    studio: RunningStudio, page: Opened
) -> None:
    tab = page()
    pressure(tab, line(0.2), FORCES)
    pressure(tab, line(0.9), FORCES)
    first = on_disk(studio, 2)[:1]
    tab.evaluate("window.isTheSamePage = true")
    tab.evaluate("window.socket.io.engine.transport.ws.send = () => {}")
    for y in (0.4, 0.6, 0.8):
        pressure(tab, line(y), FORCES)
    tab.evaluate(_POINTERS)
    tab.evaluate("""() => {
      const eraser = { button: 5, buttons: 32 };
      point("pointerdown", 0.5, 0.75, eraser);
      for (let y = 0.75; y < 0.95; y += 0.02) point("pointermove", 0.5, y, eraser);
      point("pointerup", 0.5, 0.95, eraser);
    }""")
    before = ink(tab)
    tab.evaluate("window.socket.io.engine.close()")
    count(tab, "^3 strokes")
    assert on_disk(studio, 3)[:1] == first
    assert ink(tab) == before
    assert tab.evaluate("window.isTheSamePage")


def test_a_stroke_that_comes_twice_is_drawn_once(studio: RunningStudio, page: Opened) -> None:
    """What was said to the page about it was lost."""
    tab = page()
    tab.evaluate("""() => {
      const { emit } = window.socket;
      window.socket.emit = (...message) => emit.apply(window.socket, message) && emit.apply(window.socket, message);
    }""")
    pressure(tab, line(0.2), FORCES)
    pressure(tab, line(0.6), FORCES)
    count(tab, "^2 strokes")
    assert len(on_disk(studio, 2)) == 2
    expect(tab.get_by_text("is on the sheet already")).to_have_count(0)


def test_a_hand_is_drawn_and_learned_and_put_away(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    learn = tab.get_by_role("button", name="Learn this hand")
    learn.click()
    trouble = tab.locator(".draw .trouble")
    expect(trouble).to_contain_text("there is nothing on the sheet yet")
    pressure(tab, line(0.1), FORCES)
    expect(trouble).to_be_hidden()
    learn.click()
    expect(trouble).to_have_text("draw at least 5 strokes; there is 1")
    assert tab.locator(".q-notification").count() == 0, "it would lie on the sheet"
    for number in range(1, 6):
        pressure(tab, line(0.1 + 0.13 * number), FORCES)
    count(tab, "^6 strokes")
    name = tab.get_by_label("Name of this hand")
    name.fill("Cat <b>")
    name.press("Enter")
    expect(name).to_have_value("Cat <b>")
    learn.click()
    sheet = tab.get_by_role("img", name="in the style Cat <b>")
    expect(sheet).to_be_visible(timeout=60_000)
    assert sheet.evaluate("(image) => image.decode().then(() => image.naturalWidth)") > 500
    dialog = tab.get_by_role("dialog", name="This is how Cat <b> draws")
    few = dialog.get_by_text("It was learned from 6 strokes: it repeats them")
    expect(few).to_be_visible()
    dialog.get_by_role("button", name="Close", exact=True).click()
    assert len(read_ink(studio.folder / "hands/cat-b/hand.ink.npz")) == 6
    tab.get_by_role("button", name="New sheet").click()
    tab.get_by_role("dialog", name="A new sheet").get_by_role("button", name="Take it").click()
    count(tab, "An empty sheet")
    card = tab.get_by_role("article", name="Cat <b>")
    expect(card).to_contain_text("6 strokes, with pressure")
    card.get_by_role("button", name="Learn", exact=True).click()
    expect(few).to_be_visible()
    dialog.get_by_role("button", name="Close", exact=True).click()
    card.get_by_role("button", name="Throw Cat <b> away").click()
    expect(card).to_have_count(0)
    tab.get_by_role("button", name="Undo").last.click()
    card.get_by_role("button", name="Draw on").click()
    count(tab, "^6 strokes")
    inked(tab, lambda pixels: pixels > 0)


def test_a_recording_is_brought_and_a_broken_one_refused(studio: RunningStudio, page: Opened) -> None:
    tab = page()
    chooser = tab.locator("input[type=file]")
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="50mm" height="50mm"><path d="M1 1L40 9"/></svg>'
    chooser.set_input_files({"name": "../<b>fox.svg", "mimeType": "image/svg+xml", "buffer": svg})
    card = tab.get_by_role("article", name="<b>fox")
    expect(card).to_contain_text("1 stroke, without pressure")
    assert card.get_by_role("button", name="Draw on").count() == 0
    chooser.set_input_files({"name": "fox.csv", "mimeType": "text/csv", "buffer": b"Format Version,1.23\n"})
    expect(tab.get_by_text("needs the pen's length")).to_be_visible()
    assert [path.name for path in studio.folder.glob("hands/*")] == ["b-fox"]
    assert list(studio.folder.glob(".incoming-*")) == []


def test_a_size_of_ones_own_needs_both_numbers(page: Opened) -> None:
    tab = page()
    tab.get_by_role("button", name="New sheet").click()
    dialog = tab.get_by_role("dialog", name="A new sheet")
    dialog.get_by_label("Size").click()
    tab.get_by_role("option", name="a size of your own").click()
    dialog.get_by_label("Width, mm").fill("")
    dialog.get_by_role("button", name="Take it").click()
    expect(tab.get_by_text("The width or the height of the sheet is missing; write both")).to_be_visible()
    dialog.get_by_label("Width, mm").fill("90")
    dialog.get_by_role("button", name="Take it").click()
    expect(tab.get_by_role("img", name="A sheet of paper, 90 by 150 millimetres")).to_be_visible()
