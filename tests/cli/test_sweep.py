import csv
import json
import os
import re
import shutil
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from maulstick.jobs.plan.request import state_files
from maulstick.jobs.sweep import local
from maulstick.jobs.sweep.cell import is_finished, read_cell
from maulstick.jobs.sweep.grid import grid_of
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Ran, Running, contents, run
from tests.support.studio.processes import children_of, command_of, have_ended

OPTIONS = "[options]\nsteps = 30\nstrokes = 20\npx = 48\n"  # those of QUICK
ROOT = Path(__file__).resolve().parents[2]


def grid_in(folder: Path, axes: str, options: str = OPTIONS) -> Path:
    """A grid beside a picture."""
    folder.mkdir(exist_ok=True)
    shutil.copy(PORTRAIT, folder / "eileen.png")
    (folder / "grid.toml").write_text(f"[axes]\npicture = ['eileen.png']\n{axes}\n{options}")
    return folder / "grid.toml"


def table_in(out: Path) -> list[dict[str, str]]:
    with (out / "sweep.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def results_in(folder: Path) -> dict[str, bytes]:
    return {name: content for name, content in contents(folder).items() if name in RESULTS}


def workers_of(parent: int) -> list[int]:
    """Processes that a sweep started, by their ids."""
    return [child for child in children_of(parent) if b"maulstick.jobs.sweep.worker" in command_of(child)]


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ran]:
    """A folder with a grid and its finished sweep, and what was said."""
    folder = tmp_path_factory.mktemp("swept")
    grid = grid_in(folder, "brush = ['round', 'marker']\nseed = [0, 1]")
    return folder, run("sweep", grid, "--out", folder / "out", "--at-once", "2")


@pytest.fixture
def again(swept: tuple[Path, Ran], tmp_path: Path) -> Path:
    """The same for a test of its own, in another place."""
    return Path(shutil.copytree(swept[0], tmp_path / "again"))


def test_every_combination_is_planned_and_stands_in_the_table_and_on_the_sheet(swept: tuple[Path, Ran]) -> None:
    folder, ran = swept
    assert ran.code == 0, ran.stderr
    assert "4 of 4 cells finished" in ran.stdout
    rows = table_in(folder / "out")
    names = [f"eileen.png_{brush}_seed-{seed}" for brush in ("round", "marker") for seed in (0, 1)]
    assert [row["cell"] for row in rows] == names
    assert [(row["brush"], row["seed"], row["fault"]) for row in rows][1] == ("round", "1", "")
    metrics = json.loads((folder / "out" / names[3] / "painting.json").read_text())["provenance"]["metrics"]
    assert float(rows[3]["psnr"]) == metrics["psnr"]
    with Image.open(folder / "out" / "sweep.png") as sheet:
        assert sheet.width > 2 * 320
        assert len(sheet.convert("RGB").getcolors(2**20) or []) > 100


def test_a_cell_has_the_files_of_the_plan_command_to_the_bit(swept: tuple[Path, Ran], tmp_path: Path) -> None:
    folder, _ = swept
    words = (*QUICK, "--brush", "marker", "--seed", "1")
    assert run("plan", folder / "eileen.png", *words, "--out", tmp_path / "alone").code == 0
    assert results_in(folder / "out" / "eileen.png_marker_seed-1") == contents(tmp_path / "alone")


def test_a_cell_plans_a_painting_again_as_the_plan_command_does_with_its_options_and_its_picture(
    again: Path, tmp_path: Path
) -> None:
    painting = "out/eileen.png_marker_seed-1/painting.json"
    (again / "grid.toml").write_text(f"[axes]\nsteps = [3]\n[options]\nagain = '{painting}'\n")
    shutil.copy(again / "eileen.png", again / "out")  # above the painting
    ran = run("sweep", again / "grid.toml", "--out", again / "twice")
    assert ran.code == 0, ran.stderr
    assert run("plan", "--again", again / painting, "--steps", "3", "--out", tmp_path / "alone").code == 0
    assert results_in(again / "twice" / "steps-3") == contents(tmp_path / "alone")


