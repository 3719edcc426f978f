"""The table of stroke models counts the numbers that a fit trained."""

from importlib import import_module
from pathlib import Path

import pytest

from maulstick.painting.brush import CURVE_PRESSURES, Brush

SEVEN = Brush(
    name="seven",
    source="a test",
    m_x=1.01,
    b_y=2e-4,
    alpha=1e-3,
    beta=5e-4,
    falloff=0.8,
    opacity=0.9,
    depth=(0.0, 2e-3),
    lightest=0.1,
)
BEYOND = {
    "plateau": 0.5,
    "curve": tuple(pressure**2 for pressure in CURVE_PRESSURES),
    "lag": 1e-3,
    "touch": (1e-4, 2e-4),
    "nib": (0.2, 0.1),
    "faint": 0.5,
    "solid": 0.6,
}


@pytest.mark.parametrize(("names", "count"), [((), 0), (("plateau",), 1), (tuple(BEYOND), 15)])
def test_numbers_beyond_the_paper_s_are_counted_and_what_its_strokes_were_is_not(
    monkeypatch: pytest.MonkeyPatch, names: tuple[str, ...], count: int
) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "experiments"))
    added = import_module("stroke_models")._added
    assert added(SEVEN.model_copy(update={name: BEYOND[name] for name in names})) == count
