"""Table of a sweep: what stands in its columns."""

from pathlib import Path
from typing import Any

import pytest

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan.request import demo_picture

OPTIONS: dict[str, Any] = {"picture": str(demo_picture()), "steps": 2, "px": 16}


def test_numbers_of_axes_are_numbers_and_their_columns_hold_what_the_grid_says(tmp_path: Path) -> None:
    axes = {"strokes": [5, 12], "exact": [False, True], "weights": [{"edges": 0.5}]}
    table = ms.sweep({"axes": axes, "options": OPTIONS}, tmp_path / "out", at_once=1)
    assert len(table[(table.strokes == 5) & table.exact]) == 1
    assert set(table.weights) == {'{"edges": 0.5}'}
    assert (table.edges > 0).all()


@pytest.mark.filterwarnings("ignore:broken.png failed")
def test_columns_stand_in_one_order_whichever_cells_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("broken.png").write_bytes(b"none")
    Path("fine.png").write_bytes(demo_picture().read_bytes())
    for pictures in (["broken.png", "fine.png"], ["fine.png", "broken.png"]):
        grid = {"axes": {"picture": pictures}, "options": {"strokes": 5, "steps": 2, "px": 16}}
        columns = list(ms.sweep(grid, "out", at_once=1, retries=0).columns)
        assert columns[:3] == ["cell", "picture", "strokes_drawn"]
        assert columns[-3:] == ["seconds", "notes", "fault"]
        assert Path("out/sweep.csv").read_text().partition("\n")[0] == ",".join(columns)


def test_a_term_of_the_loss_never_takes_the_column_of_an_axis(tmp_path: Path) -> None:
    grid = {"axes": {"look": [str(demo_picture())]}, "options": {**OPTIONS, "strokes": 5}}
    table = ms.sweep(grid, tmp_path / "out", at_once=1)
    assert list(table.look) == [str(demo_picture())]
    assert list(table.look_loss + table.tone) == pytest.approx(list(table.loss))


def test_what_was_finished_and_is_damaged_is_named_with_what_to_do(tmp_path: Path) -> None:
    grid, out = {"axes": {"strokes": [5, 6]}, "options": OPTIONS}, tmp_path / "out"
    ms.sweep(grid, out, at_once=1)
    damaged = out / "strokes-5" / "painting.json"
    damaged.write_text("{")
    table = ms.sweep(grid, out)
    assert [fault[-35:] for fault in table.fault] == ["; remove that file, and sweep again", ""]
    assert str(damaged) in table.fault[0]
    damaged.unlink()
    assert list(ms.sweep(grid, out, at_once=1).fault) == ["", ""]
    preview = out / "strokes-6" / "preview.png"
    for content in (b"\x89PNG", preview.read_bytes()[:900]):
        preview.write_bytes(content)
        with pytest.raises(InputError, match=r"strokes-6/preview\.png is damaged; remove that file, and sweep again"):
            ms.sweep(grid, out)