def test_a_second_run_plans_nothing_even_where_all_has_moved(again: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in again.rglob("painting.json")}
    table = (again / "out" / "sweep.csv").read_bytes()
    ran = run("sweep", again / "grid.toml", "--out", again / "out")
    assert ran.code == 0
    assert "note" not in ran.stderr
    assert {path: path.stat().st_mtime_ns for path in again.rglob("painting.json")} == before
    assert (again / "out" / "sweep.csv").read_bytes() == table


def test_a_longer_axis_plans_what_it_adds_and_a_changed_option_plans_anew(again: Path) -> None:
    grid, out = again / "grid.toml", again / "out"
    kept = results_in(out / "eileen.png_round_seed-0")
    when = (out / "eileen.png_round_seed-0" / "painting.json").stat().st_mtime_ns
    grid.write_text(grid.read_text().replace("[0, 1]", "[0, 2]").replace("['round', 'marker']", "['round']"))
    assert run("sweep", grid, "--out", out).code == 0
    assert [row["seed"] for row in table_in(out)] == ["0", "2"]
    assert (out / "eileen.png_round_seed-0" / "painting.json").stat().st_mtime_ns == when
    grid.write_text(grid.read_text().replace("[0, 2]", "[0]").replace("strokes = 20", "strokes = 19"))
    ran = run("sweep", grid, "--out", out)
    assert ran.code == 0
    assert "note: eileen.png_round_seed-0 was planned before strokes changed, and is planned anew" in ran.stderr
    assert results_in(out / "eileen.png_round_seed-0") != kept


def test_a_cell_that_fails_is_named_and_tried_again_while_the_others_finish(tmp_path: Path) -> None:
    grid = grid_in(tmp_path, "")
    grid.write_text(grid.read_text().replace("['eileen.png']", "['broken.png', 'eileen.png']"))
    (tmp_path / "broken.png").write_bytes(os.urandom(500))
    ran = run("sweep", grid, "--out", tmp_path / "out", "--retries", "1")
    assert ran.code == 1
    assert f"note: broken.png failed: {tmp_path}/broken.png is not a picture" in ran.stderr
    assert ran.stderr.count("note: broken.png failed") == 2
    assert ran.stderr.count("(tried again, 1 of 1)") == 1
    told = "maulstick: 1 of 2 cells failed: broken.png; sweep.csv says why; mend it, and sweep again: "
    assert told in ran.stderr
    broken, fine = table_in(tmp_path / "out")
    assert "is not a picture" in broken["fault"]
    assert (fine["fault"], fine["strokes_drawn"]) == ("", "20")
    shutil.copy(PORTRAIT, tmp_path / "broken.png")
    assert run("sweep", grid, "--out", tmp_path / "out").code == 0
    assert [row["fault"] for row in table_in(tmp_path / "out")] == ["", ""]
    assert sorted(os.listdir(tmp_path / "out" / "broken.png")) == sorted([".lock", "cell.json", *RESULTS])


def test_a_worker_that_is_killed_loses_nothing_and_its_cell_is_tried_again(
    swept: tuple[Path, Ran], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local, "_WORKER", "tests.support.cli.mortal_worker")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("MORTAL_WORKER", str(tmp_path / "saved"))
    grid = grid_in(tmp_path, "brush = ['round']\nseed = [0, 1]")
    ran = run("sweep", grid, "--out", tmp_path / "out", "--at-once", "1")
    assert ran.code == 0, ran.stderr
    told = "seed-0 failed: its process was ended by SIGKILL, most likely for want of memory: plan fewer cells at once"
    assert f"{told} (tried again, 1 of 2)" in ran.stderr
    saved = (tmp_path / "saved").read_text().split()
    assert len(saved) == len(set(saved)), "no step of any plan was done twice"
    for cell in ("eileen.png_round_seed-0", "eileen.png_round_seed-1"):
        assert results_in(tmp_path / "out" / cell) == results_in(swept[0] / "out" / cell)


