"""Acts on a page that is not connected to its server yet, in a real browser."""

import re
from collections.abc import Callable

from playwright.sync_api import Browser, Page, expect

from tests.studio.conftest import RunningStudio, patient

COUNTS = [str(count) for count in range(101, 161)]

# Connects, and passes on what comes, only once `connect` is called.
LATE = """
  const waiting = [];
  let isLate = true;
  const late = (hear) => (event) => { if (isLate) waiting.push(() => hear(event)); else hear(event); };
  window.connect = () => { isLate = false; for (const each of waiting.splice(0)) each(); };
  window.WebSocket = class extends WebSocket {
    set onopen(hear) { super.onopen = late(hear); }
    set onmessage(hear) { super.onmessage = late(hear); }
  };
"""


def test_what_is_typed_before_a_page_is_connected_comes_in_the_order_in_which_it_was_typed(
    studio: RunningStudio, page: Callable[..., Page], browser: Browser
) -> None:
    early, sent = studio.let_in(patient(browser.new_context())).new_page(), []
    early.on("websocket", lambda socket: socket.on("framesent", lambda frame: sent.append(str(frame))))
    early.add_init_script(LATE)
    early.goto(f"{studio.url}/plan")
    for count in COUNTS:
        early.get_by_label("Strokes", exact=True).fill(count)
    early.evaluate("connect()")
    early.get_by_role("link", name="Mix").click()
    expect(early.get_by_role("heading", level=1)).to_have_text("Mix the paints")
    early.context.close()
    assert re.findall(r'"args":\[?\W*(1\d\d)\b', "".join(sent)) == COUNTS

    later = page("/plan")
    expect(later.get_by_label("Strokes", exact=True)).to_have_value(COUNTS[-1])
