import numpy as np

from maulstick.jobs.practice import practice, room_around
from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.style import load_style
from tests.support.nominal import nominal
from tests.support.tolerances import FILE_METRES


def test_practice_is_apart_in_the_style_and_presses_from_lightly_to_hard() -> None:
    brush, sheet = nominal("marker"), Sheet(width=0.2, height=0.15)
    painting = practice(load_style("loops", Canvas(sheet.width, sheet.height, 1.0)), brush, sheet, 12, seed=3)
    paths = painting.trajectories()
    assert [stroke.id for stroke in painting.strokes] == list(range(12))
    assert (paths[..., 2].min() < 0.2, paths[..., 2].max()) == (True, 1.0)
    assert np.ptp(paths[..., 2], axis=1).max() > 0.1
    low, high = paths[..., :2].min(axis=1) - room_around(brush), paths[..., :2].max(axis=1) + room_around(brush)
    assert (low > -FILE_METRES).all()
    assert (high < np.array([sheet.width, sheet.height]) + FILE_METRES).all()
    apart = (low[:, None] > high[None] - FILE_METRES).any(axis=2)
    assert (apart | apart.T | np.eye(12, dtype=bool)).all()


def test_a_pen_that_only_lifts_practises_at_one_pressure_and_the_seed_decides() -> None:
    sheet = Sheet(width=0.2, height=0.15)
    style = load_style("loops", Canvas(sheet.width, sheet.height, 1.0))
    first, same, other = (practice(style, nominal("fineliner"), sheet, 5, seed=seed) for seed in (1, 1, 2))
    assert set(first.trajectories()[..., 2].ravel()) == {0.5}
    assert first == same
    assert first != other