def test_ctrl_c_keeps_all_plans_and_the_same_command_finishes_them(tmp_path: Path) -> None:
    grid, out = grid_in(tmp_path, "seed = [0, 1]", OPTIONS.replace("30", "1200")), tmp_path / "out"
    running = Running("sweep", grid, "--out", out, "--at-once", "1")
    running.interrupt_after(r"seed-0.* [1-9]\d?%")
    assert running.leave() == 130
    assert "Traceback" not in running.said
    assert "the same command goes on from where it was stopped" in running.said
    cells = [out / f"eileen.png_seed-{seed}" for seed in (0, 1)]
    assert [len(state_files(cell)) for cell in cells] == [1, 0]
    assert [row["fault"] for row in table_in(out)] == ["not finished"] * 2
    assert run("sweep", grid, "--out", out).code == 0
    assert all(is_finished(cell) for cell in cells)
    assert read_cell(cells[0]).notes == read_cell(cells[1]).notes, "none was planned anew"


@pytest.mark.parametrize("at", ["start", "work"])
def test_a_sweep_that_is_killed_leaves_no_process_behind(tmp_path: Path, at: str) -> None:
    grid = grid_in(tmp_path, "seed = [0]", OPTIONS.replace("30", "300000"))
    cell = tmp_path / "out" / "eileen.png_seed-0"
    running = Running("sweep", grid, "--out", tmp_path / "out", "--at-once", "1")
    while not (workers_of(running.pid) if at == "start" else (cell / ".share").exists()):
        time.sleep(0.01)
    (worker,) = workers_of(running.pid)
    running.kill()
    running.leave()
    assert have_ended([worker])
    assert len(state_files(cell)) == (at == "work")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("axes", "is not TOML: Expected '='"),
        ("axis = {}", "is not a grid; add a table [axes], as in seed = [0, 1]"),
        ("[axes]", "axes names no option; give at least one, as in seed = [0, 1, 2]"),
        ("[axes]\nseed = 0", "is not a grid: axes.seed: Input should be a valid list (got 0)"),
        ("[axes]\nseed = []", "the axis seed has no value; give it some, or leave it out"),
        ("[axes]\nseeds = [0]", "there is no option 'seeds'; there are: again, arrange, ask_every"),
        ("[axes]\nseed = [0]", "there is nothing to paint; give the axes or the options a picture, or a text"),
        ("[axes]\npicture = ['none.png']", "there is no picture {folder}/none.png; check its name and folder"),
        (
            "[axes]\nseed = [0]\n[options]\nseed = 0",
            "seed is an axis and an option of all cells; leave one of them out",
        ),
        ("[axes]\nseed = [0, 0]\n[options]\ntext = 'a boat'", "2 cells would share the folder seed-0; name each"),
        ("[axes]\npicture = ['x.png']\nstrokes = [0]", "the cell x.png_strokes-0: strokes is 0; it must be from 1 to"),
        (
            "[axes]\npicture = ['x.png']\nseed = ['a']",
            "the cell x.png_seed-a: options.seed: Input should be a valid int",
        ),
        (
            "[axes]\npicture = ['x.png']\nseed = [true]",
            "the cell x.png_seed-True: seed has true or false, as only exact",
        ),
        (
            "[axes]\npicture = ['x.png']\nseed = [0, 1]\n[options]\ncrop = [0, 0, true, 1]",
            "the cell x.png_seed-0: crop has true or false, as only exact",
        ),
        (
            "[axes]\npicture = ['x.png']\nseed = [0, 1]\n[options.weights]\ntone = true",
            "the cell x.png_seed-0: weights has true or false, as only exact",
        ),
        (
            "[axes]\npicture = ['x.png']\nseed = [0, 1]\n[options]\nstrokes = 'auto'",
            "the cell x.png_seed-0: strokes is auto, which counts strokes of a hand for ink; give style and ink, or a",
        ),
        ("[axes]\nagain = ['none.json']", "there is no painting {folder}/none.json; check its name and folder"),
        ("[axes]\ntext = ['a boat']\nstyle = ['nobody']", "there is no style 'nobody'; there are: FILE.json, "),
        ("[axes]\ntext = ['a boat']\nbrush = ['none']", "there is no brush 'none'; there are: FILE.json, fineliner"),
    ],
)
def test_a_grid_that_cannot_be_planned_is_one_line_and_leaves_nothing(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "grid.toml").write_text(text)
    ran = run("sweep", tmp_path / "grid.toml", "--out", tmp_path / "out")
    assert ran.code == 2
    assert told.format(folder=tmp_path) in ran.mistake
    assert os.listdir(tmp_path) == ["grid.toml"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--on", "mars"], "there is no place to plan on 'mars'; there are: local, ray, ray:ADDRESS, slurm"),
        (["--on", "ray:"], "there is no place to plan on 'ray:'"),
        (["--at-once", "0"], "--at-once is 0; it must be from 1 to 1024"),
        (["--retries", "-1"], "--retries is -1; it must be from 0 to 100"),
    ],
)
def test_options_out_of_range_are_one_line(tmp_path: Path, words: list[Any], told: str) -> None:
    ran = run("sweep", grid_in(tmp_path, "seed = [0]"), "--out", tmp_path / "out", *words)
    assert ran.code == 2
    assert ran.mistake.startswith(told)
    assert not (tmp_path / "out").exists()


