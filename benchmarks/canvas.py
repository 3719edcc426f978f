"""How smoothly the studio's canvas moves with 10,000 strokes of 32 points: one JSON object per line.

    .venv/bin/python benchmarks/canvas.py

In headless Chromium without a GPU, 1280 x 800 pixels. milliseconds: the median; most: what 95 % stay below.
name: `opened`: from the address to the first sharp picture of all strokes.
`frame`: from one frame to the next while the view is dragged at twice the size that fits, and zoomed by the wheel.
`crisp`: from the last movement to all strokes in sight as vectors: almost all of them (`times` 1.02 what fits), or
    fewer, nearer.
`chosen`: from a click on a stroke to its picture as chosen.
`locked`: from the key that locks it to the picture with its mark.
load: of the machine's cores in the last minute, when the row was measured; above 1, others were at work.
"""

import argparse
import json
import os
import shutil
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from playwright.sync_api import Page, sync_playwright

from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.studio.conftest import RunningStudio
from tests.support.studio.plans_to_paint import put_plan

STROKES, POINTS, PAINTS, RUNS = 10_000, 32, 12, 9
SHEET = (0.2, 0.16)  # metres
MARGIN = 0.02  # metres, so that no stroke leaves the sheet
SHARP = ".strokes-view[data-sharp]"

# Moves the view at each frame, as a pointer would; returns milliseconds from frame to frame.
FRAMES = """async (kind) => {
  const view = document.querySelector(".strokes-view");
  const box = view.getBoundingClientRect();
  const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
  const frame = () => new Promise((next) => requestAnimationFrame(next));
  const point = (name, u, v) => view.dispatchEvent(
    new PointerEvent(name, { clientX: u, clientY: v, pointerId: 1, button: 1, bubbles: true }));
  view.setPointerCapture = () => {};
  const times = [];
  let before = await frame();
  if (kind === "drag") point("pointerdown", x, y);
  for (let i = 1; i <= 180; i++) {
    if (kind === "drag") point("pointermove", x + 200 * Math.sin(i / 12), y + 150 * Math.sin(i / 9));
    else view.dispatchEvent(
      new WheelEvent("wheel", { clientX: x, clientY: y, deltaY: i % 60 < 30 ? -60 : 60, cancelable: true }));
    const now = await frame();
    times.push(now - before);
    before = now;
  }
  if (kind === "drag") point("pointerup", x, y);
  return times;
}"""

# Zooms by the wheel so far, and returns milliseconds until all in sight is sharp.
CRISP = """async (times) => {
  const view = document.querySelector(".strokes-view");
  const box = view.getBoundingClientRect();
  const frame = () => new Promise((next) => requestAnimationFrame(next));
  const began = performance.now();
  const middle = { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2 };
  view.dispatchEvent(new WheelEvent("wheel", { ...middle, deltaY: -Math.log(times) / 0.0015, cancelable: true }));
  do await frame(); while (!view.hasAttribute("data-sharp"));
  return performance.now() - began;
}"""


def painting() -> Painting:
    """Return curves of so many strokes all over a sheet, in 12 paints of a round brush."""
    rng, brush, along = np.random.default_rng(0), load_brush("round"), np.linspace(0, 1, POINTS)
    strokes = []
    for number in range(STROKES):
        begins = rng.uniform(MARGIN, np.array(SHEET) - MARGIN)
        angle = rng.uniform(0, 2 * np.pi) + rng.normal(0, 2) * along
        steps = rng.uniform(0.003, 0.015) / POINTS * np.column_stack([np.cos(angle), np.sin(angle)])
        points = np.column_stack([begins + steps.cumsum(axis=0), 0.02 + 0.06 * np.sin(np.pi * along)])
        trajectory = tuple(map(tuple, points.tolist()))
        strokes.append(Stroke(id=number, paint=number * PAINTS // STROKES, trajectory=trajectory))
    return Painting(
        sheet=Sheet(width=SHEET[0], height=SHEET[1]),
        provenance=Provenance(version="1"),
        brushes={brush.name: brush},
        paints=tuple(Paint(colour=tuple(rng.uniform(0, 1, 3).tolist()), brush=brush.name) for _ in range(PAINTS)),
        strokes=tuple(strokes),
    )


def tell(name: str, milliseconds: list[float], **more: object) -> None:
    load = round(os.getloadavg()[0] / (os.cpu_count() or 1), 2)
    figures = {
        "milliseconds": round(float(np.median(milliseconds))),
        "most": round(float(np.percentile(milliseconds, 95))),
    }
    print(json.dumps({"name": name, **more, **figures, "runs": len(milliseconds), "load": load}), flush=True)


def open_canvas(page: Page, address: str) -> float:
    began = time.perf_counter()
    page.goto(address)
    page.wait_for_selector(".strokes-view[data-strokes]", timeout=60_000)
    page.wait_for_selector(SHARP, timeout=60_000)
    return 1e3 * (time.perf_counter() - began)


def rest(page: Page) -> None:
    page.keyboard.press("0")
    page.wait_for_selector(SHARP)
    page.wait_for_timeout(500)  # the picture of the whole sheet is drawn, too


def frames(page: Page) -> None:
    for kind in ("drag", "wheel"):
        rest(page)
        for _ in range(3):
            page.keyboard.press("+")
        page.wait_for_timeout(500)
        tell("frame", page.evaluate(FRAMES, kind), kind=kind)


def crisp(page: Page) -> None:
    for times in (1.02, 2.0, 8.0):
        seen = []
        for _ in range(RUNS):
            rest(page)
            seen.append(page.evaluate(CRISP, times))
        tell("crisp", seen, times=times)


def acts(page: Page) -> None:
    view = page.locator(".strokes-view")
    box = view.bounding_box()
    assert box is not None
    chosen, locked = [], []
    for number in range(RUNS):
        page.keyboard.press("n")
        page.wait_for_function("!document.querySelector('.strokes-view').dataset.chosen")
        began = time.perf_counter()
        page.mouse.click(box["x"] + box["width"] / 2 + 11 * number, box["y"] + box["height"] / 2)
        page.wait_for_selector(".strokes-view[data-chosen]")
        chosen.append(1e3 * (time.perf_counter() - began))
        acts = view.get_attribute("data-acts")
        began = time.perf_counter()
        page.keyboard.press("l")
        page.wait_for_selector(f".strokes-view[data-sharp]:not([data-acts='{acts}'])")
        locked.append(1e3 * (time.perf_counter() - began))
    tell("chosen", chosen)
    tell("locked", locked)


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    chromium = shutil.which("chromium")
    with TemporaryDirectory() as root, sync_playwright() as playwright:
        put_plan(Path(root) / "studio", "many", painting())
        studio = RunningStudio(Path(root))
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        page = studio.let_in(browser.new_context(viewport={"width": 1280, "height": 800})).new_page()
        tell("opened", [open_canvas(page, f"{studio.url}/plan/many") for _ in range(3)])
        page.locator(".strokes-view").focus()
        frames(page)
        crisp(page)
        rest(page)
        acts(page)
        browser.close()
        studio.close()
