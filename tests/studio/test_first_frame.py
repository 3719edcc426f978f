"""Picture of a painting that is there at once."""

from io import BytesIO

import numpy as np
from PIL import Image

from maulstick.painting.painting import Stroke
from maulstick.studio.workers.first_frame import first_frame
from tests.support.nominal import nominal
from tests.support.robot.small_paintings import HEIGHT, RED, WIDTH, painting_of


def test_a_broad_stroke_of_many_points_has_no_notches() -> None:
    angles = np.linspace(0.2, 2.8, 80)
    path = np.stack([0.03 - 0.015 * np.cos(angles), 0.03 - 0.015 * np.sin(angles)], axis=1)
    stroke = Stroke(id=1, paint=0, trajectory=tuple((x, y, 1.0) for x, y in path.tolist()))
    brush = nominal("round")
    points, widths, _ = brush.bare_mark(np.array(stroke.trajectory))
    picture = np.asarray(Image.open(BytesIO(first_frame(painting_of([stroke], [brush])))), dtype=np.float64) / 255
    high, wide, _ = picture.shape
    y, x = np.mgrid[:high, :wide] + 0.5
    pixels = np.stack([x * WIDTH / wide, y * HEIGHT / high], axis=2)
    away = np.min([np.linalg.norm(pixels - point, axis=2) for point in points], axis=0)
    inside = away < widths.mean() - 10 * WIDTH / wide  # farther than a JPEG blurs an edge
    assert inside.sum() > 0.1 * high * wide
    assert np.abs(picture[inside] - RED).max() < 0.1
