from pathlib import Path

import numpy as np
import pytest
from skimage.color import deltaE_ciede2000, rgb2lab

from maulstick.calibration.camera import locate
from maulstick.calibration.chart import CHART, GREY_CARD, with_chart, with_grey_card
from maulstick.calibration.colour import Colours, Whites, lamp_of, read_colours, whites_of, write_colours
from maulstick.colour.srgb import colours_of, light_of
from maulstick.errors import InputError
from maulstick.painting.raster import parse_size
from maulstick.robot.simulated.camera import Optics
from maulstick.storage.arrays import Image
from tests.support.calibration.photo_studio import (
    CANVAS,
    CHART_CORNERS,
    TAGS,
    Studio,
    bare,
    chart,
    seen_squares,
    squares,
    strokes,
)
from tests.support.tolerances import CHART_ERROR, MIXED, OTHER_COLOURS, WHITE

GRID = (10, 20, 15, 40, 57)


def _seen(studio: Studio, sheet: Image) -> tuple[Image, Whites]:
    studio.sheet = sheet
    photo, view, flat = studio.look()
    return flat, whites_of(photo, view, TAGS)


@pytest.fixture(scope="module")
def studio() -> Studio:
    return Studio(bare())


@pytest.fixture(scope="module")
def lamp(studio: Studio) -> Colours:
    return lamp_of(*_seen(studio, bare()), paper=(0.96, 0.96, 0.96))


def _error(seen: Image, true: np.ndarray) -> float:
    return float(deltaE_ciede2000(rgb2lab(seen[None]), rgb2lab(true[None])).mean())


def test_bare_paper_is_its_own_colour_all_over_and_in_each_photograph() -> None:
    studio = Studio(bare(), 2, Optics(size=(800, 600), drift=0.1))
    lamp = lamp_of(*_seen(studio, bare()), paper=(0.96, 0.96, 0.96))
    flats = [_seen(studio, bare()) for _ in range(3)]
    raw = [flat[10:-10, 10:-10].mean() for flat, _ in flats]
    assert np.ptp(raw) > 2 * WHITE
    assert np.ptp(flats[0][0][10:-10, 10:-10].mean(axis=(0, 2))) > 20 * WHITE
    for flat, whites in flats:
        seen = lamp.correct(flat, whites)[10:-10, 10:-10]
        np.testing.assert_allclose(seen.mean(axis=(0, 1)), 0.96, atol=WHITE)
        np.testing.assert_allclose(seen[:190].mean(axis=(0, 1)), seen[190:].mean(axis=(0, 1)), atol=WHITE)


@pytest.mark.parametrize("said", [(1.0, 1.0, 0.0), (0.0, 0.0, 0.0)])
def test_on_paper_that_is_said_to_give_no_light_what_is_painted_is_seen(said: tuple[float, float, float]) -> None:
    paper = np.full_like(bare(), np.maximum(said, 0.35))
    studio = Studio(paper)
    lamp = lamp_of(*_seen(studio, paper), paper=said)
    painted = paper.copy()
    painted[150:250, 150:250] = (0.9, 0.2, 0.9)
    blue = lamp.correct(*_seen(studio, painted))[..., 2]
    assert blue[180:220, 180:220].mean() > 1.5 * blue[280:320, 180:220].mean()


def test_exposure_is_known_from_the_tags_that_are_left(lamp: Colours) -> None:
    studio = Studio(strokes(3, 12))
    studio.camera.cover(1)
    flat, whites = _seen(studio, strokes(3, 12))
    assert sorted(whites) == [0, 2, 3]
    paper = np.median(lamp.correct(flat, whites).reshape(-1, 3), axis=0)
    np.testing.assert_allclose(paper, 0.96, atol=2 * WHITE)


def test_one_size_in_two_units_is_that_of_one_sheet(lamp: Colours) -> None:
    kept = lamp.with_sheet(parse_size("LETTER"))
    assert not kept.is_of_another(parse_size("8.5x11in"))
    assert kept.is_of_another(parse_size("LETTER-landscape"))
    assert not lamp.is_of_another(parse_size("A4")), "its size was not kept"


