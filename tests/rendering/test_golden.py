"""Pictures that a person has looked at and found right; drawn again they stay as they were.

After a change that is meant, draw them anew with ``python -m tests.rendering.test_golden`` and look at them.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from maulstick.painting.brush import built_in_brushes, load_brush
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.raster import Canvas
from maulstick.rendering.preview import preview
from tests.support.tolerances import GOLDEN_MEAN, GOLDEN_WORST

GOLDEN = Path(__file__).parent / "golden"
COLOURS = {
    "fineliner": (0.1, 0.1, 0.1),
    "marker": (0.0, 0.25, 0.6),
    "round": (0.85, 0.35, 0.1),
    "wash": (0.3, 0.5, 0.35),
}


def spiral(turns: float, pressure: tuple[float, float]) -> NDArray[np.float64]:
    t = np.linspace(0, 1, 32)
    angle, radius = 2 * np.pi * turns * t, 0.004 + 0.012 * t
    return np.stack([0.03 + radius * np.cos(angle), 0.02 + radius * np.sin(angle), np.linspace(*pressure, 32)], axis=1)


def painting_with(brush: str) -> Painting:
    """A light and a pressed line that cross, a spiral of growing pressure, and a dot."""
    lines = [
        [(0.005, 0.008, 0.0), (0.055, 0.032, 0.0)],
        [(0.005, 0.032, 1.0), (0.055, 0.008, 0.2)],
        spiral(1.7, (0.0, 0.6)).tolist(),
        [(0.052, 0.020, 0.5)],
    ]
    strokes = [Stroke.model_validate({"id": i, "paint": i % 2, "trajectory": line}) for i, line in enumerate(lines)]
    paints = (Paint(colour=COLOURS[brush], brush=brush), Paint(colour=(0.95, 0.8, 0.2), brush=brush))
    return Painting(
        sheet=Sheet(width=0.06, height=0.04, paper=(0.97, 0.96, 0.92)),
        provenance=Provenance(version="0"),
        brushes={brush: load_brush(brush)},
        paints=paints,
        strokes=tuple(strokes),
    )


def drawn(brush: str) -> NDArray[np.uint8]:
    image = preview(painting_with(brush), Canvas.of_height((0.06, 0.04), 160))
    return np.round(image * 255).astype(np.uint8)


@pytest.mark.parametrize("brush", built_in_brushes())
def test_a_built_in_brush_draws_what_it_always_drew(brush: str, tmp_path: Path) -> None:
    now, before = drawn(brush), np.asarray(Image.open(GOLDEN / f"{brush}.png"))
    difference = np.abs(now.astype(int) - before)
    if difference.max() > GOLDEN_WORST or difference.mean() > GOLDEN_MEAN:
        report = tmp_path / f"{brush}.png"
        amplified = np.clip(difference * 8, 0, 255).astype(np.uint8)
        Image.fromarray(np.concatenate([before, now, amplified], axis=1)).save(report)
        pytest.fail(f"worst {difference.max()}, mean {difference.mean():.3f}; golden, now and difference x 8: {report}")


if __name__ == "__main__":
    for name in built_in_brushes():
        Image.fromarray(drawn(name)).save(GOLDEN / f"{name}.png")
