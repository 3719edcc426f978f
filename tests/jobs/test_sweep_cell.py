"""Cells of a sweep: what they are asked for, and who may plan them."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest, demo_picture
from maulstick.jobs.sweep import cell
from maulstick.jobs.sweep.cell import begin, is_finished, plan_cell, read_cell, share_of, summed
from maulstick.painting.brush import load_brush
from maulstick.painting.painting_file import write_painting
from maulstick.robot.journal import journal_of
from maulstick.storage.files import held
from tests.support.planned import planned


@pytest.fixture
def request_here(tmp_path: Path) -> PlanRequest:
    """A request of a picture that a test may change."""
    picture = Path(shutil.copy(demo_picture(), tmp_path / "picture.png"))
    return PlanRequest(picture, PlanOptions(strokes=5, steps=2, px=16))


def test_a_cell_that_another_process_still_plans_keeps_its_request(
    request_here: PlanRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cell, "_PATIENCE", 0.1)
    folder = tmp_path / "cell"
    begin(folder, summed(request_here))
    before = (folder / "cell.json").read_bytes()
    other = summed(replace(request_here, options=replace(request_here.options, strokes=6)))
    with held(folder / ".lock", "", "", ""):
        assert begin(folder, summed(request_here)) is None
        with pytest.raises(InputError, match="is planned by another process; wait for it, or end it"):
            begin(folder, other)
        assert (folder / "cell.json").read_bytes() == before
    assert begin(folder, other) == "strokes"
    assert read_cell(folder).request == other.as_json()


def test_a_file_that_changed_since_the_sweep_began_is_not_planned(request_here: PlanRequest, tmp_path: Path) -> None:
    folder = tmp_path / "cell"
    begin(folder, summed(request_here))
    picture = request_here.picture
    assert picture is not None
    Image.new("RGB", (40, 30), "red").save(picture)
    assert plan_cell(str(folder)) == f"{picture} has changed since the sweep began; sweep again"
    assert not is_finished(folder)
    assert begin(folder, summed(request_here)) == "picture"
    assert plan_cell(str(folder)) is None


def test_a_journal_that_went_on_makes_a_cell_anew(request_here: PlanRequest, tmp_path: Path) -> None:
    painting, photograph = tmp_path / "painting.json", tmp_path / "photograph.png"
    journal_of(painting).write_text(json.dumps({"stroke": 1}))
    write_painting(planned(), painting)
    photograph.write_text("{}")
    on_paper = replace(request_here, options=replace(request_here.options, again=painting, background=photograph))
    assert begin(tmp_path / "cell", summed(on_paper)) is None
    assert begin(tmp_path / "cell", summed(on_paper)) is None
    journal_of(painting).write_text(json.dumps({"stroke": 2}))
    assert begin(tmp_path / "cell", summed(on_paper)) == "journal"
    for stroke in (1, 2):
        journal_of(painting, copy=2).write_text(json.dumps({"stroke": stroke}))
        assert begin(tmp_path / "cell", summed(on_paper)) == "journal", "that of the latest sheet"
        assert begin(tmp_path / "cell", summed(on_paper)) is None


def test_a_brush_or_a_style_of_a_region_that_changed_makes_a_cell_anew(
    request_here: PlanRequest, tmp_path: Path
) -> None:
    regions, say, brush = (tmp_path / name for name in ("map.png", "say.toml", "mine.json"))
    Image.new("RGB", (8, 8), "red").save(regions)
    brush.write_text(load_brush("marker").model_dump_json())
    say.write_text(f"[all]\ncolour = '#ff0000'\nstyle = 'loops'\nbrush = '{brush}'\n")
    there = replace(request_here, options=replace(request_here.options, regions=regions, say=say))
    assert [begin(tmp_path / "cell", summed(there)) for _ in range(2)] == [None, None]
    brush.write_text(load_brush("marker").model_copy(update={"opacity": 0.5}).model_dump_json())
    assert [begin(tmp_path / "cell", summed(there)) for _ in range(2)] == ["the brush", None]
    say.write_text(say.read_text().replace("loops", "nobody"))
    with pytest.raises(InputError, match="there is no style 'nobody'"):
        summed(there)


def test_a_brush_of_the_painting_that_is_planned_again_is_found_in_it(
    request_here: PlanRequest, tmp_path: Path
) -> None:
    mine, file = load_brush("marker").model_copy(update={"name": "mine"}), tmp_path / "painting.json"
    paints = tuple(paint.model_copy(update={"brush": "mine"}) for paint in planned().paints)
    write_painting(planned().model_copy(update={"brushes": {"mine": mine}, "paints": paints}), file)
    options = replace(request_here.options, again=file, brush="mine", style="loops", size="60x60mm")
    begin(tmp_path / "cell", summed(replace(request_here, options=options)))
    assert plan_cell(str(tmp_path / "cell")) is None
    with pytest.raises(InputError, match="there is no brush 'yours'"):
        summed(replace(request_here, options=replace(options, brush="yours")))


def test_a_share_that_is_not_told_stays_as_it_was(tmp_path: Path) -> None:
    assert share_of(tmp_path) == 0.0
    assert share_of(tmp_path, 0.7) == 0.7
    (tmp_path / ".share").write_text("")
    assert share_of(tmp_path, 0.7) == 0.7
    (tmp_path / ".share").write_text("0.8")
    assert share_of(tmp_path, 0.7) == 0.8
