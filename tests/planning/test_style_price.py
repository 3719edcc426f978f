import torch

from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.style_price import StylePrice
from maulstick.style import Style
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
