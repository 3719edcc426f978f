"""Whether two plans are the same."""

import torch

from maulstick.planning.result import PlanResult


def same(one: PlanResult, other: PlanResult) -> bool:
    """Whether two plans are equal to the bit."""
    pairs = [(one.paints, other.paints), (one.paint_of, other.paint_of)]
    pairs += [(tensor, other.strokes.each()[name]) for name, tensor in one.strokes.each().items()]
    return all(torch.equal(a, b) for a, b in pairs)
