import json
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ValidationError

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.painting.brush import (
    BRUSHES,
    Brush,
    built_in_brushes,
    in_painting_order,
    load_brush,
    load_brushes,
    write_brush,
)
from maulstick.rendering.traj2stroke import Traj2Stroke
from tests.support.tolerances import FLOAT32_VALUE

ROUNDING = 1e-12  # of float64
GOOD = {"name": "twig", "source": "a test", "alpha": 0.002, "beta": 0.001}
numbers = st.floats(-1, 1)


def test_four_brushes_come_with_maulstick() -> None:
    widths = {"fineliner": (1e-4, 2e-4), "marker": (4e-4, 2e-3), "round": (2e-4, 9e-3), "wash": (2e-3, 1e-2)}
    assert built_in_brushes() == list(widths)
    for name, (narrowest, broadest) in widths.items():
        brush = load_brush(name)
        assert brush.name == name
        assert "libmypaint" in brush.source, "it says where it comes from"
        assert narrowest < brush.thinnest <= brush.widest < broadest
        assert brush.pressure_matters == (name != "fineliner")


def test_brushes_of_one_painting_come_the_broadest_first_and_each_once() -> None:
    assert [brush.name for brush in load_brushes("fineliner, wash,marker")] == ["wash", "marker", "fineliner"]
    assert load_brushes("marker") == (load_brush("marker"),)
    with pytest.raises(InputError, match="the brush marker is named twice; a painting has each brush once"):
        load_brushes("marker,wash,marker")
    with pytest.raises(InputError, match=r"there is no brush ''; there are: FILE\.json, fineliner"):
        load_brushes("wash,")
    with pytest.raises(InputError, match="there is no brush to paint with"):
        in_painting_order([])


def test_half_width_is_a_line_in_pressure() -> None:
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


@given(pressure=st.floats(0, 1), name=st.sampled_from(["fineliner", "marker", "round"]))
def test_a_brush_that_is_held_draws_at_every_pressure_as_it_did_at_that_one(pressure: float, name: str) -> None:
    brush = load_brush(name)
    held = brush.held_at(pressure)
    assert not held.pressure_matters
    assert (held.m_x, held.b_x, held.falloff, held.plateau, held.lag) == (
        brush.m_x,
        brush.b_x,
        brush.falloff,
        brush.plateau,
        brush.lag,
    )
    line = torch.tensor([[[0.0, 0.0, pressure], [0.02, 0.01, pressure]]])
    there = Traj2Stroke.of([brush]).marks(line, 1000.0)
    here = Traj2Stroke.of([held]).marks(line.clone().index_fill_(2, torch.tensor([2]), 0.3), 1000.0)
    assert torch.allclose(here.thickness, there.thickness, rtol=FLOAT32_VALUE)
    assert torch.allclose(here.opacity, there.opacity, rtol=FLOAT32_VALUE)
    assert torch.allclose(here.points[..., :2], there.points[..., :2])


def test_a_brush_that_is_held_is_as_deep_as_that_pressure_and_says_so() -> None:
    brush = Brush.model_validate({**GOOD, "depth": (0.001, 0.005)})
    held = brush.held_at(0.25)
    assert held.depth == pytest.approx((0.002, 0.002), rel=ROUNDING)
    assert held.source == "a test; held at pressure 0.25"
    assert Brush.model_validate_json(held.model_dump_json()) == held


def test_a_brush_cannot_be_held_where_it_leaves_no_mark() -> None:
    with pytest.raises(InputError, match=r"the brush dry leaves no mark at pressure 0\.2; hold it deeper"):
        Brush(name="dry", source="a test", alpha=0.002, beta=-0.001).held_at(0.2)


def test_a_brush_cannot_be_held_where_its_mark_is_too_thin_to_be_told_from_none() -> None:
    with pytest.raises(InputError, match=r"the brush dry leaves no mark at pressure 0\.5"):
        Brush(name="dry", source="a test", alpha=0.002, beta=-0.000999999999).held_at(0.5)


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of own brushes, of which there are none yet."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return tmp_path / "maulstick" / "brushes"


def test_a_brush_is_read_from_a_file_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "twig.json"
    path.write_text(load_brush("round").model_dump_json())
    assert load_brush(str(path)) == load_brush("round")


@given(alpha=st.floats(0, 1e-2), beta=st.floats(1e-6, 1e-2), lag=st.floats(0, 1), b_x=numbers)
def test_a_brush_is_read_as_it_was_written(
    tmp_path_factory: pytest.TempPathFactory, alpha: float, beta: float, lag: float, b_x: float
) -> None:
    path = tmp_path_factory.mktemp("brushes") / "new" / "twig.json"
    brush = Brush(name="twig", source="a test", alpha=alpha, beta=beta, lag=lag, b_x=b_x)
    write_brush(brush, path)
    assert load_brush(str(path)) == brush


