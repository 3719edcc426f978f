import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage.color import rgb2lab

from maulstick.colour.palette import lightness, mix_paints, nearest_paint, parse_colour, swatches
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats

FOUR = np.array([[1.0, 1.0, 0.9], [0.9, 0.3, 0.2], [0.1, 0.4, 0.7], [0.05, 0.05, 0.05]])
SRGB_ROUND_TRIP = 1e-3  # of going to CIELAB and back, as scikit-image has it
colours = st.integers(1, 30).flatmap(lambda n: arrays(np.float64, (n, 3), elements=st.floats(0, 1, width=16)))


def test_paints_are_found_where_the_colours_are_light_first() -> None:
    rng = np.random.default_rng(0)
    cloud = np.repeat(FOUR[[2, 0, 3, 1]], 20, axis=0)
    found = mix_paints((cloud + rng.normal(0, 0.01, cloud.shape)).clip(0, 1), np.ones(80), 4, seed=0)
    assert found == pytest.approx(FOUR, abs=0.02)


@settings(max_examples=25, deadline=None)
@given(colours, st.integers(1, 6))
def test_paints_are_srgb_no_more_than_asked_for_and_go_from_light_to_dark(cloud: Floats, k: int) -> None:
    different = len(np.unique(cloud, axis=0))
    paints = mix_paints(cloud, np.ones(len(cloud)), k, seed=3)
    assert 1 <= len(paints) <= min(k, different)
    assert paints.min() >= 0
    assert paints.max() <= 1
    assert (np.diff(lightness(paints)) <= 1e-6).all()


def test_fewer_colours_than_paints_are_all_kept() -> None:
    cloud = np.repeat(FOUR, 5, axis=0)
    assert mix_paints(cloud, np.ones(20), 12, seed=0) == pytest.approx(FOUR, abs=SRGB_ROUND_TRIP)
    white = mix_paints(np.ones((9, 3)), np.ones(9), 12, seed=0)
    assert white == pytest.approx(np.ones((1, 3)), abs=SRGB_ROUND_TRIP)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_beside_pinned_paints_others_are_mixed_for_the_colours_that_are_left(count: int) -> None:
    pinned = [(red, green, blue) for red, green, blue in FOUR[:count].tolist()]
    paints = mix_paints(np.repeat(FOUR, 5, axis=0), np.ones(20), 4, seed=0, pinned=pinned)
    assert paints == pytest.approx(FOUR, abs=SRGB_ROUND_TRIP)


@pytest.mark.parametrize("cloud", [np.repeat(FOUR, 5, axis=0), FOUR[:0]])
def test_where_pinned_paints_do_no_others_are_mixed(cloud: Floats) -> None:
    pinned = [(red, green, blue) for red, green, blue in FOUR.tolist()]
    assert np.array_equal(mix_paints(cloud, np.ones(len(cloud)), 12, seed=0, pinned=pinned), FOUR)


def test_one_paint_is_the_mean_in_cielab_of_what_covers_the_canvas() -> None:
    amounts = np.array([3.0, 1.0, 0.5, 0.5])
    expected = (rgb2lab(FOUR) * amounts[:, None]).sum(0) / amounts.sum()
    assert rgb2lab(mix_paints(FOUR, amounts, 1, seed=0))[0] == pytest.approx(expected, abs=0.1)


def test_a_seed_repeats_the_paints_to_the_bit() -> None:
    cloud = np.random.default_rng(1).random((200, 3))
    amounts = np.random.default_rng(2).random(200)
    paints = mix_paints(cloud, amounts, 12, seed=5)
    assert len(paints) == 12
    assert np.array_equal(mix_paints(cloud, amounts, 12, seed=5), paints)
    assert not np.array_equal(mix_paints(cloud, amounts, 12, seed=6), paints)


@given(colours)
def test_the_paint_nearest_to_a_colour_is_itself_where_it_is_a_paint(cloud: Floats) -> None:
    paints = np.unique(cloud, axis=0)
    nearest = nearest_paint(cloud, paints)
    assert rgb2lab(paints[nearest]) == pytest.approx(rgb2lab(cloud), abs=1e-9)


def test_nearest_is_what_the_eye_finds_nearest() -> None:
    leaf, lilac, dark_leaf = np.array([[0.6, 1.0, 0.6], [0.6, 0.6, 0.8], [0.0, 0.6, 0.0]])
    assert np.linalg.norm(leaf - lilac) < 0.5 * np.linalg.norm(leaf - dark_leaf), "in sRGB the lilac is nearer"
    assert nearest_paint(np.stack([leaf, lilac]), np.stack([lilac, dark_leaf])).tolist() == [1, 0]


def test_lightness_goes_from_black_at_0_to_white_at_100() -> None:
    greys = np.linspace(0, 1, 11)[:, None].repeat(3, axis=1)
    found = lightness(greys)
    assert found[[0, -1]] == pytest.approx([0, 100], abs=1e-3)
    assert (np.diff(found) > 5).all()
    green, blue = lightness(np.array([[0, 1.0, 0], [0, 0, 1.0]]))
    assert green > blue + 40
    assert lightness(np.zeros((0, 3))).shape == (0,)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("black", (0, 0, 0)),
        ("White", (1, 1, 1)),
        ("#ff8000", (1, 128 / 255, 0)),
        ("#f00", (1, 0, 0)),
        ("#0000ff80", (0, 0, 1)),
    ],
)
def test_a_colour_is_read_from_its_name_or_hexadecimal(text: str, expected: tuple[float, float, float]) -> None:
    assert parse_colour(text) == expected


@pytest.mark.parametrize("text", ["", "blackish", "#12345", "0,0,0", "12mm", "rgb(999, 0, 0)", "hsl(0, 200%, 25%)"])
def test_what_is_no_colour_is_refused(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_colour(text)
    assert str(caught.value) == f"{text!r} is not a colour; write a name such as black, or #rrggbb"


def test_swatches_show_each_paint_in_a_row_of_its_own() -> None:
    paints = [tuple(paint) for paint in FOUR.tolist()]
    sheet = swatches(paints, ["a", "b", "c", "d"])
    for i, paint in enumerate(paints):
        middle = sheet.height * (2 * i + 1) // 8
        assert sheet.getpixel((70, middle)) == tuple(round(255 * channel) for channel in paint)
    unlabelled = swatches(paints, [""] * 4)
    assert sheet.tobytes() != unlabelled.tobytes(), "the labels were not drawn"
    assert sheet.size == unlabelled.size


def test_a_long_name_is_not_cut_off() -> None:
    short, long = (swatches([(0, 0, 0)], [f"{name}   1.25 m"]) for name in ("m", "m" * 80))
    assert np.asarray(short.convert("L"))[:, 152:].min() < 128
    ink = np.flatnonzero(np.asarray(long.convert("L")).min(axis=0) < 128)
    assert long.width - 16 < ink.max() < long.width - 1
    assert ink.max() > 80 * 10
    assert short.width == 480


def test_no_paints_make_a_sheet_without_swatches() -> None:
    assert swatches([], []).getcolors() == [(480 * 56, (255, 255, 255))]


def test_a_paint_without_a_label_is_refused() -> None:
    with pytest.raises(ValueError, match="shorter"):
        swatches([(0, 0, 0)], [])
