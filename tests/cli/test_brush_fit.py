import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from maulstick.brush_fit import fit as module
from maulstick.brush_fit.fit import Fit
from maulstick.brush_fit.trials import Trials
from maulstick.painting.brush import BRUSHES, Brush, load_brush, write_brush
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from tests.cli.conftest import QUICK, run
from tests.plots.test_brush_fit_plot import a_fit
from tests.support.tolerances import FEW_STROKES_WIDTH

MARKER = Brush(name="truth", source="a test", alpha=2e-3, beta=2e-3)
SCALE, SHEET = 2500.0, (70, 80)  # pixels a metre; pixels
Tell = Callable[[str, int, int], None]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with trials without strokes, in which the commands run; own brushes are kept under it."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    Trials.make("trials", medium="a marker", pixels_per_metre=SCALE, depth=(0.0, 0.002))
    return tmp_path


@pytest.fixture
def fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fit that takes no time, finds the brush of the plots' tests, and has something to say."""

    def fit_brush(
        trials: Trials, pixels_per_metre: float, name: str, *, source: str, depth: tuple[float, float], progress: Tell
    ) -> Fit:
        assert (len(trials), pixels_per_metre) == (0, SCALE)
        progress("photographs", 1, 2)
        progress("all strokes", 200, 200)
        found = a_fit()
        return replace(found, brush=found.brush.model_copy(update={"name": name, "source": source, "depth": depth}))

    monkeypatch.setattr(module, "fit_brush", fit_brush)


def draw_trials(folder: str, strokes: int) -> None:
    """Strokes of the marker from side to side, some pressed lightly and some hard, each on a sheet of its own."""
    trials = Trials.make(folder, medium="a marker", pixels_per_metre=SCALE)
    blank = torch.ones(3, *SHEET)
    for pressure in np.linspace(0.1, 0.9, strokes):
        trials.begin(blank.permute(1, 2, 0).numpy())
        along = np.linspace(0, 1, 12)
        path = np.column_stack([0.009 + 0.014 * along, 0.009 + 0.01 * along**2, np.full(12, pressure)])
        stroke = torch.tensor(path[None], dtype=torch.float32)
        after = paint(blank, stroke, torch.zeros(1, 3), Traj2Stroke.of([MARKER]), SCALE)
        trials.append(path, after.clamp(0, 1).permute(1, 2, 0).numpy())


def rows(table: str) -> dict[str, str]:
    """The lines of a table by their first cell."""
    cells = [[cell.strip() for cell in line.split("│")[1:-1]] for line in table.splitlines() if "│" in line]
    return {first: " ".join(rest) for first, *rest in cells}


def kept(here: Path) -> list[str]:
    folder = here / "data" / "maulstick" / "brushes"
    return sorted(os.listdir(folder)) if folder.exists() else []


def test_a_brush_is_fitted_to_photographs_and_the_next_command_paints_with_it(here: Path) -> None:
    draw_trials("drawn", 5)
    ran = run("brush", "fit", "drawn", "--name", "mine")
    told = rows(ran.stdout)
    assert (ran.code, told["strokes"]) == (0, "5")
    found = load_brush("mine")
    assert found.pressure_matters
    assert found.widest == pytest.approx(MARKER.widest, rel=FEW_STROKES_WIDTH)
    assert told["alpha"].endswith(" mm")
    assert float(told["alpha"].split(" ± ")[0]) == pytest.approx(1e3 * found.alpha, abs=0.05)
    assert "note: only 5 strokes could be used" in ran.stderr
    assert ran.stdout.splitlines()[-1] == "maulstick plan photo.jpg --brush mine"
    assert run("plan", "--demo", *QUICK, "--brush", "mine").code == 0
    assert list(json.loads(Path("painting/painting.json").read_text())["brushes"]) == ["mine"]


def test_the_numbers_and_what_they_rest_on_are_told(here: Path, fitted: None) -> None:
    ran = run("brush", "fit", "trials", "--name", "twig")
    told = rows(ran.stdout)
    assert ran.code == 0
    assert told["strokes"] == "40 (and 12 left out)"
    assert told["alpha"] == "6.0 ± 0.2 mm"
    assert told["beyond the paper"] == "nib"
    assert told["L1 per pixel"] == "0.0042; with the paper's seven numbers 0.0049"
    assert told["scatter"] == "0.31 mm in place, 8% in darkness"
    assert told["kept as"] == str(here / "data" / "maulstick" / "brushes" / "twig.json")
    brush = load_brush("twig")
    assert (brush.source, brush.depth) == ("a marker, fitted to the trials in trials", (0.0, 0.002))


