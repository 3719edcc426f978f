"""Plots of styles: the hand and the style at one scale, and maps that place similar strokes together."""

import io
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image

from maulstick.errors import InputError
from maulstick.plots import latent_map as module
from maulstick.plots.latent_map import COLOURS, latent_map, places_of
from maulstick.plots.sheet import PAPER
from maulstick.plots.style import style_plot
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from tests.support.drawn import as_strokes, hatching
from tests.support.style.synthetic_hands import all_hands, circle, exemplar_of, line, zigzag

PX = 480


@pytest.fixture(scope="module")
def circles() -> Exemplar:
    return exemplar_of(circle)


@pytest.fixture(scope="module")
def zigzags() -> Exemplar:
    return exemplar_of(zigzag)


def pixels(png: bytes) -> NDArray[np.int64]:
    with Image.open(io.BytesIO(png)) as image:
        assert image.height == PX
        return np.array(image.convert("RGB"), dtype=np.int64)


def parts(plot: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Find the white sheets on a plot, from the top."""
    white = (plot == to_rgb_255(PAPER)).all(axis=2).mean(axis=1) > 0.05
    edges = np.flatnonzero(np.diff(np.concatenate([[False], white, [False]]).astype(int)))
    return [plot[top:bottom] for top, bottom in edges.reshape(-1, 2) if bottom - top > PX / 10]


def to_rgb_255(colour: str) -> NDArray[np.int64]:
    return np.round(np.array(to_rgb(colour)) * 255).astype(np.int64)


def dark(plot: NDArray[np.int64]) -> NDArray[np.bool_]:
    return plot.max(axis=2) < 128


def near(plot: NDArray[np.int64], colour: str) -> NDArray[np.bool_]:
    """Find the pixels of a thin line of that colour on white."""
    ink = 255 - to_rgb_255(colour)
    share = ((255 - plot) @ ink / (ink @ ink)).clip(max=1)
    return (share > 0.3) & (np.abs(255 - plot - share[..., None] * ink).max(axis=2) < 12)


def pressed(style: Exemplar, pressure: float) -> Exemplar:
    return replace(style, hand=Hand(style.hand.paths, np.full_like(style.hand.pressure, pressure), style.hand.speeds))


def test_a_drawing_on_one_line_is_drawn_without_a_word() -> None:
    along = np.linspace(0, 0.01, 32)
    paths = np.stack([0.011 * np.arange(40)[:, None] + along, np.full((40, 32), 0.1)], axis=-1)
    style = replace(exemplar_of(line), hand=Hand.of(as_strokes(paths)))
    assert style.arrangement is not None
    assert dark(pixels(style_plot(style, "line", PX))).any()


def test_a_style_draws_as_much_as_is_shown_of_its_hand(circles: Exemplar) -> None:
    by_hand, by_style = (dark(part).sum() for part in parts(pixels(style_plot(circles, "", PX))))
    assert by_style == pytest.approx(by_hand, rel=0.3)


def test_only_the_lower_part_depends_on_what_the_style_draws(circles: Exemplar) -> None:
    # A bound style and a free one sample other strokes; the scale may differ, the number of strokes does not.
    bound, free = (parts(pixels(style_plot(replace(circles, freedom=freedom), "", PX))) for freedom in (0.0, 1.0))
    by_hand, by_style = (dark(each).sum() / dark(other).sum() for each, other in zip(bound, free, strict=True))
    assert by_hand == pytest.approx(1, abs=0.05)
    assert (dark(bound[1]) != dark(free[1])).any()
    assert by_style != by_hand


def test_strokes_are_as_wide_as_they_were_pressed(circles: Exemplar) -> None:
    even, light, deep = (
        [dark(part).sum() for part in parts(pixels(style_plot(style, "", PX)))]
        for style in (circles, pressed(circles, 0.0), pressed(circles, 1.0))
    )
    for whose in (0, 1):
        assert light[whose] < even[whose] < deep[whose]


@pytest.mark.parametrize("strokes", [5, 6, 300])
def test_any_number_of_strokes_has_a_sheet_and_a_map(strokes: int) -> None:
    style = exemplar_of(line, strokes)
    for png in (style_plot(style, "x" * 300, PX), latent_map([style], "$x_1$", PX)):
        for part in parts(pixels(png)):
            assert near(part, COLOURS[0]).any()


def test_beside_a_style_that_knows_its_arrangement_stand_the_drawing_and_strokes_arranged_alike() -> None:
    drawing = as_strokes(hatching(6, seed=0))
    arranged = Exemplar("hatcher", Hand.of(drawing), all_hands(), 0.0)
    unknown = replace(arranged, hand=replace(arranged.hand, poses=None))
    wide, narrow = (pixels(style_plot(style, "", PX)) for style in (arranged, unknown))
    assert wide.shape[1] > 1.5 * narrow.shape[1]
    drawn, by_style = (dark(part[:, narrow.shape[1] :]).sum() for part in parts(wide))
    assert by_style == pytest.approx(drawn, rel=0.3)


def alike(style: Exemplar, metres: float) -> Exemplar:
    """Its hand drew one stroke six times, but for so much."""
    hand = style.hand
    paths = np.repeat(hand.paths[:1], 6, axis=0)
    paths[:, 1:-1] += np.random.default_rng(0).uniform(-metres, metres, paths[:, 1:-1].shape)
    return replace(style, hand=Hand(paths, hand.pressure[:6], hand.speeds[:6]))


def test_strokes_that_are_all_the_same_have_a_sheet_and_a_map(circles: Exemplar) -> None:
    style = alike(circles, 0.0)
    for png in (style_plot(style, "", PX), latent_map([style], "", PX)):
        assert near(parts(pixels(png))[0], COLOURS[0]).any()


@pytest.mark.parametrize("metres", [0.0, 1e-18, 1e-15, 1e-12])
def test_strokes_that_only_rounding_tells_apart_lie_in_the_middle_of_a_map(circles: Exemplar, metres: float) -> None:
    assert places_of([alike(circles, metres)]).places.tolist() == [[0.0, 0.0]] * 6


@pytest.mark.parametrize("metres", [1e-8, 1e-6])
def test_strokes_that_are_nearly_the_same_have_a_place_each_on_a_map(circles: Exemplar, metres: float) -> None:
    style = alike(circles, metres)
    places = places_of([style]).places
    assert np.ptp(places, axis=0) == pytest.approx([1, 1])
    assert len(np.unique(places, axis=0)) == 6
    assert near(parts(pixels(latent_map([style], "", PX)))[0], COLOURS[0]).any()


def test_a_map_keeps_the_strokes_of_a_hand_together(circles: Exemplar, zigzags: Exemplar) -> None:
    (sheet,) = parts(pixels(latent_map([circles, zigzags], "", PX)))
    first, second = (np.argwhere(near(sheet, colour)) for colour in COLOURS[:2])
    apart = np.linalg.norm(first.mean(axis=0) - second.mean(axis=0))
    assert apart > first.std(axis=0).max() + second.std(axis=0).max()


def test_every_style_of_a_map_has_a_colour_and_there_are_six(circles: Exemplar, zigzags: Exemplar) -> None:
    styles = [circles, zigzags, *(exemplar_of(circle, seed=seed) for seed in range(4))]
    plot = pixels(latent_map(styles, "", PX))
    for colour in COLOURS:
        assert near(plot[: PX * 3 // 4], colour).any(), "a stroke"
        assert near(plot[PX * 3 // 4 :], colour).any(), "a name"
    with pytest.raises(InputError, match="the number of styles on a map is 7; it must be from 1 to 6"):
        latent_map([*styles, circles], "", PX)


def test_the_places_of_a_map_say_whose_stroke_lies_where(circles: Exemplar, zigzags: Exemplar) -> None:
    at = places_of([circles, zigzags])
    assert at.rows.tolist() == [*range(len(circles.hand)), *range(len(zigzags.hand))]
    assert np.bincount(at.whose).tolist() == [len(circles.hand), len(zigzags.hand)]
    assert np.ptp(at.places, axis=0) == pytest.approx([1, 1])
    assert np.ptp(at.glyphs, axis=1).max() == pytest.approx(1)
    first, second = (at.places[at.whose == number] for number in (0, 1))
    assert np.linalg.norm(first.mean(axis=0) - second.mean(axis=0)) > first.std(axis=0).max()


def test_of_many_strokes_a_map_shows_some_of_each_style(
    circles: Exemplar, zigzags: Exemplar, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_MOST", 10)
    some = np.bincount(places_of([circles, zigzags]).whose)
    assert some.sum() == pytest.approx(10, abs=1)
    assert some.min() > 0


def test_the_same_style_is_the_same_picture(circles: Exemplar) -> None:
    assert style_plot(circles, "twice", PX) == style_plot(circles, "twice", PX)
    assert latent_map([circles], "twice", PX) == latent_map([circles], "twice", PX)