def test_a_chart_makes_other_colours_right_too_and_says_how_right(studio: Studio, lamp: Colours) -> None:
    colours, errors = with_chart(lamp, *_seen(studio, chart()), CANVAS, CHART_CORNERS)
    assert errors.after[0] < CHART_ERROR < 5 < errors.before[0]
    assert str(errors).startswith("CIEDE2000 ")
    true = np.random.default_rng(4).uniform(0.1, 0.9, (50, 3))
    flat, whites = _seen(studio, squares(true, *GRID))
    raw, lit = (
        _error(seen_squares(flat, 50, *GRID), true),
        _error(seen_squares(lamp.correct(flat, whites), 50, *GRID), true),
    )
    right = _error(seen_squares(colours.correct(flat, whites), 50, *GRID), true)
    assert right < OTHER_COLOURS < lit < raw


def test_what_is_no_chart_is_refused(studio: Studio, lamp: Colours) -> None:
    seen = _seen(studio, chart())
    with pytest.raises(InputError, match=r"^what lies there is not the chart; give the middles"):
        with_chart(lamp, *seen, CANVAS, np.roll(CHART_CORNERS, 2, axis=0))
    bent = np.array([[0, 0], [0.05, 0.05], [0.2, 0.16], [0, 0.16]])
    for beyond in (CHART_CORNERS + 0.2, CHART_CORNERS * 1e9, CHART_CORNERS * 1e300, bent):
        with pytest.raises(InputError, match=r"^the chart is too small or reaches beyond the sheet"):
            with_chart(lamp, *seen, CANVAS, beyond)
    with pytest.raises(InputError, match=r"^the chart's corners must be four points"):
        with_chart(lamp, *seen, CANVAS, CHART_CORNERS[:3])


def test_a_chart_in_too_much_light_is_refused(studio: Studio, lamp: Colours) -> None:
    studio.sheet = chart()
    photo = colours_of(np.float32(2) * light_of(studio.camera.photograph()))
    view = locate(photo, TAGS)
    with pytest.raises(InputError, match=r"^the photograph is overexposed; lower the camera's exposure or dim"):
        with_chart(lamp, view.rectify(photo, CANVAS), whites_of(photo, view, TAGS), CANVAS, CHART_CORNERS)


def test_a_grey_card_becomes_grey_and_as_dark_as_it_is(studio: Studio, lamp: Colours) -> None:
    card = bare()
    card[100:200, 100:250] = GREY_CARD
    seen = _seen(studio, card)
    colours = with_grey_card(lamp, *seen, CANVAS, (0.055, 0.055, 0.06, 0.04))
    np.testing.assert_allclose(colours.correct(*seen)[120:180, 120:230].mean(axis=(0, 1)), GREY_CARD, atol=WHITE)
    with pytest.raises(InputError, match=r"^the grey card must lie on the sheet"):
        with_grey_card(lamp, *seen, CANVAS, (0.28, 0.1, 0.06, 0.04))


def test_a_sheet_that_is_not_bare_or_overexposed_is_refused(studio: Studio) -> None:
    with pytest.raises(InputError, match=r"^the sheet's brightness varies by \d+% .*; photograph it bare and whole$"):
        lamp_of(*_seen(studio, strokes(1, 25)))
    with pytest.raises(InputError, match=r"^100% of the sheet is overexposed; lower the camera's exposure"):
        lamp_of(np.ones((50, 60, 3), dtype=np.float32), {})


def test_without_tags_the_exposure_is_taken_as_it_was(studio: Studio, lamp: Colours) -> None:
    flat, whites = _seen(studio, bare())
    bright = {tag: 1.1 * white for tag, white in whites.items()}
    np.testing.assert_array_equal(lamp_of(flat, {}).correct(flat, bright), lamp_of(flat, {}).correct(flat, {}))
    assert lamp.correct(flat, bright).mean() < lamp.correct(flat, whites).mean() - WHITE


def test_colours_survive_their_file_and_another_file_is_refused(lamp: Colours, tmp_path: Path) -> None:
    write_colours(lamp, tmp_path / "colours.json")
    assert read_colours(tmp_path / "colours.json") == lamp
    (tmp_path / "other.json").write_text('{"whites": {}}')
    with pytest.raises(InputError, match="is not a camera's colours: lamp"):
        read_colours(tmp_path / "other.json")


def test_light_and_colours_are_each_others_inverse_and_agree_with_known_values() -> None:
    steps = np.linspace(0, 1, 256, dtype=np.float32)
    np.testing.assert_allclose(colours_of(light_of(steps)), steps, atol=10 * MIXED)
    np.testing.assert_allclose(light_of(np.float32([0, 0.5, 1])), [0, 0.21404, 1], atol=1e-5)
    assert CHART[18:].std(axis=1).max() < 0.01