def test_what_the_trials_cannot_tell_and_who_was_left_out_is_said_beside_the_result(here: Path, fitted: None) -> None:
    said = run("brush", "fit", "trials", "--name", "twig").stderr.splitlines()
    assert "note: all strokes were drawn at pressure 0.50" in said
    assert [line for line in said if line.startswith("left out: ")] == [
        f"left out: stroke {number} left no mark" for number in range(1, 11)
    ]
    assert said[-1] == "and 2 more"


def test_a_plot_is_drawn_where_it_is_asked_for(here: Path, fitted: None) -> None:
    ran = run("brush", "fit", "trials", "--name", "twig", "--plot", "twig.PNG")
    assert ran.code == 0
    assert "twig.PNG" in ran.stdout.splitlines()
    with Image.open("twig.PNG") as image:
        assert image.size == (2016, 1440)


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (["none", "--name", "a"], 2, "there is no list of trials none/trials.json; check its name and folder"),
        (["trials/trials.json", "--name", "a"], 2, "trials/trials.json is a file; name the folder of the trials"),
        (["trials", "--name", "../x"], 2, "the name of a brush is '../x'; it must be up to 40 of a-z, 0-9 and -"),
        (["trials", "--name", "round"], 2, "the brush round comes with Maulstick; choose another --name"),
        (["trials", "--name", "a"], 2, "0 of 0 trials can be used, and 5 are needed"),
        (["trials", "--name", "a", "--plot", "a.jpg"], 2, "--plot is a.jpg; a picture is written as PNG"),
        (["trials", "--name", "a", "--plot", "there.png"], 1, "there.png is already there; choose another --plot"),
        (["trials", "--name", "a", "--plot", "no/a.png"], 1, "cannot write no/a.png: its folder does not exist"),
    ],
)
def test_what_no_brush_can_be_fitted_to_is_refused(here: Path, words: list[str], code: int, text: str) -> None:
    Path("there.png").write_bytes(b"before")
    ran = run("brush", "fit", *words)
    assert ran.code == code
    assert ran.mistake.startswith(text)
    assert (kept(here), Path("there.png").read_bytes()) == ([], b"before")


def test_a_brush_is_replaced_only_when_told_to(here: Path, fitted: None) -> None:
    assert run("brush", "fit", "trials", "--name", "twig").code == 0
    os.rename("trials", "others")
    ran = run("brush", "fit", "others", "--name", "twig")
    assert ran.code == 1
    assert ran.mistake == "there is a brush twig already; choose another --name, or add --overwrite"
    assert load_brush("twig").source.endswith("in trials")
    assert run("brush", "fit", "others", "--name", "twig", "--overwrite").code == 0
    assert load_brush("twig").source.endswith("in others")


def test_a_name_that_is_taken_during_a_fit_stays_who_took_it(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fit_slowly(*_: object, **__: object) -> Fit:
        write_brush(MARKER, BRUSHES.own() / "twig.json")
        return a_fit()

    monkeypatch.setattr(module, "fit_brush", fit_slowly)
    ran = run("brush", "fit", "trials", "--name", "twig")
    assert (ran.code, ran.mistake) == (1, "there is a brush twig already; choose another --name, or add --overwrite")
    assert load_brush("twig") == MARKER


def test_a_folder_that_no_brush_can_be_kept_in_is_told_before_the_fit(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "fit_brush", lambda *_, **__: pytest.fail("it was fitted"))
    Path("data").write_bytes(b"before")
    ran = run("brush", "fit", "trials", "--name", "twig")
    own = here / "data" / "maulstick" / "brushes"
    assert ran.code == 1
    assert ran.mistake == f"cannot write into the folder {own}: Not a directory; make room for it there"
    assert Path("data").read_bytes() == b"before"


def test_ctrl_c_while_fitting_leaves_nothing(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object, **__: object) -> Fit:
        raise KeyboardInterrupt

    monkeypatch.setattr(module, "fit_brush", interrupt)
    ran = run("brush", "fit", "trials", "--name", "twig", "--plot", "twig.png")
    assert ran == (130, "", "")
    assert kept(here) == []
    assert not Path("twig.png").exists()


def test_a_folder_of_any_name_can_be_fitted_to(here: Path, fitted: None) -> None:
    odd = os.fsdecode(b"c\xff\x1b[31mat")
    os.rename("trials", odd)
    assert run("brush", "fit", odd, "--name", "twig").code == 0
    assert load_brush("twig").source == "a marker, fitted to the trials in c??[31mat"
