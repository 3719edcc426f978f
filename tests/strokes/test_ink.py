from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.errors import InputError, OutputError
from maulstick.storage.arrays import VERSION, Floats, write_arrays
from maulstick.strokes.ink import Ink, read_ink, write_ink

SHEET = (0.2, 0.15)

places = st.floats(-10, 10)
sides = st.floats(0, 100, exclude_min=True)
names = st.text(st.characters(categories=("L", "N", "P")), max_size=9)


@st.composite
def strokes(draw: st.DrawFn) -> Floats:
    samples = draw(arrays(np.float64, (draw(st.integers(1, 6)), 4), elements=st.floats(0, 1)))
    samples[:, 1:3] = draw(arrays(np.float64, (len(samples), 2), elements=places))
    samples[:, 0] = np.nan if draw(st.booleans()) else np.sort(samples[:, 0])
    if draw(st.booleans()):
        samples[:, 3] = np.nan
    return samples


inks = st.builds(Ink.of, st.lists(strokes(), max_size=5), st.tuples(sides, sides), names)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("ink")


def a_stroke(samples: int = 3, **columns: object) -> Floats:
    """A stroke one millimetre a sample to the right, with columns t, x, y or pressure changed."""
    stroke = np.full((samples, 4), np.nan)
    stroke[:, 1], stroke[:, 2] = 1e-3 * np.arange(samples), 0.01
    for column, name in enumerate(("t", "x", "y", "pressure")):
        if name in columns:
            stroke[:, column] = columns[name]
    return stroke


def fault(*strokes: Floats, size: tuple[float, float] = SHEET) -> str:
    with pytest.raises(InputError) as caught:
        Ink.of(strokes, size)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@settings(max_examples=60, deadline=None)
@given(inks)
def test_ink_is_equal_to_that_in_its_file(folder: Path, ink: Ink) -> None:
    write_ink(ink, folder / "first.ink.npz")
    again = read_ink(folder / "first.ink.npz")
    assert np.array_equal(again.samples, ink.samples, equal_nan=True)
    assert np.array_equal(again.lengths, ink.lengths)
    assert (again.size, again.source) == (ink.size, ink.source)
    write_ink(again, folder / "second.ink.npz")
    assert (folder / "second.ink.npz").read_bytes() == (folder / "first.ink.npz").read_bytes()


@given(st.lists(strokes(), max_size=5))
def test_ink_gives_back_the_strokes_that_it_is_made_of(made: list[Floats]) -> None:
    ink = Ink.of(made, SHEET)
    assert len(ink) == len(made) == len(ink.strokes())
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(ink.strokes(), made, strict=True))


def test_ink_without_strokes_is_ink(tmp_path: Path) -> None:
    ink = Ink.of([], SHEET)
    assert (len(ink), ink.strokes(), ink.samples.shape) == (0, [], (0, 4))
    write_ink(ink, tmp_path / "empty.ink.npz")
    assert len(read_ink(tmp_path / "empty.ink.npz")) == 0


def test_a_dot_is_a_stroke_of_one_sample() -> None:
    ink = Ink.of([a_stroke(1), a_stroke(3), a_stroke(1, pressure=0.5)], SHEET)
    assert ink.lengths.tolist() == [1, 3, 1]
    assert [len(stroke) for stroke in ink.strokes()] == [1, 3, 1]


def test_times_may_stand_still_and_begin_again_with_the_next_stroke() -> None:
    assert len(Ink.of([a_stroke(t=[1, 1, 2]), a_stroke(t=[0, 1, 1]), a_stroke()], SHEET)) == 3


def test_times_that_run_backwards_are_refused() -> None:
    text = "the times of a stroke run backwards; they must never fall from sample to sample"
    assert fault(a_stroke(t=[0, 2, 1])) == text
    assert fault(a_stroke(), a_stroke(t=[0, 0, -1e-9]), a_stroke(t=[0, 1, 2])) == text


@pytest.mark.parametrize(("column", "name"), [("t", "times"), ("pressure", "pressure")])
@pytest.mark.parametrize("values", [[0, np.nan, 1], [np.nan, np.nan, 0], [0, 0, np.inf], [-np.inf] * 3])
def test_what_is_known_at_a_part_of_a_stroke_is_refused(column: str, name: str, values: list[float]) -> None:
    text = f"the {name} of a stroke must be known at all of its samples, or NaN at all of them"
    assert fault(a_stroke(), a_stroke(**{column: values}), a_stroke()) == text


def test_a_pressure_outside_its_range_is_refused() -> None:
    assert fault(a_stroke(pressure=[0, 0.5, 1.25]), a_stroke()) == "pressure is 0 to 1.25; it must be in [0, 1]"
    assert fault(a_stroke(pressure=[-0.5, 0, 1])) == "pressure is -0.5 to 1; it must be in [0, 1]"


