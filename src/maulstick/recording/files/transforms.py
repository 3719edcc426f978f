"""Transforms of SVG elements: of their attribute or property, and of CSS's own properties for each kind of move."""

import re
from math import tau

import numpy as np
from svgelements import Matrix  # type: ignore[import-untyped]

from maulstick.recording.files.css import Style
from maulstick.recording.files.lengths import FONT_UNITS, pixels
from maulstick.storage.arrays import Floats

_PPI = 96  # pixels per inch, as CSS has it
_SIDES = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_OF_A_FONT = re.compile(rf"{_NUMBER}(?:{'|'.join(FONT_UNITS)})\b", re.IGNORECASE)
_SHARE = re.compile(rf"({_NUMBER})(%?)")
_TURN = re.compile(rf"({_NUMBER})(deg|grad|rad|turn)|0")
_OUT_OF_THE_PAGE = re.compile(r"^(?:z|0\s+0\s+1)\s+|\s+(?:z|0\s+0\s+1)$")  # the axis of a turn in it
_WHOLE_TURN = {"deg": 360.0, "grad": 400.0, "rad": tau, "turn": 1.0}
_NO_LENGTH = re.compile(rf"{_NUMBER}")  # which CSS takes for none, but 0


def transform_of(style: Style, width: float, height: float, origin: str = "") -> Matrix:
    """Return the matrix of all transforms that an element with these properties has, about their origin.

    width, height: what percentages are of.  origin: the usual one.  A part that is faulty is none, as in browsers.
    """
    matrix = _listed(style.get("transform", ""), width, height)
    matrix *= _scaled(style.get("scale", "")) * _turned(style.get("rotate", ""))
    matrix *= _shifted(style.get("translate", ""), width, height)
    x, y = _origin(style.get("transform-origin", origin), width, height)
    return Matrix.translate(-x, -y) * matrix * Matrix.translate(x, y)


def is_relative(transform: str) -> bool:
    """Return whether a list of functions has lengths that svgelements cannot tell: shares, and those of a font."""
    return "%" in transform or _OF_A_FONT.search(transform) is not None


def moved(points: Floats, m: Matrix) -> Floats:
    """Return points (..., 2) where a matrix takes them."""
    there: Floats = points @ np.array([[m.a, m.b], [m.c, m.d]]) + np.array([m.e, m.f])
    return there


def _listed(text: str, width: float, height: float) -> Matrix:
    """Return the matrix of a list of functions, such as ``translate(5 0) rotate(90)``."""
    if not text:
        return Matrix()
    try:
        matrix = Matrix(_OF_A_FONT.sub(lambda length: repr(pixels(length[0])), text))
        matrix.render(ppi=_PPI, width=width, height=height)
        return Matrix(*(float(matrix[i]) for i in range(6)))
    except (ValueError, TypeError, IndexError):
        return Matrix()


def _scaled(text: str) -> Matrix:
    """Return the matrix of a property such as ``2`` or ``150% 1``."""
    found = [_SHARE.fullmatch(word) for word in text.lower().split()]
    shares = [float(each[1]) / (100 if each[2] else 1) for each in found if each]
    if not 1 <= len(shares) == len(found) <= 3:
        return Matrix()
    return Matrix.scale(shares[0], shares[1 if len(shares) > 1 else 0])


def _turned(text: str) -> Matrix:
    """Return the matrix of a property such as ``90deg``, ``z .25turn`` or ``.25turn 0 0 1``."""
    match = _TURN.fullmatch(_OUT_OF_THE_PAGE.sub("", text.lower().strip(), count=1))
    return (
        Matrix() if match is None or match[1] is None else Matrix.rotate(tau * float(match[1]) / _WHOLE_TURN[match[2]])
    )


def _shifted(text: str, width: float, height: float) -> Matrix:
    """Return the matrix of a property such as ``10px`` or ``10% 5mm``."""
    words = text.lower().split()
    if not 1 <= len(words) <= 3 or any(_NO_LENGTH.fullmatch(word) and float(word) for word in words):
        return Matrix()
    x, y = (pixels(word, whole) for word, whole in zip([*words, "0"][:2], (width, height), strict=True))
    return Matrix() if x is None or y is None else Matrix.translate(x, y)


def _origin(text: str, width: float, height: float) -> tuple[float, float]:
    """Return the point of a transform-origin such as ``50 50``, ``50% 1cm`` or ``bottom right``, else (0, 0)."""
    words = [*(text.lower().split() or ("0", "0")), "center"][:2]
    if words[0] in ("top", "bottom") or words[1] in ("left", "right"):
        words.reverse()
    across, down = (_SIDES.get(word, word) for word in words)
    x, y = pixels(across, width), pixels(down, height)
    return (0.0, 0.0) if x is None or y is None else (x, y)
