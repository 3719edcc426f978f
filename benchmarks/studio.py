"""How quick the studio's page is, by itself and while a plan is made: one JSON object per line.

    .venv/bin/python benchmarks/studio.py

name: `start`: from the command to the link.
`page`: from its address to a page with its panel built and its socket open, a browser that has never seen it; `again`:
    the same browser once more.
`answer`: from a request for a panel's address to the end of the server's answer, and its size in `bytes`.
`stop`: from a click on STOP to the server's answer.
`first_picture`: from a plan that is asked for to the first picture of it, 400 strokes; `ready` is whether its panel was
    open for ten seconds before, so that a process waits for it.
`busy` is whether a picture of 1,000 strokes is planned meanwhile, `plans` how many finished ones are there. seconds:
    the median of so many `runs`; worst: the longest of them.
"""

import argparse
import asyncio
import json
import re
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from urllib.request import Request, urlopen

from playwright.sync_api import Browser, Page, expect, sync_playwright

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest, demo_picture
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.plans import Plans

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.studio.conftest import RunningStudio
from tests.support.studio.plans_to_paint import put_plan

RUNS = 9
PLANS, CURVE = 20, 200  # finished plans, and points of the loss curve of each
READY = 10.0  # seconds
PANELS = ("/", "/styles", "/plan", "/paints", "/paint", "/survey")


def tell(name: str, seconds: list[float], **more: object) -> None:
    row = {"name": name, **more, "seconds": round(median(seconds), 3), "worst": round(max(seconds), 3)}
    print(json.dumps({**row, "runs": len(seconds)}), flush=True)


def timed(act: Callable[[], object]) -> float:
    began = time.perf_counter()
    act()
    return time.perf_counter() - began


def shown(page: Page, address: str) -> float:
    def come() -> None:
        page.goto(address)
        page.wait_for_selector(".panel h1")
        page.wait_for_function("window.socket && window.socket.connected")

    return timed(come)


def pages(studio: RunningStudio, browser: Browser, busy: bool, plans: int = 0) -> None:
    for panel in PANELS:
        first, again = [], []
        for _ in range(RUNS):
            context = studio.let_in(browser.new_context())
            page = context.new_page()
            first.append(shown(page, studio.url + panel))
            again.append(shown(page, studio.url + panel))
            context.close()
        tell("page", first, panel=panel, busy=busy, plans=plans)
        tell("again", again, panel=panel, busy=busy, plans=plans)


def answers(studio: RunningStudio, plans: int) -> None:
    for panel in PANELS:
        seconds, size = [], 0
        for _ in range(RUNS):
            began = time.perf_counter()
            size = len(urlopen(Request(studio.url + panel, headers={"Cookie": "=".join(studio.cookie)})).read())
            seconds.append(time.perf_counter() - began)
        tell("answer", seconds, panel=panel, plans=plans, bytes=size)


def stops(studio: RunningStudio, browser: Browser, busy: bool) -> None:
    page = studio.let_in(browser.new_context()).new_page()
    shown(page, studio.url)

    def stop() -> None:
        with page.expect_response(re.compile("/stop$")):
            page.get_by_role("button", name="STOP").click()

    tell("stop", [timed(stop) for _ in range(RUNS)], busy=busy)
    page.close()


def first_pictures() -> None:
    for ready in (False, True):
        tell("first_picture", [asyncio.run(first_picture(ready=ready)) for _ in range(RUNS)], ready=ready)


async def first_picture(*, ready: bool) -> float:
    with TemporaryDirectory() as root, Folder.opened(Path(root) / "studio") as folder:
        plans = Plans(folder)
        if ready:
            plans.be_ready()
            await asyncio.sleep(READY)
        started = time.perf_counter()
        plan = plans.add(PlanRequest(demo_picture(), PlanOptions()))
        while not plan.seen:
            await asyncio.sleep(0.01)
        took = time.perf_counter() - started
        plans.close()
        return took


def finish_plans(root: Path) -> None:
    """Put finished plans into the folder of a studio, each with a loss curve of two terms."""
    curve = [[step / CURVE, {"tone": 1 / (step + 1), "edges": 0.5 / (step + 1)}] for step in range(CURVE)]
    for number in range(PLANS):
        folder = put_plan(root, f"plan-{number + 1}").parent
        story = {"metrics": ["30 strokes"], "curve": curve, "notes": []}
        (folder / "story.json").write_text(json.dumps(story))


@contextmanager
def planning(studio: RunningStudio, browser: Browser) -> Iterator[None]:
    page = studio.let_in(browser.new_context()).new_page()
    page.goto(f"{studio.url}/plan")
    page.get_by_role("button", name="Try an example picture").click()
    expect(page.get_by_role("radio", name="portrait")).to_be_visible(timeout=60_000)
    page.get_by_label("Strokes", exact=True).fill("1000")
    page.get_by_label("How carefully").click()
    page.get_by_role("option", name=re.compile("Fine")).click()
    page.get_by_role("button", name="Plan it").click()
    expect(page.locator(".plan .compare img").first).to_have_attribute("src", re.compile("/live/"), timeout=60_000)
    page.close()
    yield


if __name__ == "__main__":
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    first_pictures()
    chromium = shutil.which("chromium")
    with TemporaryDirectory() as root, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        began = time.perf_counter()
        studio = RunningStudio(Path(root))
        tell("start", [time.perf_counter() - began])
        shown(browser.new_page(), studio.link)  # the first of all also loads the browser
        answers(studio, plans=0)
        pages(studio, browser, busy=False)
        stops(studio, browser, busy=False)
        with planning(studio, browser):
            pages(studio, browser, busy=True)
            stops(studio, browser, busy=True)
        studio.close()
        finish_plans(Path(root) / "many" / "studio")
        studio = RunningStudio(Path(root) / "many")
        shown(browser.new_page(), studio.link)
        answers(studio, plans=PLANS)
        pages(studio, browser, busy=False, plans=PLANS)
        studio.close()
        browser.close()
