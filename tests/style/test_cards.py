import os
import subprocess
import sys
from pathlib import Path

import pytest

from maulstick.errors import InputError, OutputError
from maulstick.painting.raster import Canvas
from maulstick.style import load_style
from maulstick.style.cards import STYLES, read_card, rename_style, style_path, title_style
from maulstick.style.store import Fitted, read_style, write_style
from tests.style.test_store import a_trajvae, an_exemplar, kill_after

CANVAS = Canvas(0.2, 0.16, 1000.0)


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of own styles, with the style `arcs` in it."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return write_style(an_exemplar(), "a drawing of arcs", STYLES.own()).parent


def test_cards_are_read_without_torch() -> None:
    asked = "import sys, maulstick.style.cards as c; [c.read_card(p) for p in c.STYLES.paths().values()]"
    ran = subprocess.run([sys.executable, "-c", f"{asked}; sys.exit('torch' in sys.modules)"])
    assert ran.returncode == 0


@pytest.mark.parametrize("made", [an_exemplar("before"), a_trajvae()], ids=lambda style: style.name)
def test_a_renamed_style_is_the_same_hand_by_its_hash(made: Fitted, own: Path) -> None:
    write_style(made, "a drawing", own)
    path = rename_style(made.name, "after")
    read = read_style(path)
    assert (read.name, read.hash, len(read.hand)) == ("after", made.hash, len(made.hand))
    assert sorted(os.listdir(own)) == ["after.json", "after.safetensors", "arcs.json", "arcs.safetensors"]


def test_a_plan_finds_a_style_by_any_name_that_it_had(own: Path) -> None:
    rename_style("arcs", "bows")
    (own / "torn.json").write_text("{")
    path = rename_style("bows", "curves")
    assert read_card(path).formerly == ("arcs", "bows")
    for name in ("arcs", "bows", "curves"):
        assert style_path(name) == path
        assert load_style(name, CANVAS).name == "curves"
    assert read_card(rename_style("curves", "arcs")).formerly == ("bows", "curves")


def test_a_style_whose_files_somebody_renamed_is_found_by_the_name_that_paintings_know_it_by(own: Path) -> None:
    for file in list(own.iterdir()):
        file.rename(file.with_stem("bows"))
    assert load_style("bows", CANVAS).name == "arcs"
    assert style_path("arcs") == style_path("bows") == own / "bows.json"
    path = rename_style("bows", "curves")
    assert style_path("arcs") == style_path("bows") == path


def test_a_style_that_is_learned_again_over_renamed_files_is_found_by_the_name_in_their_card(own: Path) -> None:
    for file in list(own.iterdir()):
        file.rename(file.with_stem("bows"))
    path = write_style(an_exemplar("bows"), "another drawing", own)
    assert style_path("arcs") == path
    assert read_card(path).formerly == ("arcs",)


def test_a_style_that_is_learned_again_keeps_its_title_and_is_found_by_the_names_that_it_had(own: Path) -> None:
    title_style("arcs", "Arcs by Ida")
    rename_style("arcs", "bows")
    path = write_style(an_exemplar("bows"), "another drawing", own)
    assert style_path("arcs") == path
    assert (read_card(path).title, read_card(path).source) == ("Arcs by Ida", "another drawing")
    path.write_text("{")
    assert read_card(write_style(an_exemplar("bows"), "a third", own)).title is None


def test_a_style_of_that_name_goes_before_one_that_had_it_once(own: Path) -> None:
    rename_style("arcs", "bows")
    write_style(an_exemplar(), "another drawing", own)
    assert style_path("arcs") == own / "arcs.json"


def test_a_style_that_always_had_its_name_says_nothing_of_others(own: Path) -> None:
    assert "formerly" not in (own / "arcs.json").read_text()


@pytest.mark.parametrize(
    ("name", "new", "text"),
    [
        ("arcs", "arcs", "there is a style arcs already; choose another name"),
        ("arcs", "hatching", "there is a style hatching already; choose another name"),
        ("arcs", "a/b", "the name of a style is 'a/b'; it must be up to 40 of a-z, 0-9 and -"),
        ("hatching", "mine", "there is no style of your own called 'hatching'; those that come with Maulstick keep"),
        ("none", "mine", "there is no style of your own called 'none'"),
    ],
)
def test_a_name_that_cannot_be_is_refused(own: Path, name: str, new: str, text: str) -> None:
    with pytest.raises((InputError, OutputError)) as caught:
        rename_style(name, new)
    assert str(caught.value).startswith(text)
    assert sorted(os.listdir(own)) == ["arcs.json", "arcs.safetensors"]


@pytest.mark.parametrize("fails_at", range(6))
def test_a_rename_that_is_killed_loses_no_style(own: Path, monkeypatch: pytest.MonkeyPatch, fails_at: int) -> None:
    before = read_style(own / "arcs.json").hash
    kill_after(fails_at, monkeypatch)
    with pytest.raises(KeyboardInterrupt):
        rename_style("arcs", "bows")
    monkeypatch.undo()
    there = [read_style(own / file) for file in os.listdir(own) if file in ("arcs.json", "bows.json")]
    assert there
    assert all(style.hash == before for style in there)


def test_arrays_that_are_missing_are_not_renamed(own: Path) -> None:
    (own / "arcs.safetensors").unlink()
    with pytest.raises(InputError, match=r"there is no style .*arcs\.safetensors"):
        rename_style("arcs", "bows")
    assert os.listdir(own) == ["arcs.json"]
