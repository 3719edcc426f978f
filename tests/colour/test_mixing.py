import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage.color import deltaE_ciede2000, rgb2lab

from maulstick.colour.mixing import Recipe, mixed_colours, mixing_advice
from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint
from maulstick.errors import InputError
from maulstick.storage.arrays import Floats
from tests.support.tolerances import MIXED

COLOUR = {paint.name: paint.colour for paint in USUAL_PAINTS}
WHITE, BLACK, YELLOW, BLUE = (
    np.array(COLOUR[name]) for name in ("titanium white", "ivory black", "hansa yellow", "phthalo blue")
)
several = st.integers(1, 4).flatmap(
    lambda k: st.tuples(
        arrays(np.float64, (k, 3), elements=st.floats(0, 1)), arrays(np.int64, (1, k), elements=st.integers(1, 40))
    )
)


def mixed(*colours: Floats, parts: tuple[int, ...]) -> Floats:
    return np.asarray(mixed_colours(np.stack(colours), np.array([parts]))[0])


def distance(first: Floats, second: Floats) -> float:
    return float(deltaE_ciede2000(rgb2lab(first[None]), rgb2lab(second[None]))[0])


@given(arrays(np.float64, 3, elements=st.floats(0, 1)), st.integers(1, 40), st.integers(1, 40))
def test_a_paint_mixed_with_itself_stays_what_it_is(colour: Floats, first: int, second: int) -> None:
    assert mixed(colour, colour, parts=(first, second)) == pytest.approx(colour, abs=MIXED)


@given(several)
def test_a_mix_lies_between_its_paints_whatever_their_order(mix: tuple[Floats, Floats]) -> None:
    colours, parts = mix
    found = mixed_colours(colours, parts)[0]
    assert found == pytest.approx(mixed_colours(colours[::-1], parts[:, ::-1])[0], abs=MIXED)
    assert found == pytest.approx(mixed_colours(colours, 3 * parts)[0], abs=MIXED)
    assert (found >= colours.min(axis=0) - MIXED).all()
    assert (found <= colours.max(axis=0) + MIXED).all()


def test_white_and_black_are_a_grey_darker_than_their_mean() -> None:
    grey = mixed(WHITE, BLACK, parts=(1, 1))
    assert np.ptp(grey) < 0.05
    assert grey.max() < 0.7 * (WHITE + BLACK).mean() / 2
    tints = [mixed(WHITE, BLACK, parts=(white, 1)).mean() for white in (1, 2, 4, 9, 40)]
    assert (np.diff(tints) > 0.05).all(), "more white is lighter"


def test_blue_and_yellow_are_a_green_as_in_paint_and_not_as_in_light() -> None:
    red, green, blue = mixed(YELLOW, BLUE, parts=(3, 1))
    assert green > 1.2 * max(red, blue)
    assert green < 0.8 * YELLOW[1]


def test_what_is_in_a_tube_is_taken_from_it() -> None:
    for paint, recipe in zip(USUAL_PAINTS, mixing_advice(np.array(list(COLOUR.values())), USUAL_PAINTS), strict=True):
        assert recipe.parts == ((paint.name, 1),)
        assert recipe.colour == pytest.approx(paint.colour, abs=MIXED)
        assert recipe.error < 1e-3
        assert str(recipe) == f"{paint.name} alone"


def test_a_known_mix_is_found_again_or_one_that_is_simpler_and_looks_the_same() -> None:
    wanted = np.stack([mixed(WHITE, BLUE, parts=(3, 1)), mixed(YELLOW, BLUE, WHITE, parts=(5, 2, 4))])
    first, second = mixing_advice(wanted, USUAL_PAINTS)
    assert first.parts == (("titanium white", 3), ("phthalo blue", 1))
    assert (first.verdict, str(first)) == ("the same to the eye", "3 parts titanium white + 1 part phthalo blue")
    assert len(second.parts) <= 3
    assert second.error < 1


@settings(max_examples=10, deadline=None)
@given(arrays(np.float64, (3, 3), elements=st.floats(0, 1, width=16)), st.integers(1, 5))
def test_a_recipe_gives_the_colour_it_promises_and_none_of_a_paint_s_own_is_nearer(wanted: Floats, count: int) -> None:
    base = USUAL_PAINTS[:count]
    for colour, recipe in zip(wanted, mixing_advice(wanted, base), strict=True):
        paints, parts = zip(*recipe.parts, strict=True)
        again = mixed(*(np.array(COLOUR[name]) for name in paints), parts=parts)
        assert recipe.colour == pytest.approx(again, abs=MIXED)
        assert recipe.error == pytest.approx(distance(colour, again), abs=1e-6)
        assert len(set(paints)) == len(paints) <= 4
        assert list(parts) == sorted(parts, reverse=True)
        assert sum(parts) <= 44
        assert recipe.error <= min(distance(colour, np.array(paint.colour)) for paint in base) + 1


def test_a_colour_that_no_mix_comes_near_is_said_to_be_out_of_reach() -> None:
    (recipe,) = mixing_advice(np.array([[0.0, 1.0, 0.0]]), USUAL_PAINTS)
    assert recipe.error > 5
    assert recipe.verdict == "out of reach"
    assert recipe.parts, "the best there is, all the same"


@pytest.mark.parametrize(
    ("error", "words"),
    [(0.0, "the same to the eye"), (1.0, "very near"), (2.5, "near"), (4.99, "near"), (5.0, "out of reach")],
)
def test_an_error_is_told_in_words(error: float, words: str) -> None:
    assert Recipe((("a", 1),), (0.0, 0.0, 0.0), error).verdict == words


@pytest.mark.parametrize(("count", "most"), [(1, 1), (17, 3), (40, 2)])
def test_many_tubes_are_mixed_fewer_at_a_time(count: int, most: int) -> None:
    rng = np.random.default_rng(count)
    base = [NamedPaint(f"tube {i}", tuple(colour)) for i, colour in enumerate(rng.random((count, 3)).tolist())]
    recipes = mixing_advice(rng.random((4, 3)), base)
    assert max(len(recipe.parts) for recipe in recipes) <= most
    assert len({recipe.parts for recipe in recipes}) > (count > 1)


def test_nothing_wanted_needs_no_recipe_and_no_paints_give_none() -> None:
    assert mixing_advice(np.zeros((0, 3)), USUAL_PAINTS[:2]) == ()
    with pytest.raises(InputError) as caught:
        mixing_advice(np.zeros((1, 3)), ())
    assert str(caught.value) == "there are no paints to mix from; name at least one"
