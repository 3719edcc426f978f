import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError

from maulstick.errors import InputError
from maulstick.medium import Brush, built_in_brushes, first_fault, load_brush

ROUNDING = 1e-12  # of float64
GOOD = {"name": "twig", "source": "a test", "alpha": 0.002, "beta": 0.001}
numbers = st.floats(-1, 1)


def test_three_brushes_come_with_maulstick() -> None:
    assert built_in_brushes() == ["fineliner", "marker", "round"]
    for name, thinnest, widest in (("fineliner", 0.15e-3, 0.15e-3), ("marker", 0.7e-3, 1.5e-3), ("round", 1e-3, 7e-3)):
        brush = load_brush(name)
        assert brush.name == name
        assert (brush.thinnest, brush.widest) == pytest.approx((thinnest, widest), rel=ROUNDING)
        assert brush.presses == (name != "fineliner")


def test_half_width_is_a_line_in_press() -> None:
    brush = Brush.model_validate(GOOD)
    assert brush.half_width(np.array([[0.0, 0.5, 1.0]])) == pytest.approx(
        np.array([[0.001, 0.002, 0.003]]), rel=ROUNDING
    )


def test_a_brush_that_leaves_no_mark_at_a_light_touch_is_thinnest_at_zero() -> None:
    assert Brush(name="dry", source="a test", alpha=0.002, beta=-0.001).thinnest == 0


def test_the_neutral_brush_marks_where_it_is_told_to() -> None:
    path = np.arange(12.0).reshape(4, 3)
    assert np.array_equal(Brush.model_validate(GOOD).mark(path), path)


@given(m_x=st.floats(0.5, 2), m_y=st.floats(0.5, 2), b=st.tuples(numbers, numbers), start=st.tuples(numbers, numbers))
def test_a_mark_is_scaled_about_its_first_commanded_point_and_moved(
    m_x: float, m_y: float, b: tuple[float, float], start: tuple[float, float]
) -> None:
    brush = Brush(name="bent", source="a test", alpha=0, beta=1e-3, m_x=m_x, m_y=m_y, b_x=b[0], b_y=b[1])
    standardised = np.array([[0.0, 0.0, 0.2], [0.1, 0.3, 0.9]])
    path = standardised + np.array([*start, 0.0])
    before = path.copy()
    marked = brush.mark(path)
    expected = standardised * (m_x, m_y, 1.0) + np.array([start[0] + b[0], start[1] + b[1], 0.0])
    assert marked == pytest.approx(expected, abs=ROUNDING)
    assert np.array_equal(path, before), "an argument was changed"
    assert np.array_equal(brush.mark(np.stack([path, path]))[1], marked), "a path of many is marked as one alone"


def test_a_brush_is_read_from_a_file_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "twig.json"
    path.write_text(load_brush("round").model_dump_json())
    assert load_brush(str(path)) == load_brush("round")


def test_an_unknown_brush_is_refused_with_the_brushes_there_are() -> None:
    with pytest.raises(InputError) as caught:
        load_brush("broom")
    assert str(caught.value) == "there is no brush 'broom'; there are: FILE.json, fineliner, marker, round"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"alpha": -1}, "alpha: Input should be greater than or equal to 0 (got -1)"),
        ({"opacity": 1.5}, "opacity: Input should be less than or equal to 1 (got 1.5)"),
        ({"plateau": 1}, "plateau: Input should be less than 1 (got 1)"),
        ({"beta": float("nan")}, "beta: Input should be a finite number (got nan)"),
        ({"m_x": 0}, "m_x: Input should be greater than 0 (got 0)"),
        ({"beta": -0.002}, "alpha + beta is the half-width of the deepest stroke and must be above 0"),
        ({"hairs": 7}, "hairs: Extra inputs are not permitted (got 7)"),
        ({"name": ""}, "name: String should have at least 1 character (got '')"),
        ({"depth": [0, "deep"]}, "depth[1]: Input should be a valid number"),
    ],
)
def test_a_bad_brush_file_is_refused_by_file_and_field(tmp_path: Path, change: dict[str, object], text: str) -> None:
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(GOOD | change))
    with pytest.raises(InputError) as caught:
        load_brush(str(path))
    assert str(caught.value).startswith(f"{path} is not a brush: ")
    assert text in str(caught.value)


def test_a_brush_file_that_is_missing_or_no_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no brush .*none\.json; check its name"):
        load_brush(str(tmp_path / "none.json"))
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"cannot read the brush .*binary\.json: .*codec can't decode"):
        load_brush(str(tmp_path / "binary.json"))
    (tmp_path / "half.json").write_text('{"name": "twi')
    with pytest.raises(InputError, match=r"half\.json is not a brush: the file: Invalid JSON: EOF while parsing"):
        load_brush(str(tmp_path / "half.json"))


def test_the_first_fault_names_the_field_and_shortens_what_came() -> None:
    class Model(BaseModel):
        rows: list[list[int]]

    with pytest.raises(ValidationError) as caught:
        Model(rows=[[1], [2, "x" * 100]])  # type: ignore[list-item]
    text = first_fault(caught.value)
    assert text.startswith("rows[1][1]: Input should be a valid integer")
    assert text.endswith("xxx...)")
    assert len(text) < 160
