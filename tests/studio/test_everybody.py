"""Panels as everybody meets them: by contrast, keyboard and names (axe-core), and without overlap at three sizes."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio
from tests.support.studio.drawings import BOAT
from tests.support.studio.plans_to_paint import put_plan_of_a_picture

SIZES = [(1024, 768), (1280, 800), (1920, 1080)]

# What a person reads or acts on, and that nothing of its own kind lies within.
OVERLAPS = """() => {
  const wanted = "button, a, input, select, textarea, label, h1, h2, h3, p, li, img, svg, [role=radio], [role=slider]";
  const seen = [...document.querySelectorAll(".panel, header")].flatMap((part) => [...part.querySelectorAll(wanted)])
    .filter((one) => one.checkVisibility({ opacityProperty: true, visibilityProperty: true }))
    .filter((one) => !one.closest(".compare, .stroke-map, .q-field, [aria-hidden=true]"));
  // What is seen of it: a part that scrolls within the page cuts off what lies outside.
  const boxes = seen.map((one) => {
    let { left, top, right, bottom } = one.getBoundingClientRect();
    for (let part = one.parentElement; part; part = part.parentElement) {
      if (!["auto", "scroll", "hidden"].includes(getComputedStyle(part).overflowY)) continue;
      const around = part.getBoundingClientRect();
      [left, right] = [Math.max(left, around.left), Math.min(right, around.right)];
      [top, bottom] = [Math.max(top, around.top), Math.min(bottom, around.bottom)];
    }
    return { left, top, right, bottom };
  });
  const words = (one) => one.innerText || one.getAttribute("aria-label") || one.className;
  const named = (one) => `${one.tagName} ${words(one).slice(0, 40)}`;
  const found = [];
  for (let i = 0; i < seen.length; i++) for (let j = 0; j < i; j++) {
    if (seen[i].contains(seen[j]) || seen[j].contains(seen[i])) continue;
    if (!!seen[i].closest("header") !== !!seen[j].closest("header")) continue;  // the head stays while a panel scrolls
    const [a, b] = [boxes[i], boxes[j]];
    const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
    const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
    if (wide > 2 && high > 2) found.push(`${named(seen[i])} / ${named(seen[j])}`);
  }
  const wider = document.documentElement.scrollWidth - innerWidth;
  return wider > 0 ? [...found, `the page is ${wider} px wider than the window`] : found;
}"""


@pytest.fixture
def coast(tmp_path: Path) -> Path:
    """Put a plan where the studio finds it when it starts; return its painting.json."""
    return put_plan_of_a_picture(tmp_path / "studio", "coast")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_panel_has_a_serious_finding_of_axe_or_things_that_overlap(
    coast: Path, studio: RunningStudio, page: Callable[..., Page], tmp_path: Path, scheme: str
) -> None:
    picture = studio.folder / "pictures" / "coast" / "picture.png"
    shutil.copy(picture, picture.with_name("small.jpg"))
    (tmp_path / "boat.svg").write_text(BOAT)
    opened = page("/paint", color_scheme=scheme, reduced_motion="reduce")
    opened.set_input_files("input[type=file][accept*=svg]", tmp_path / "boat.svg")
    expect(opened.get_by_role("article", name="Drawing boat")).to_be_visible()
    links = opened.get_by_role("navigation", name="Panels").get_by_role("link")
    found: dict[tuple[str, int | str], list[str]] = {}

    def look(panel: str) -> None:
        for width, height in SIZES:
            opened.set_viewport_size({"width": width, "height": height})
            if overlaps := opened.evaluate(OVERLAPS):
                found[panel, width] = overlaps
        found.update({(panel, rule): nodes for rule, nodes in faults_by_axe(opened).items()})

    for number in range(links.count()):
        links.nth(number).click()
        expect(links.nth(number)).to_have_attribute("aria-current", "page")
        opened.wait_for_load_state("networkidle")
        look(opened.title())
    opened.goto(f"{studio.url}/plan/coast")
    expect(opened.locator(".strokes-view")).to_have_attribute("data-sharp", "")
    opened.locator(".strokes-view").press("Control+a")
    expect(opened.get_by_text(re.compile(r"^[0-9]+ strokes: "))).to_be_visible()
    look("directing")
    opened.locator(".strokes-view").press("r")
    expect(opened.locator(".strokes-view")).to_have_class(re.compile("region"))
    box = opened.locator(".strokes-view").bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    opened.mouse.move(*middle)
    opened.mouse.down()
    for across, down in ((80, 0), (80, 80), (0, 80)):
        opened.mouse.move(middle[0] + across, middle[1] + down, steps=3)
    opened.mouse.up()
    expect(opened.get_by_label("Direction of strokes")).to_be_visible()
    look("regions")
    assert found == {}
    links.get_by_text("Plan", exact=True).click()
    expect(opened.get_by_role("img", name="The picture on its sheet")).to_be_visible()  # which moves what is below
    opened.get_by_label("Hand", exact=True).click()
    expect(opened.get_by_role("option", selected=True)).to_be_visible()
    expect(opened.locator(".q-menu")).to_have_css("opacity", "1")  # it fades in
    contrast = {"runOnly": ["color-contrast"]}  # the list itself is Quasar's
    assert _faults(Axe().run(opened, ".q-menu", contrast).response) == {}
    opened.keyboard.press("Escape")
    opened.evaluate("document.querySelector('h1').style.marginBottom = '-3rem'")
    assert len(opened.evaluate(OVERLAPS)) == 1, "what overlaps is seen"


_MOVING = """() => [...document.querySelectorAll("*")].map((each) => getComputedStyle(each))
  .flatMap((style) => [style.transitionDuration, style.animationDuration])
  .filter((each) => Math.max(...each.split(",").map(parseFloat)) > 0.01).length"""


def test_nothing_slides_or_fades_where_little_motion_is_wished_for(page: Callable[..., Page]) -> None:
    still, moving = page("/plan", reduced_motion="reduce"), page("/plan", reduced_motion="no-preference")
    for each in (still, moving):
        each.get_by_label("Hand", exact=True).click()
        expect(each.get_by_role("option", selected=True)).to_be_visible()
    assert (still.evaluate(_MOVING), moving.evaluate(_MOVING) > 0) == (0, True)


def faults_of_dialog(page: Page) -> dict[str, list[str]]:
    """Faults as of `faults_by_axe` in the dialog that is open, but for contrast: axe-core sees the page behind it."""
    return _faults(Axe().run(page, ".q-dialog", {"rules": {"color-contrast": {"enabled": False}}}).response)


def faults_by_axe(page: Page) -> dict[str, list[str]]:
    """Elements that break a rule, and by which check, for each rule whose impact is serious or critical."""
    return _faults(Axe().run(page).response)


def _faults(found: dict[str, Any]) -> dict[str, list[str]]:
    broken = [rule for rule in found["violations"] if rule["impact"] in ("serious", "critical")]
    return {
        rule["id"]: [f"{node['html'][:150]}: {check['message']}" for node in rule["nodes"] for check in node["any"]]
        for rule in broken
    }
