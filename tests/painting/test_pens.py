from pathlib import Path

import numpy as np
import pytest
import torch

from maulstick.errors import InputError
from maulstick.painting.brush import BRUSHES, Brush, load_brush, load_pen_brush, write_brush
from maulstick.painting.pens import PENS, load_pen
from maulstick.rendering.kernels.reference import darkness
from tests.support.tolerances import PEN_WIDTH

MINE = '{"maker": "Nobody", "model": "test 0.7", "kind": "gel pen", "width": 0.0007, "colour": "#1A33B2"}'


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the user's own pens."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    PENS.own().mkdir(parents=True)
    return PENS.own()


def width_of(brush: Brush) -> float:
    """Width of its line where it is half as dark as in its middle, metres, as it is drawn."""
    fine = 20e-6  # metres per pixel
    line = torch.tensor([[[10.0, 50.0], [90.0, 50.0]]])
    thickness = torch.full((1, 2), brush.widest / fine)
    image = darkness(
        line, thickness, torch.tensor([brush.falloff]), torch.tensor([brush.plateau]), torch.tensor([brush.opacity]),
        height=100, width=100,
    )  # fmt: skip
    across = image[0, :, 50].numpy()
    rows = np.arange(100) + 0.5
    top = np.interp(across.max() / 2, across[:50], rows[:50])
    return float(2 * (50 - top) * fine)


@pytest.mark.parametrize("name", sorted(path.stem for path in PENS.built_in.glob("*.json")))
def test_every_pen_draws_a_line_as_wide_as_its_maker_states(name: str) -> None:
    pen = load_pen(name)
    brush, colour = load_pen_brush(name)
    assert (brush.name, brush.pressure_matters, colour) == (name, False, "#000000")
    assert width_of(brush) == pytest.approx(pen.width, abs=PEN_WIDTH)
    assert load_brush(name) == brush
    assert f"{1e3 * pen.width:g} mm as its maker states it" in brush.source


def test_ones_own_pens_join_the_catalogue(own: Path) -> None:
    (own / "test-07.json").write_text(MINE)
    brush, colour = load_pen_brush("test-07")
    assert colour == "#1A33B2"
    assert width_of(brush) == pytest.approx(7e-4, abs=PEN_WIDTH)


def test_a_fitted_brush_of_constant_width_is_a_pen_and_another_is_none() -> None:
    write_brush(Brush(name="biro", source="photographs", alpha=0, beta=3e-4), BRUSHES.own() / "biro.json")
    assert load_pen_brush("biro") == (load_brush("biro"), None)
    with pytest.raises(InputError, match="the width of the brush round varies with pressure, so it is no pen"):
        load_pen_brush("round")


def test_a_fitted_pen_comes_before_that_of_its_name_in_the_catalogue_and_has_its_colour() -> None:
    path, fitted = BRUSHES.own() / "micron-01.json", Brush(name="micron-01", source="photographs", alpha=0, beta=3e-4)
    write_brush(fitted, path)
    assert load_pen_brush("micron-01") == (fitted, "#000000")
    assert load_brush("micron-01") == fitted
    write_brush(fitted.model_copy(update={"alpha": 1e-4}), path)
    with pytest.raises(InputError, match="the width of the brush micron-01 varies with pressure, so it is no pen"):
        load_pen_brush("micron-01")


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (MINE.replace("0.0007", "7"), r"width: Input should be less than or equal to 0.1 \(got 7\)"),
        (MINE.replace("0.0007", "0"), "width: Input should be greater than 0"),
        (MINE.replace("0.0007", "1e-9"), r"width: it must be at least 0.000010 metres \(got 1e-09\)"),
        (MINE.replace("#1A33B2", "blue"), "colour: "),
        (MINE.replace('"Nobody"', '"No\\nbody"'), "printable"),
        ("{}", "maker: Field required"),
        ("pen", "is not a pen"),
    ],
)
def test_a_file_that_is_no_pen_says_so_in_one_line(own: Path, content: str, text: str) -> None:
    (own / "test-07.json").write_text(content)
    with pytest.raises(InputError, match=text) as error:
        load_pen_brush("test-07")
    assert "\n" not in str(error.value)


def test_a_pen_that_there_is_not_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InputError, match="there is no pen 'quill'; there are: a brush of constant width, micron-005"):
        load_pen_brush("quill")
