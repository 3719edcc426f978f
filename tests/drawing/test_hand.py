from pathlib import Path

import numpy as np
import pytest
import shapely

from maulstick.drawing.hand import HatchingHand, hatched_by_hand
from maulstick.drawing.lines import lengths
from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError
from maulstick.jobs.paintable import read_paintable
from tests.drawing.conftest import PAGE, SPACES

SQUARE = shapely.Polygon([(0, 0), (0.1, 0), (0.1, 0.1), (0, 0.1)], [[(0.04, 0.04), (0.06, 0.04), (0.06, 0.06)]])
ANGLE = 0.6  # radians


def hand(bend: float, turns: float = 0.0) -> HatchingHand:
    """Strokes 10 to 20 mm long that wave, and lie all ways at first."""
    rng = np.random.default_rng(1)
    x = np.linspace(0, 1, 32)
    waves = np.stack([x, bend * np.sin(12 * x)], axis=1)
    sizes, ways = rng.uniform(0.01, 0.02, 50), rng.uniform(0, 2 * np.pi, 50)
    paths = [
        size * waves @ [[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]] for size, a in zip(sizes, ways, strict=True)
    ]
    return HatchingHand(np.array(paths), None, turns * rng.standard_normal(50)).levelled()


@pytest.mark.parametrize("bend", [0.0, 0.1, 0.3])
def test_a_hand_lays_as_much_ink_as_lines_would_and_none_outside(bend: float) -> None:
    lines = hatched_by_hand(hand(bend), SQUARE, 1e-3, ANGLE, np.random.default_rng(0))
    assert lengths(lines).sum() == pytest.approx(SQUARE.area / 1e-3, rel=0.08)
    assert shapely.covers(
        shapely.buffer(SQUARE, 1e-7), shapely.linestrings([line[[0, -1]] for line in lines[:1]])
    ).all()
    assert all(shapely.covers(shapely.buffer(SQUARE, 1e-7), shapely.LineString(line)) for line in lines)


def test_strokes_lie_along_the_rows_and_turn_as_the_hand_does() -> None:
    for turns, spread in ((0.0, 0.0), (0.3, 0.3)):
        lines = hatched_by_hand(hand(0.0, turns), SQUARE, 1e-3, ANGLE, np.random.default_rng(0))
        steps = np.array([line[-1] - line[0] for line in lines if len(line) > 1])
        ways = np.angle(np.exp(2j * (np.arctan2(steps[:, 1], steps[:, 0]) - ANGLE))) / 2
        assert np.std(ways) == pytest.approx(spread, abs=0.06)


def test_a_style_of_ours_hatches_the_same_each_time_and_otherwise_than_another(tmp_path: Path) -> None:
    file = tmp_path / "drawing.svg"
    file.write_text(f'<svg {SPACES} {PAGE}><rect x="10" y="10" width="30" height="20" fill="red"/></svg>')
    options = {name: DrawingOptions(hatch=1e-3, hatch_hand=name) for name in ("hatching", "elephant")}
    painting, again, other = (
        read_paintable(file, options[name]).painting for name in ("hatching", "hatching", "elephant")
    )
    assert painting.strokes == again.strokes != other.strokes
    assert len(painting.strokes) > 20
    assert {stroke.paint for stroke in painting.strokes} == {0}


def test_a_hand_needs_a_spacing_and_to_be_there(tmp_path: Path) -> None:
    file = tmp_path / "drawing.svg"
    file.write_text(f'<svg {SPACES} {PAGE}><path d="M0 0h9v9"/></svg>')
    with pytest.raises(InputError, match="hatch_hand hatches as densely as hatch says; give both"):
        read_paintable(file, DrawingOptions(hatch_hand="loops"))
    with pytest.raises(InputError, match="there is no style 'nobody'"):
        read_paintable(file, DrawingOptions(hatch=1e-3, hatch_hand="nobody"))


def test_a_hand_of_dots_does_not_hatch_for_ever() -> None:
    dots = HatchingHand(np.zeros((3, 32, 2)), None, np.zeros(1)).levelled()
    with pytest.raises(InputError, match="its hatching takes over 200000 strokes in one shape; hatch wider"):
        hatched_by_hand(dots, SQUARE, 1e-4, ANGLE, np.random.default_rng(0))
