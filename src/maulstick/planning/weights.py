"""Weights of the terms of the loss, by name: which there are, and what they may be."""

from collections.abc import Mapping
from typing import Final

from maulstick.errors import InputError

STRENGTHS: Final = {"tone": 1.0, "edges": 0.01, "likeness": 0.02, "sketch": 0.02, "text": 0.1, "look": 0.01}
"""Strength of each term at weight 1, by name: chosen so that a weight of 1 suits most pictures."""

FACES: Final = "faces"
"""Modifier among the weights, which is no term: how much more a face counts in all terms than its surroundings."""

NEEDS: Final = {"text": "a text", "look": "the look of a picture"}
"""What terms compare with that need no picture, by name."""

_HEAVIEST = 1000  # largest weight: beyond, no other term counts, and float32 may overflow


def check_weights(weights: Mapping[str, float], given: Mapping[str, bool]) -> None:
    """Raise InputError for a term that does not exist, a weight out of range, and contradictions.

    given: whether there is what a term needs, by the names in `NEEDS`.
    """
    for name, weight in weights.items():
        if name not in STRENGTHS and name != FACES:
            raise InputError.of_choice("term to weigh", name, [*STRENGTHS, FACES])
        if not (isinstance(weight, int | float) and 0 <= weight <= _HEAVIEST):
            raise InputError.of_range(f"the weight of {name}", repr(weight), f"from 0 to {_HEAVIEST}")
        if name in given and weight and not given[name]:
            raise InputError(f"{name} weighs {NEEDS[name]}, and there is none; give it, or leave the weight out")
        if name in given and not weight and given[name]:
            raise InputError(f"{name}=0 leaves {NEEDS[name]} out, and there is one; leave one of the two out")
