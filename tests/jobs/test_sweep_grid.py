"""Grids: their cells, and the names of these."""

from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.jobs.plan.options import FILES, PlanOptions
from maulstick.jobs.sweep.grid import MOST_CELLS, grid_of
from maulstick.painting.painting_file import write_painting
from tests.support.planned import planned


def cells(axes: dict[str, Any], folder: Path = Path(), **options: Any) -> list[Any]:
    return grid_of({"axes": axes, "options": options}, "the grid").cells(folder)


def test_cells_are_all_combinations_the_last_axis_fastest_and_have_all_options() -> None:
    found = cells({"picture": ["a.png", "b.png"], "style": ["loops", "free"], "seed": [0, 1, 2]}, strokes=30)
    assert len(found) == 12
    assert [
        (cell.request.picture.name, cell.request.options.style, cell.request.options.seed) for cell in found[:4]
    ] == [
        ("a.png", "loops", 0),
        ("a.png", "loops", 1),
        ("a.png", "loops", 2),
        ("a.png", "free", 0),
    ]
    assert {cell.request.options.strokes for cell in found} == {30}
    assert len({cell.name for cell in found}) == 12


def test_values_of_python_are_those_of_a_file() -> None:
    python = cells(
        {"seed": np.arange(2), "crop": [(0, 0, 1, 1)]}, picture=Path("a.png"), weights={"edges": np.int64(2)}
    )
    assert python == cells({"seed": [0, 1], "crop": [[0, 0, 1, 1]]}, picture="a.png", weights={"edges": 2})


def test_names_of_cells_depend_on_their_own_values_alone() -> None:
    few = cells({"strokes": [10], "weights": [{}]}, picture="a.png")
    many = cells({"strokes": [10, 20], "weights": [{}, {"edges": 0.5}]}, picture="a.png")
    assert [cell.name for cell in few] == ["strokes-10_weights-none"]
    assert [cell.name for cell in many][:2] == ["strokes-10_weights-none", "strokes-10_weights-edges-0.5"]


def test_files_are_beside_the_grid_and_names_of_libraries_are_not_files(tmp_path: Path) -> None:
    brushes = ["mine.json", "wash, mine.json"]
    cell, several = cells({"style": ["loops"], "brush": brushes}, tmp_path, picture="photos/a.png", look="b.png")
    assert several.request.options.brush == f"wash,{tmp_path / 'mine.json'}"
    options = cell.request.options
    assert cell.request.picture == tmp_path / "photos" / "a.png"
    assert (options.look, options.brush, options.style) == (tmp_path / "b.png", str(tmp_path / "mine.json"), "loops")


def test_every_option_that_is_a_file_is_beside_the_grid(tmp_path: Path) -> None:
    write_painting(planned(), tmp_path / "file")
    kinds = get_type_hints(PlanOptions)
    assert sorted(FILES) == sorted(name for name, kind in kinds.items() if kind == Path | None)
    together = ("regions", "say", "guides")
    for names in (together, *((name,) for name in FILES if name not in together)):
        (cell,) = cells({"seed": [0]}, tmp_path, picture="a.png", **dict.fromkeys(names, "file"))
        assert {getattr(cell.request.options, name) for name in names} == {tmp_path / "file"}


def test_what_a_painting_has_settled_is_no_option_where_it_is_planned_again(tmp_path: Path) -> None:
    write_painting(planned(), tmp_path / "painting.json")
    with pytest.raises(
        InputError, match="again keeps the sheet, the paints and the pressure of the painting; leave out ink"
    ):
        cells({"again": ["painting.json"]}, tmp_path, picture="a.png", ink="black")


def test_long_texts_and_odd_letters_make_names_of_folders_that_differ() -> None:
    texts = ["a boat / at sea, " + "far " * 40 + end for end in ("out", "off")]
    names = [cell.name for cell in cells({"text": texts})]
    assert len(set(names)) == 2
    assert all(len(name) < 60 and "/" not in name and " " not in name for name in names)
    assert cells({"picture": ["../a.png"]})[0].name == "a.png"


def test_cells_never_share_a_folder_and_none_has_the_name_of_a_result() -> None:
    with pytest.raises(
        InputError, match=r"2 cells would share the folder a\.png; .* and files so that their names diff"
    ):
        cells({"picture": ["a.png", "../a.png"]})
    with pytest.raises(InputError, match=r"the folder of a cell would be sweep\.png, as a result is called; rename"):
        cells({"picture": ["a.png", "sweep.png"]})


def test_more_cells_than_anybody_wants_are_refused_before_they_are_made() -> None:
    with pytest.raises(InputError, match=rf"the number of cells is 10000000000; it must be at most {MOST_CELLS}"):
        cells({"seed": list(range(100_000)), "steps": list(range(1, 100_001))}, text="a boat")


def test_paintings_of_the_last_axis_that_varies_stand_side_by_side() -> None:
    grid = grid_of({"axes": {"style": ["loops", "free"], "seed": [0, 1, 2], "steps": [3]}}, "the grid")
    assert grid.columns() == 3
    assert grid_of({"axes": {"seed": [0]}}, "the grid").columns() == 1


def test_a_weight_of_no_term_is_refused_before_any_cell_is_planned() -> None:
    with pytest.raises(InputError, match=r"the cell .*beauty-1.*: there is no term to weigh 'beauty'; there are: edge"):
        cells({"weights": [{"tone": 1}, {"beauty": 1}]}, text="a boat")
    with pytest.raises(InputError, match="look weighs the look of a picture, and there is none; give it, or leave the"):
        cells({"weights": [{"look": 1}]}, picture="a.png")