def test_a_grid_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    assert (
        run("sweep", tmp_path / "none.toml").mistake
        == f"there is no grid {tmp_path}/none.toml; check its name and folder"
    )


def test_a_folder_that_holds_something_else_is_left_alone(tmp_path: Path) -> None:
    mine = tmp_path / "out" / "eileen.png_seed-0" / "mine.txt"
    mine.parent.mkdir(parents=True)
    mine.write_text("mine")
    ran = run("sweep", grid_in(tmp_path, "seed = [0]"), "--out", tmp_path / "out")
    assert ran.code == 1
    assert ran.mistake.endswith("is not empty, and no cell of a sweep; choose another folder")
    assert os.listdir(mine.parent) == ["mine.txt"]


def test_a_file_is_no_folder_to_sweep_into(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("before")
    ran = run("sweep", grid_in(tmp_path, "seed = [0]"), "--out", tmp_path / "out")
    assert (ran.code, ran.mistake) == (1, f"{tmp_path / 'out'} is a file, not a folder; choose another --out")
    assert (tmp_path / "out").read_text() == "before"


@pytest.mark.parametrize("name", ["sweep.csv", "sweep.png"])
def test_a_file_that_is_no_result_of_a_sweep_is_never_replaced(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("mine")
    ran = run("sweep", grid_in(tmp_path, "seed = [0]"), "--out", tmp_path)
    assert ran.code == 1
    assert ran.mistake == f"{tmp_path / name} is of no sweep, and would be replaced; choose another --out"
    assert (tmp_path / name).read_text() == "mine"
    assert not (tmp_path / "eileen.png_seed-0").exists()
    (tmp_path / "eileen.png_seed-0").mkdir()
    (tmp_path / "eileen.png_seed-0" / "cell.json").write_text("{}")
    assert run("sweep", grid_in(tmp_path, "seed = [0]"), "--out", tmp_path).code == 0, "a sweep's own, copied"


def test_the_grids_of_the_documentation_can_be_planned() -> None:
    text = (ROOT / "docs" / "sweep.md").read_text(encoding="utf-8")
    plain, more = (tomllib.loads(block) for block in re.findall(r"```toml\n(.*?)```", text, re.DOTALL))
    cells = grid_of({**plain, **more}, "docs/sweep.md").cells(Path())
    assert f"These are {len(cells)} cells." in text
    assert f"`{cells[0].name}/`" in text
