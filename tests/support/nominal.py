"""Brushes with round numbers, so that a test says what it tests; those that come with Maulstick are fitted."""

from maulstick.painting.brush import Brush

_SOURCE = "nominal, for tests"
_BRUSHES = {
    "fineliner": Brush(name="fineliner", source=_SOURCE, alpha=0.0, beta=0.00015, plateau=0.4),
    "marker": Brush(name="marker", source=_SOURCE, alpha=0.0008, beta=0.0007, plateau=0.6, opacity=0.95),
    "round": Brush(name="round", source=_SOURCE, alpha=0.006, beta=0.001, plateau=0.5, depth=(0.0, 0.008)),
}


def nominal(name: str) -> Brush:
    """A 0.3 mm fineliner, a marker of 1.4 to 3 mm or a round brush of 2 to 14 mm."""
    return _BRUSHES[name]
