"""Drawings of a few shapes."""

from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pytest

from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.read import Drawing, read_drawing
from maulstick.storage.arrays import Floats

SPACES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
)
PAGE = 'width="100mm" height="50mm" viewBox="0 0 100 50"'


class Read(Protocol):
    """Reads the body of an SVG of 100 x 50 mm, one user unit per millimetre; options are fields of `DrawingOptions`.

    The order of the file is kept.
    """

    def __call__(self, body: str, page: str = PAGE, **options: Any) -> Drawing: ...


@pytest.fixture
def read(tmp_path: Path) -> Read:
    def read(body: str, page: str = PAGE, **options: Any) -> Drawing:
        file = tmp_path / "drawing.svg"
        file.write_text(f"<svg {SPACES} {page}>{body}</svg>")
        return read_drawing(file, DrawingOptions(**{"keep_order": True, **options}))

    return read


def millimetres(drawing: Drawing) -> list[Floats]:
    """The points (k, 2) of each stroke, in the order of drawing."""
    return [1e3 * np.array(stroke.trajectory)[:, :2] for stroke in drawing.painting.strokes]


def points(drawing: Drawing) -> list[list[list[float]]]:
    """The same to a hundredth of a millimetre."""
    return [np.round(line, 2).tolist() for line in millimetres(drawing)]


def labels(drawing: Drawing) -> list[str]:
    return [paint.label for paint in drawing.painting.paints]
