from dataclasses import replace

import pytest
import torch

from maulstick.planning.parameters import StrokeParameters, joined
from maulstick.planning.style_price import StylePrice
from maulstick.style import Style
from maulstick.style.free import FreeStyle
from maulstick.style.regional import RegionalStyle
from tests.support.style.synthetic_hands import exemplar_of, zigzag


def alike(style: Style, count: int) -> StrokeParameters:
    """Return strokes that are all the style's first: likely one by one, and together nothing like the hand."""
    codes, knots = (numbers[:1].expand(count, -1).clone() for numbers in style.sample(1, torch.Generator()))
    nowhere = torch.zeros(count)
    return StrokeParameters(codes, torch.zeros(count, 2), nowhere, knots, torch.zeros(count, 3), nowhere.long())


def weight_after(price: StylePrice, strokes: StrokeParameters) -> float:
    price.of(strokes)
    price.adapt(stride=0.1)
    return price.weight


def test_strokes_that_a_plan_goes_on_from_may_cost_as_much_as_they_do() -> None:
    style = exemplar_of(zigzag)
    left = alike(style, 4)
    at_first = StylePrice(style, 4, 0).weight
    assert weight_after(StylePrice(style, 4, 0), left) > at_first
    assert weight_after(StylePrice(style, 4, 0, left), left) == at_first


def in_region(style: RegionalStyle, region: int, count: int) -> StrokeParameters:
    """Return strokes of a region's hand as `alike` does, as strokes of that region."""
    own = alike(style.hands[region], count)
    return replace(own, codes=style.codes_in(region, own.codes))


def test_free_strokes_in_regions_cost_what_they_do_without() -> None:
    free = FreeStyle(0.004, 0.1)
    everywhere = RegionalStyle([free, free])
    strokes = alike(free, 5)
    with_codes = replace(strokes, codes=everywhere.codes_in(1, strokes.codes))
    price = StylePrice(free, 5, 0).of(strokes).item()
    assert price > 0
    assert StylePrice(everywhere, 5, 0).of(with_codes).item() == pytest.approx(price, rel=1e-5)


def test_a_hand_beside_free_strokes_is_held_as_firmly_as_alone_and_they_are_not() -> None:
    hand, free = exemplar_of(zigzag), FreeStyle(0.004, 0.1)
    alone, beside = RegionalStyle([hand]), RegionalStyle([hand, free])
    own, others = in_region(beside, 0, 4), in_region(beside, 1, 36)
    price = StylePrice(beside, 40, 0)
    assert weight_after(price, joined([own, others])) == weight_after(StylePrice(alone, 40, 0), in_region(alone, 0, 4))
    at_first = StylePrice(free, 36, 0).of(alike(free, 36)).item()
    assert price.of(others).item() == pytest.approx(at_first, rel=1e-5), "whatever the hand weighs by now"
