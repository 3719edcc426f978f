"""Sheet of a plan in the studio: turned, filled and sketched as suits the picture's shape."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.edit import NO_EDIT, PictureEdit
from maulstick.painting.raster import parse_size
from maulstick.studio.state.placing import AS_SUITS, Placing
from maulstick.studio.workers.sketch import sketch

JPEG_STEPS = 12  # of 255, by which a JPEG of smooth pictures may be off


@pytest.mark.parametrize(
    ("size", "turned", "picture", "placed"),
    [
        ("200x160mm", AS_SUITS, (500, 400), "160x200mm"),
        ("200x160mm", AS_SUITS, (400, 500), "200x160mm"),
        ("200x160mm", AS_SUITS, (400, 400), "200x160mm"),
        ("200x160mm", AS_SUITS, None, "200x160mm"),
        ("200x160mm", "standing", (400, 500), "160x200mm"),
        ("A4", AS_SUITS, (400, 500), "A4-landscape"),
        ("A4", AS_SUITS, (500, 400), "A4"),
        ("A4", "lying", None, "A4-landscape"),
        ("17 by 23 cm", AS_SUITS, (3, 4), "230x170mm"),
        ("8x10in", "lying", (4, 3), "254x203.2mm"),
        ("letter", "lying", (4, 3), "LETTER-landscape"),
    ],
)
def test_a_sheet_is_turned_as_is_said(size: str, turned: str, picture: tuple[int, int] | None, placed: str) -> None:
    assert Placing.of(size, turned, "contain", 0, picture).size == placed


@pytest.mark.parametrize(
    ("picture", "margin", "fit"),
    [((500, 400), 0, "cover"), ((600, 400), 0, "cover"), ((400, 400), 0, "contain"), ((900, 1600), 0, "contain"),
     ((400, 400), 70, "contain"), ((10, 9), 30, "contain"), ((7, 5), 30, "cover")],
)  # fmt: skip
def test_a_picture_fills_the_sheet_where_little_of_it_is_cut_off(
    picture: tuple[int, int], margin: float, fit: str
) -> None:
    assert Placing.of("200x160mm", AS_SUITS, AS_SUITS, margin, picture).fit == fit
    assert Placing.of("200x160mm", AS_SUITS, "cover", margin, picture).fit == "cover"


@given(
    st.tuples(st.floats(5, 900), st.floats(5, 900)),
    st.sampled_from([AS_SUITS, "standing", "lying"]),
    st.integers(1, 5000),
    st.integers(1, 5000),
)
def test_what_was_placed_can_be_planned_and_has_the_same_sides(
    sides: tuple[float, float], turned: str, height: int, width: int
) -> None:
    size = "x".join(f"{side:.2f}" for side in sides) + "mm"
    placed = Placing.of(size, turned, AS_SUITS, 0, (height, width))
    options = PlanOptions(size=placed.size, fit=placed.fit, margin=placed.margin)
    assert sorted(parse_size(options.size)) == pytest.approx(sorted(parse_size(size)), rel=1e-5)


@pytest.mark.parametrize(("size", "margin"), [("large", 0), ("", 0), ("170 by 230", 0), ("A6", 60), ("A6", -1)])
def test_a_sheet_that_cannot_be_is_refused(size: str, margin: float) -> None:
    with pytest.raises(InputError):
        Placing.of(size, AS_SUITS, AS_SUITS, margin, None)


@pytest.fixture
def gradient(tmp_path: Path) -> Path:
    down, across = np.mgrid[:60, :40].astype(np.float64)
    pixels = np.stack([down / 60, across / 40, 0.5 + 0 * down], axis=2)
    Image.fromarray((pixels * 255).astype(np.uint8)).save(tmp_path / "small.png")
    return tmp_path / "small.png"


@pytest.mark.parametrize("fit", ["contain", "cover"])
@pytest.mark.parametrize(
    "edit", [NO_EDIT, PictureEdit(rotate=270, straighten=5, crop=(0.2, 0, 1, 0.7), exposure=0.5, contrast=1.4)]
)
def test_a_sketch_shows_what_is_planned(gradient: Path, edit: PictureEdit, fit: str) -> None:
    made = sketch(gradient, edit, "160x200mm", fit, "12mm")
    options = PlanOptions(size="160x200mm", fit=fit, margin="12mm", brush="fineliner", px=200, **vars(edit))
    target = prepare(PlanRequest(gradient, options)).layout.target
    assert target is not None
    with Image.open(io.BytesIO(made.sheet)) as sheet:
        seen = np.asarray(sheet.resize(target.shape[1::-1], Image.Resampling.BOX), dtype=np.float64)
    off = np.abs(seen - 255 * target)
    assert np.quantile(off, 0.95) < JPEG_STEPS  # but for the edges of the picture
    with Image.open(io.BytesIO(made.picture)) as whole:
        assert whole.size == ((40, 60) if edit == NO_EDIT else (60, 40))


@pytest.mark.parametrize(
    ("size", "fit", "margin", "told"),
    [
        ("160x240mm", "contain", "0mm", "160 by 240 mm."),
        ("160x200mm", "contain", "0mm", "160 by 200 mm. Bare paper: 13 mm left and right."),
        ("160x200mm", "cover", "0mm", "160 by 200 mm. 17% of the picture is cut off, half of it above, half below."),
        ("180x260mm", "contain", "10mm", "180 by 260 mm. 10 mm of bare paper all around."),
        ("300x160mm", "contain", "10mm", "300 by 160 mm. Bare paper: 103 mm left and right, 10 mm above and below."),
        ("100x240mm", "cover", "0mm", "100 by 240 mm. 38% of the picture is cut off, half of it left, half right."),
    ],
)
def test_a_sketch_tells_what_stays_bare_and_what_is_cut_off(
    gradient: Path, size: str, fit: str, margin: str, told: str
) -> None:
    assert sketch(gradient, NO_EDIT, size, fit, margin).told == f"A sheet of {told}"
