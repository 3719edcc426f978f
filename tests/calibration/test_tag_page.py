from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.calibration.tag_page import tag_page, write_tag_page
from maulstick.calibration.tags import found_tags
from maulstick.colour.srgb import colours_of
from maulstick.errors import InputError
from maulstick.robot.camera.tag_frame import TAGS, TagFrame

DOT = 25.4e-3 / 600


def _found(page: Image.Image) -> dict[int, np.ndarray]:
    """Return metres from the page's upper left corner."""
    light = np.asarray(page.reduce(4), dtype=np.float32) / 255
    photo = colours_of(light)[..., None].repeat(3, axis=2)
    return {tag: (corners + 0.5) * 4 * DOT for tag, corners in found_tags(photo).items()}


def test_a_page_has_the_tags_in_their_places_around_a_sheet_that_fits() -> None:
    frame = TagFrame(0.100, 0.120)
    found = _found(tag_page(frame))
    assert sorted(found) == list(TAGS)
    for tag in TAGS:
        np.testing.assert_allclose(found[tag] - found[0][0], frame.corners(tag) - frame.corners(0)[0], atol=DOT)


def test_a_page_has_four_cards_to_cut_out_for_a_larger_sheet() -> None:
    frame = TagFrame(0.297, 0.210, side=30e-3)
    found = _found(tag_page(frame))
    assert sorted(found) == list(TAGS)
    for corners in found.values():
        np.testing.assert_allclose(corners[2] - corners[0], 30e-3, atol=DOT)


def test_a_page_is_written_at_its_true_size(tmp_path: Path) -> None:
    frame = TagFrame(0.297, 0.210)
    write_tag_page(tmp_path / "tags.png", frame)
    with Image.open(tmp_path / "tags.png") as page:
        assert page.info["dpi"] == pytest.approx((600, 600), abs=0.01)
        assert np.array(page.size) * DOT == pytest.approx((0.210, 0.297), abs=DOT)
    write_tag_page(tmp_path / "tags.pdf", frame)
    assert b"/MediaBox [ 0 0 595." in (tmp_path / "tags.pdf").read_bytes()


def test_what_cannot_be_printed_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^there is no kind of page '.svg'; there are: .pdf, .png$"):
        write_tag_page(tmp_path / "tags.svg", TagFrame(0.297, 0.210))
    with pytest.raises(InputError, match=r"^the paper to print on is 3000 x 200 mm; it must be at most 1200 mm a"):
        tag_page(TagFrame(0.297, 0.210), (3.0, 0.2))


def test_paper_that_is_too_small_for_the_cards_is_told_the_size_that_does() -> None:
    frame = TagFrame(0.3, 0.2, side=0.1, gap=0.025)
    for paper in ((0.1, 0.1), (0.420, 0.297)):  # wide enough, and not high enough
        with pytest.raises(InputError, match=r"it must be at least 298 x 322 mm, or the tags smaller$"):
            tag_page(frame, paper)
    assert tag_page(frame, (0.298, 0.322)).width == round(0.298 / 25.4e-3 * 600)


@pytest.mark.parametrize("paper", [(0.105, 0.148), (0.098, 0.122)])
def test_all_that_a_small_page_says_stands_on_it(paper: tuple[float, float]) -> None:
    page = np.asarray(tag_page(TagFrame(0.3, 0.2), paper))
    edge = round(7e-3 / DOT)
    assert page.min() == 0
    assert (page[:, -edge:] == 255).all()


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ((0.0, 0.2, 20e-3, 15e-3), "^the sheet is 0 x 0.2 m; it must be larger than nothing$"),
        ((0.3, 0.2, 1e-3, 15e-3), "^tag is 1 mm; it must be between 5 and 120 mm, for a gap of 15 mm beside it$"),
        ((0.3, 0.2, 80e-3, 5e-3), "^tag is 80 mm; it must be between 5 and 40 mm, for a gap of 5 mm beside it$"),
        ((0.3, 0.2, 20e-3, 0.6), "^the gap beside a tag is 600 mm; it must be between 0.625 and 500 mm$"),
    ],
)
def test_a_frame_that_cannot_be_is_refused(numbers: tuple[float, float, float, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        TagFrame(*numbers)
