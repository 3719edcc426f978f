"""Pictures that are thrown away and put back, in a real browser."""

from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, expect

from tests.studio.conftest import RunningStudio


def test_a_picture_is_thrown_away_taken_back_and_put_back_out_of_the_trash(
    studio: RunningStudio, page: Callable[..., Page]
) -> None:
    for name in ("cat", "dog"):
        folder: Path = studio.folder / "pictures" / name
        folder.mkdir()
        for file in ("picture.png", "small.jpg"):
            Image.new("RGB", (60, 40), "#2a6a8c").save(folder / file)
    tab, other = page("/plan"), page("/plan", viewport={"width": 1024, "height": 768})
    for each in (tab, other):
        expect(each.get_by_role("radio", name="dog")).to_be_checked()
    tab.get_by_role("button", name="Throw the picture away").click()
    for each in (tab, other):
        expect(each.get_by_role("radio", name="dog")).to_have_count(0)
        expect(each.get_by_role("radio", name="cat")).to_be_checked()
    tab.get_by_role("button", name="Undo").click()
    expect(tab.get_by_role("radio", name="dog")).to_be_visible()
    expect(other.get_by_role("radio", name="cat")).to_be_checked()

    tab.get_by_role("button", name="Throw the picture away").click()
    expect(tab.get_by_text("cat is in the trash")).to_be_visible()
    trash = page("/trash")
    row = trash.get_by_role("listitem", name="cat")
    expect(row.get_by_text("Picture · ")).to_be_visible()
    trash.wait_for_function("[...document.querySelectorAll('.thrown img')].every((each) => each.naturalWidth > 10)")
    row.get_by_role("button", name="Put cat back").click()
    expect(trash.get_by_text("Nothing was thrown away.")).to_be_visible()
    expect(other.get_by_role("radio", name="cat")).to_be_visible()
    for name in ("cat", "dog"):
        other.get_by_role("radio", name=name).check()
        other.get_by_role("button", name="Throw the picture away").click()
        expect(other.get_by_role("radio", name=name)).to_have_count(0)
    expect(other.get_by_role("button", name="Throw the picture away")).to_be_hidden()
    expect(other.get_by_role("button", name="Try an example picture")).to_be_visible()