def test_an_own_brush_is_found_by_its_name(own: Path) -> None:
    assert BRUSHES.own() == own
    twig = Brush.model_validate(GOOD)
    write_brush(twig, own / "twig.json")
    assert load_brush("twig") == twig
    assert list(BRUSHES.paths()) == ["fineliner", "marker", "round", "wash", "twig"]
    assert built_in_brushes() == ["fineliner", "marker", "round", "wash"]
    with pytest.raises(InputError, match=r"there are: FILE\.json, fineliner, marker, round, twig, wash$"):
        load_brush("broom")


def test_an_own_brush_never_hides_a_built_in_one_and_needs_a_proper_name(own: Path) -> None:
    for name in ("round", "Round", "a b", "-a"):
        write_brush(Brush.model_validate(GOOD), own / f"{name}.json")
    assert list(BRUSHES.paths()) == ["fineliner", "marker", "round", "wash"]
    assert load_brush("round").name == "round"


@pytest.mark.parametrize("name", ["../x", "", "Twig", "a b", "-a", "a" * 41, "a.json", "twig\n"])
def test_a_name_that_could_be_a_path_is_refused(own: Path, name: str) -> None:
    with pytest.raises(InputError) as caught:
        BRUSHES.check_own_name(name, overwrite=True)
    allowed = "it must be up to 40 of a-z, 0-9 and -, beginning with a letter or a digit"
    assert str(caught.value) == f"the name of a brush is {name!r}; {allowed}"


def test_a_name_that_is_taken_is_refused_unless_it_may_be_overwritten(own: Path) -> None:
    assert BRUSHES.check_own_name("twig", overwrite=False) == "twig"
    write_brush(Brush.model_validate(GOOD), own / "twig.json")
    assert BRUSHES.check_own_name("twig", overwrite=True) == "twig"
    with pytest.raises(OutputError, match=r"^there is a brush twig already; choose another name"):
        BRUSHES.check_own_name("twig", overwrite=False)
    with pytest.raises(InputError, match=r"^the brush round comes with Maulstick; choose another name$"):
        BRUSHES.check_own_name("round", overwrite=True)


def test_of_two_that_take_one_name_at_the_same_moment_only_one_gets_it(
    own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refused, brush = [], Brush.model_validate(GOOD)

    def write_the_other() -> None:
        with pytest.raises(OutputError) as caught:
            write_brush(brush.model_copy(update={"source": "the other"}), own / "twig.json", overwrite=False)
        refused.append(str(caught.value))

    also, replaced = Thread(target=write_the_other), Path.replace

    def slowly(path: Path, target: Path) -> Path:
        if not also.ident:
            also.start()
            also.join(timeout=0.5)  # longer than it takes where nothing holds it up
        return replaced(path, target)

    monkeypatch.setattr(Path, "replace", slowly)
    write_brush(brush, own / "twig.json", overwrite=False)
    also.join()
    assert refused == ["there is a brush twig already; choose another name, or add overwrite"]
    assert load_brush("twig").source == "a test"


def test_a_brush_that_cannot_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("before")
    with pytest.raises(OutputError, match=r"cannot make the folder of brushes .*file"):
        write_brush(Brush.model_validate(GOOD), tmp_path / "file" / "twig.json")
    assert (tmp_path / "file").read_text() == "before"


def test_an_unknown_brush_is_refused_with_the_brushes_there_are(own: Path) -> None:
    with pytest.raises(InputError) as caught:
        load_brush("broom")
    assert str(caught.value) == "there is no brush 'broom'; there are: FILE.json, fineliner, marker, round, wash"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"alpha": -1}, "alpha: Input should be greater than or equal to 0 (got -1)"),
        ({"opacity": 1.5}, "opacity: Input should be less than or equal to 1 (got 1.5)"),
        ({"plateau": 1}, "plateau: Input should be less than 1 (got 1)"),
        ({"beta": float("nan")}, "beta: Input should be a finite number (got nan)"),
        ({"m_x": 0}, "m_x: Input should be greater than 0 (got 0)"),
        ({"beta": -0.002}, "alpha + beta is the half-width of the deepest stroke and must be above 0"),
        (
            {"alpha": 1.5, "beta": 0.5},
            "alpha + beta is 2 metres; it must be at most 0.1, so divide millimetres by 1000",
        ),
        ({"alpha": 0, "beta": 1e-40}, "must be above 0, at least 0.000001 metres"),
        ({"plateau": 0.99999999}, "plateau: it must be at most 0.999999 (got 0.99999999)"),
        ({"falloff": 1e-50}, "falloff: it must be at least 0.000001 (got 1e-50)"),
        ({"opacity": 1e-50}, "opacity: it must be at least 0.000001 (got 1e-50)"),
        ({"b_x": 1e40}, "b_x: Input should be less than or equal to 1000000 (got 1e+40)"),
        ({"hairs": 7}, "hairs: Extra inputs are not permitted (got 7)"),
        ({"name": ""}, "name: String should have at least 1 character (got '')"),
        ({"depth": [0, "deep"]}, "depth[1]: Input should be a valid number"),
        ({"source": "\x1b[31m"}, "source: a name must be made of printable characters"),
    ],
)
def test_a_bad_brush_file_is_refused_by_file_and_field(tmp_path: Path, change: dict[str, object], text: str) -> None:
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(GOOD | change))
    with pytest.raises(InputError) as caught:
        load_brush(str(path))
    assert str(caught.value).startswith(f"{path} is not a brush: ")
    assert text in str(caught.value)


