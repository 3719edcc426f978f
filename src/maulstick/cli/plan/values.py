"""Values of options of ``maulstick plan`` out of their texts."""

from pathlib import Path
from typing import Literal

import typer

from maulstick.errors import InputError
from maulstick.jobs.plan.request import demo_picture
from maulstick.painting.edit import Crop


def strokes_of(text: str) -> int | Literal["auto"]:
    """Return the number of strokes, or auto."""
    if text == "auto":
        return "auto"
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is neither a whole number nor auto", param_hint="'--strokes'") from None


def picture_path(picture: Path | None, demo: bool, text: str | None, *, is_needed: bool = True) -> Path | None:
    """Return the path of the picture, or None where there is only a text."""
    if picture is not None and demo:
        raise InputError("name one picture to paint, or --demo for the portrait that comes along")
    if picture is None and not demo:
        if text is None and is_needed:
            raise InputError("name one picture to paint, --demo for the portrait that comes along, or a --text")
        return None
    return picture or demo_picture()


def weights_of(pairs: list[str]) -> dict[str, float]:
    """Return the weights by term, of pairs such as ``edges=0.5``."""
    weights: dict[str, float] = {}
    for pair in pairs:
        name, _, weight = pair.partition("=")
        if name in weights:
            raise InputError(f"--weight names {name} twice; leave one of them out")
        try:
            weights[name] = float(weight)
        except ValueError:
            raise InputError(f"--weight is {pair!r}; it must be a term and a number, as in edges=0.5") from None
    return weights


def crop_of(edges: str) -> Crop:
    """Return the edges of a crop."""
    try:
        left, top, right, bottom = (float(edge) for edge in edges.split(","))
    except ValueError:
        raise InputError(f"--crop is {edges!r}; it must be four shares of the picture, as in 0.1,0,0.9,1") from None
    return left, top, right, bottom


def layers_of(numbers: str | None) -> tuple[int, ...] | None:
    """Return the numbers of layers of CLIP, or None for the usual ones."""
    if numbers is None:
        return None
    try:
        return tuple(int(number) for number in numbers.split(","))
    except ValueError:
        raise InputError(f"--clip-layers is {numbers!r}; it must be numbers from 0, as in 2,3") from None