@pytest.mark.parametrize("place", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("column", ["x", "y"])
def test_a_sample_without_a_place_is_refused(column: str, place: float) -> None:
    text = "a sample of the ink has no place; every x and y must be a finite number of metres"
    assert fault(a_stroke(**{column: [0, place, 0]})) == text


@pytest.mark.parametrize("size", [(0, 1), (1, 0), (-1, 1), (1, 100.5), (np.nan, 1), (1, np.inf)])
def test_a_sheet_without_sense_is_refused(size: tuple[float, float]) -> None:
    assert fault(size=size) == f"the sheet of the ink is {size} m; it must be between 0 and 100 m wide and high"


@pytest.mark.parametrize("lengths", [[], [2], [4], [0, 3], [-1, 4], [[3]], [2**62 + 1, 2**62, 2**62, 2**62 + 2]])
def test_lengths_that_do_not_divide_the_samples_are_refused(lengths: list[Any]) -> None:
    with pytest.raises(InputError) as caught:
        Ink(a_stroke(3), np.array(lengths, dtype=np.int64), SHEET)
    text = "the lengths of the strokes must be at least 1 each and add up to the number of samples"
    assert str(caught.value) == text


def test_samples_of_another_shape_are_refused() -> None:
    for shape in ((3, 3), (4,), (1, 3, 4)):
        with pytest.raises(InputError) as caught:
            Ink(np.zeros(shape), np.array([3]), SHEET)
        assert str(caught.value) == f"samples of ink have shape {shape}; it must be (P, 4) of (t, x, y, pressure)"


def test_ink_that_cannot_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="its folder does not exist; make the folder first"):
        write_ink(Ink.of([], SHEET), tmp_path / "none" / "cat.ink.npz")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"samples": np.zeros((3, 3))}, "samples of ink have shape (3, 3); it must be (P, 4) of (t, x, y, pressure)"),
        ({"samples": np.array(["a"])}, "could not convert string to float: "),
        ({"lengths": np.array([3.0])}, "the lengths of its strokes are float64; they must be whole numbers"),
        ({"lengths": np.array([np.nan])}, "the lengths of its strokes are float64; they must be whole numbers"),
        ({"lengths": np.array(3)}, "the lengths of the strokes must be at least 1 each and add up to the number"),
        ({"size": np.zeros(2)}, "the sheet of the ink is (0.0, 0.0) m; it must be between 0 and 100 m wide and high"),
        ({"size": np.ones(3)}, "its size has shape (3,); it must be (2,) of width and height"),
        ({"size": np.array(1.0)}, "its size has shape (); it must be (2,) of width and height"),
    ],
)
def test_a_file_with_a_fault_is_refused_by_its_name(tmp_path: Path, change: dict[str, Any], text: str) -> None:
    path = tmp_path / "cat.ink.npz"
    fields = {"samples": a_stroke(3), "lengths": np.array([3]), "size": np.array(SHEET), "source": np.array("cat")}
    write_arrays(path, "ink", fields)
    assert len(read_ink(path)) == VERSION == 1
    write_arrays(path, "ink", {**fields, **change})
    with pytest.raises(InputError) as caught:
        read_ink(path)
    assert str(caught.value).startswith(f"{path} is not a file of ink: {text}")
    assert "\n" not in str(caught.value)


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    write_arrays(tmp_path / "cat.npz", "strokes", {})
    with pytest.raises(InputError) as caught:
        read_ink(tmp_path / "cat.npz")
    assert str(caught.value) == f"{tmp_path / 'cat.npz'} holds strokes; it must be a file of ink"


def test_a_summary_says_what_there_is() -> None:
    long = a_stroke(101, t=np.linspace(0, 90, 101), x=np.linspace(0, 0.15, 101), pressure=0.5)
    sheet = "drawn on 200 x 150 mm"
    assert Ink.of([], SHEET).summary() == f"0 strokes, 0 m {sheet}"
    assert (
        Ink.of([a_stroke()], SHEET).summary() == f"1 stroke, 0.002 m {sheet}, times not recorded, pressure not recorded"
    )
    assert Ink.of([long], SHEET).summary() == f"1 stroke, 0.15 m {sheet}, 1 min 30 s, pressure recorded"
    nearly = Ink.of([a_stroke(101, t=np.linspace(0, 119.7, 101))], SHEET).summary()
    assert ", 2 min 0 s, " in nearly
    both = Ink.of([long, a_stroke(t=5)], SHEET).summary()
    assert both == f"2 strokes, 0.152 m {sheet}, 1 min 30 s, pressure recorded in 1 of them"
    assert Ink.of([a_stroke(2, x=[0, 1234])], SHEET).summary().startswith("1 stroke, 1234 m drawn on")
    assert Ink.of([a_stroke(2, t=[1, 30.46])], SHEET).summary().endswith("29.5 s, pressure not recorded")