def test_a_brush_file_that_is_missing_broken_or_huge_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no brush .*none\.json; check its name"):
        load_brush(str(tmp_path / "none.json"))
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"binary\.json is not a brush: the file: Invalid JSON: expected value"):
        load_brush(str(tmp_path / "binary.json"))
    (tmp_path / "huge.json").write_bytes(bytes(2**20 + 1))
    with pytest.raises(InputError, match=r"huge\.json is larger than 1 MiB, too large for a brush; name another"):
        load_brush(str(tmp_path / "huge.json"))
    (tmp_path / "half.json").write_text('{"name": "twi')
    with pytest.raises(InputError, match=r"half\.json is not a brush: the file: Invalid JSON: EOF .* column 13$"):
        load_brush(str(tmp_path / "half.json"))


def test_a_brush_that_does_not_say_where_it_comes_from_is_read() -> None:
    assert Brush.model_validate(GOOD | {"source": ""}).source == ""


def test_the_first_fault_names_the_field_and_shortens_what_came() -> None:
    class Model(BaseModel):
        rows: list[list[int]]

    with pytest.raises(ValidationError) as caught:
        Model(rows=[[1], [2, "x" * 100]])  # type: ignore[list-item]
    text = validation_fault(caught.value)
    assert text.startswith("rows[1][1]: Input should be a valid integer")
    assert text.endswith("xxx...)")
    assert len(text) < 160


@given(half_widths=st.lists(st.floats(0, 0.02), min_size=1, max_size=5))
def test_the_pressure_for_a_half_width_draws_it_where_a_pressure_can(half_widths: list[float]) -> None:
    brush = Brush.model_validate(GOOD | {"alpha": 0.006, "beta": 0.001, "curve": (0.1, 0.15, 0.2, 0.3, 0.45, 0.6, 0.8)})
    drawn = brush.half_width(brush.pressure_for(np.array(half_widths)))
    assert drawn == pytest.approx(np.clip(half_widths, 0.001, 0.007), abs=1e-12)


def test_a_pen_that_can_only_be_lifted_is_pressed_as_lightly_as_can_be() -> None:
    pen = Brush.model_validate(GOOD | {"alpha": 0.0, "beta": 0.001})
    assert np.array_equal(pen.pressure_for(np.array([0.0, 0.001, 0.01])), np.zeros(3))


def test_the_mark_of_a_path_whose_ends_are_repeated_is_as_broad_as_it_is_drawn() -> None:
    brush = Brush.model_validate({**GOOD, "nib": (0.3, -0.4)})
    path = np.array([(0, 0), (0, 0), (0, 0), (0.01, 0.002), (0.02, 0.01), (0.02, 0.01), (0.02, 0.01)])
    trajectory = np.column_stack([path, np.full(len(path), 0.5)])
    drawn = Traj2Stroke.of([brush]).marks(torch.from_numpy(trajectory).float()[None], 1.0)
    assert brush.bare_mark(trajectory)[1] == pytest.approx(drawn.thickness[0].numpy(), rel=1e-5)


@pytest.mark.parametrize(("pressure", "opacity"), [(0.0, 0.32), (0.25, 0.56), (0.5, 0.8), (1.0, 0.8)])
def test_a_stroke_is_as_opaque_by_its_number_as_a_held_brush_and_as_it_is_drawn(
    pressure: float, opacity: float
) -> None:
    brush = load_brush("round").model_copy(update={"opacity": 0.8, "faint": 0.4, "solid": 0.5})
    assert brush.opacity_at(pressure) == pytest.approx(opacity)
    trajectory = np.array([[0.01, 0.01, pressure], [0.03, 0.02, pressure]])
    drawn = Traj2Stroke.of([brush]).marks(torch.tensor(trajectory[None], dtype=torch.float32), 1000.0)
    assert brush.bare_mark(trajectory)[2] == pytest.approx(drawn.opacity.item(), rel=FLOAT32_VALUE)
    assert brush.held_at(max(pressure, 0.01)).opacity == pytest.approx(brush.opacity_at(max(pressure, 0.01)))
