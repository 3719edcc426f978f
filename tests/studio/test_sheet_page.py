"""Sheet and corrections of a picture in the form of the panel Plan, in a browser."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from maulstick.storage.arrays import Pixels
from tests.studio.conftest import RunningStudio
from tests.studio.test_plan_page import card

_WHITE = 250  # of 255: paper, in a JPEG


def bring(page: Page, path: Path) -> None:
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Bring a picture").click()
    chooser.value.set_files(path)
    expect(page.get_by_role("radio", name=path.stem)).to_be_checked()


def target_of(page: Page, folder: Path) -> Pixels:
    """Wait until a plan begins; return its picture as it lies on the sheet, and stop it."""
    shown = card(page, folder.name.replace("-", " "))
    expect(shown.locator(".compare .target")).to_have_attribute("src", re.compile("target.jpg"))
    shown.get_by_role("button", name="Stop and keep").click()
    with Image.open(folder / "target.jpg") as target:
        return np.asarray(target)


def test_a_standing_photograph_gets_a_standing_sheet_without_bars_and_is_planned_as_it_is_corrected(
    studio: RunningStudio, page: Callable[..., Page], tmp_path: Path
) -> None:
    opened = page("/plan", reduced_motion="reduce")  # what still unfolds moves away beneath the mouse
    Image.new("RGB", (240, 320), (90, 60, 30)).save(tmp_path / "standing.png")
    bring(opened, tmp_path / "standing.png")
    told = opened.locator(".sketch .hint")
    expect(told).to_have_text("A sheet of 160 by 200 mm. 6% of the picture is cut off, half of it above, half below.")
    opened.get_by_label("How carefully").click()
    opened.get_by_role("option", name=re.compile("Fine")).click()
    opened.get_by_role("button", name="Plan it").click()
    plans = studio.folder / "plans"
    target = target_of(opened, plans / "standing")
    assert target.shape[0] / target.shape[1] == pytest.approx(200 / 160, abs=0.01)
    assert target.max() < _WHITE
    expect(card(opened, "standing").get_by_text("160 by 200 mm")).to_be_visible()

    opened.get_by_text("Correct the picture").click()
    opened.get_by_role("button", name="Turn right").click()
    expect(told).to_contain_text("A sheet of 200 by 160 mm.")
    right = opened.get_by_label("Right edge")
    right.focus()
    for _ in range(3):
        right.press("ArrowLeft")
    opened.get_by_label("Darker or lighter").fill("1")
    opened.get_by_label("Sheet").click()
    opened.get_by_role("option", name="Another size").click()
    size = opened.get_by_label("Width by height")
    size.fill("wide")
    expect(told).to_have_text(re.compile("^'wide' is not a size; write width x height and a unit"))
    opened.get_by_role("button", name="Plan it").click()
    expect(opened.locator(".q-notification").get_by_text("'wide' is not a size")).to_be_visible()
    size.fill("9 by 12 cm")
    opened.get_by_label("Margin, mm").fill("15")
    expect(told).to_contain_text("A sheet of 120 by 90 mm. 15 mm of bare paper all around.")
    shown = opened.get_by_alt_text("The picture as it is corrected")
    expect(shown).to_have_attribute("src", re.compile("^data:image/jpeg"))
    assert shown.evaluate("each => each.naturalWidth > each.naturalHeight")
    opened.get_by_label("Brush or pen", exact=True).click()
    opened.get_by_role("option", name="marker").click()
    opened.get_by_role("button", name="Plan it").click()
    target = target_of(opened, plans / "standing-2")
    options = json.loads((plans / "standing-2" / "request.json").read_bytes())["options"]
    wanted = {
        "rotate": 90,
        "crop": [0, 0, 0.97, 1],
        "exposure": 1,
        "size": "120x90mm",
        "margin": "15mm",
        "fit": "cover",
    }
    assert {name: options[name] for name in wanted} == wanted
    painted = np.argwhere(target.max(axis=2) < _WHITE) / target.shape[0] * 90
    assert painted.min(axis=0) == pytest.approx([15, 15], abs=1)
    assert painted.max(axis=0) == pytest.approx([75, 105], abs=1)

    opened.reload()
    bring(opened, tmp_path / "standing.png")
    expect(told).to_contain_text("A sheet of 90 by 120 mm.")  # the photograph itself stands, as it was
