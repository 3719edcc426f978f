import os
import re
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image

from maulstick.storage.arrays import Floats, write_arrays
from maulstick.strokes.ink import Ink, write_ink
from maulstick.strokes.strokes import Strokes, write_strokes
from maulstick.style import cards, train, trajvae
from maulstick.style.hand import Hand
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.trajvae import ActiveLatents, TrajVAE, Weights, shapes
from tests.cli.conftest import QUICK, run
from tests.support.drawn import as_strokes, hatching, scattered

BUILT_IN = "hatching"
SIX = ("contour", "cursive", "hatching", "loops", "marks", "scribble")


def waves(number: int, length: float, bend: float, pressure: float = 0.5) -> Ink:
    """Strokes that differ a little; one more is a dot."""
    rng = np.random.default_rng(number)
    along = np.linspace(0, 1, 40)
    strokes = []
    for i in range(number):
        long = length * rng.uniform(0.8, 1.2)
        y = 0.05 + bend * long * np.sin(rng.uniform(5, 7) * along)
        strokes.append(np.column_stack([i + along, 0.01 + long * along, y, np.full(40, pressure)]))
    return Ink.of([*strokes, strokes[0][:1]], (0.2, 0.2))


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two recordings, in which the commands run; own styles are kept under it."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.chdir(tmp_path)
    write_ink(waves(12, 0.02, 0.05), "cat.ink.npz")
    write_strokes(Strokes.of(waves(14, 0.06, 0.4, np.nan)), "dog.strokes.npz")
    return tmp_path


@pytest.fixture
def cat(here: Path) -> str:
    """The name of an own style."""
    assert run("style", "fit", "cat.ink.npz", "--name", "cat").code == 0
    return "cat"


def rows(table: str) -> dict[str, str]:
    """The lines of a table by their first cell."""
    cells = [[cell.strip() for cell in line.split("│")[1:-1]] for line in table.splitlines() if "│" in line]
    return {first: " ".join(rest) for first, *rest in cells}


def kept(here: Path) -> list[str]:
    folder = here / "data" / "maulstick" / "styles"
    return sorted(os.listdir(folder)) if folder.exists() else []


def test_a_style_is_learned_and_the_next_command_paints_in_it(here: Path) -> None:
    ran = run("style", "fit", "cat.ink.npz", "--name", "cat")
    assert (ran.code, ran.stderr) == (0, "")
    told = rows(ran.stdout)
    assert told["strokes"] == "12 (and 1 left out, shorter than 1 mm)"
    assert told["lengths"] == "median 19.4 mm, 16.4 to 24.1 mm"
    assert (told["pressure"], told["speed"]) == ("recorded", "recorded")
    assert told["new strokes"] == "varied a little"
    assert kept(here) == ["cat.json", "cat.safetensors"]
    assert ran.stdout.splitlines()[-1] == "maulstick plan photo.jpg --style cat"
    assert run("plan", "--demo", *QUICK, "--style", "cat").code == 0
    assert '"style": "cat"' in Path("painting/painting.json").read_text()


@pytest.mark.parametrize(
    ("drawn", "told"),
    [
        (hatching(6, seed=0), r"groups of 8, parallel, 2\.8 mm apart; cross rarely"),
        (hatching(3, seed=0), "not learned: 30 strokes tell it"),
        (scattered(60, seed=0) + 10 * np.random.default_rng(0).random((60, 1, 2)), "too scattered to be learned"),
    ],
    ids=["hatching", "few", "scattered"],
)
def test_how_the_hand_arranges_its_strokes_is_said_in_words(here: Path, drawn: Floats, told: str) -> None:
    write_strokes(as_strokes(drawn), "me.strokes.npz")
    assert re.fullmatch(told, rows(run("style", "fit", "me.strokes.npz", "--name", "me").stdout)["arranged"])


def test_the_order_of_files_is_not_told_as_the_order_of_strokes(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    large, small = hatching(6, seed=0), hatching(6, seed=1) / 2
    write_strokes(as_strokes(large), "large.strokes.npz")
    write_strokes(as_strokes(small), "small.strokes.npz")
    write_strokes(as_strokes(np.concatenate([large, small + 1.0])), "one.strokes.npz")
    ran = run("style", "fit", "large.strokes.npz", "small.strokes.npz", "--name", "both")
    assert re.fullmatch(r"groups of 8, .*; cross rarely", rows(ran.stdout)["arranged"])
    ran = run("style", "fit", "one.strokes.npz", "--name", "one")
    assert rows(ran.stdout)["arranged"].endswith("; long strokes first")


def test_lengths_of_metres_are_told_in_plain_figures(here: Path) -> None:
    write_ink(waves(12, 2.0, 0.05), "large.ink.npz")
    told = rows(run("style", "fit", "large.ink.npz", "--name", "large").stdout)
    assert told["lengths"] == "median 1940 mm, 1640 to 2410 mm"


def test_several_recordings_of_a_hand_make_one_style(here: Path) -> None:
    ran = run("style", "fit", "cat.ink.npz", "dog.strokes.npz", "--name", "both")
    told = rows(ran.stdout)
    assert told["strokes"] == "26 (and 2 left out, shorter than 1 mm)"
    assert told["pressure"] == "recorded in 12 of them"
    assert cards.read_card(cards.style_path("both")).source == "cat.ink.npz, dog.strokes.npz"


@pytest.mark.parametrize(("active", "words"), [(16, ""), (15, ": the strokes are much alike; draw more varied ones")])
def test_a_network_is_trained_where_it_is_asked_for(
    here: Path, monkeypatch: pytest.MonkeyPatch, active: int, words: str
) -> None:
    rng = torch.Generator().manual_seed(0)
    network = {name: 0.1 * torch.randn(size, generator=rng) for name, size in shapes().items()}
    network |= {"hands.covariance": torch.eye(GIST + 1), "hands.residual": torch.ones(RESIDUAL)}

    def fine_tune(weights: Weights, hand: Hand, seed: int, name: str) -> TrajVAE:
        assert (len(hand), seed, name) == (12, 0, "net")
        return TrajVAE(name, hand, weights)

    monkeypatch.setattr(trajvae, "activity", lambda *_: ActiveLatents(active, 7.2))
    monkeypatch.setattr(train, "pretrained", lambda: network)
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(train, "fine_tune", fine_tune)
    ran = run("style", "fit", "cat.ink.npz", "--name", "net", "--kind", "trajvae")
    assert ran.code == 0
    assert rows(ran.stdout)["latents"] == f"{active} active, of an effective rank of 7.2{words}"
    assert cards.read_card(cards.style_path("net")).settings.kind == "trajvae"


def test_a_style_is_replaced_only_when_told_to(here: Path, cat: str) -> None:
    ran = run("style", "fit", "dog.strokes.npz", "--name", "cat")
    assert ran.code == 1
    assert ran.mistake == "there is a style cat already; choose another --name, or add --overwrite"
    assert cards.read_card(cards.style_path("cat")).strokes == 12
    assert run("style", "fit", "dog.strokes.npz", "--name", "cat", "--overwrite").code == 0
    assert cards.read_card(cards.style_path("cat")).strokes == 14


def test_a_folder_that_no_style_can_be_kept_in_is_told_before_it_is_learned(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Hand, "of", lambda strokes: pytest.fail("it was learned"))
    Path("data").write_bytes(b"before")
    ran = run("style", "fit", "cat.ink.npz", "--name", "cat")
    assert ran.code == 1
    folder = here / "data" / "maulstick" / "styles"
    assert ran.mistake == f"cannot write into the folder {folder}: Not a directory; make room for it there"


def test_a_style_that_somebody_else_learns_meanwhile_is_not_replaced(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    of = Hand.of

    def while_another_learns(strokes: Strokes) -> Hand:
        monkeypatch.setattr(Hand, "of", of)
        assert run("style", "fit", "dog.strokes.npz", "--name", "both").code == 0
        return of(strokes)

    monkeypatch.setattr(Hand, "of", while_another_learns)
    ran = run("style", "fit", "cat.ink.npz", "--name", "both")
    assert ran.code == 1
    assert ran.mistake == "there is a style both already; choose another --name, or add --overwrite"
    assert cards.read_card(cards.style_path("both")).source == "dog.strokes.npz"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["none.ink.npz", "--name", "a"], "there is no file none.ink.npz; check its name and folder"),
        (["text.txt", "--name", "a"], "text.txt is neither ink nor strokes; make ink of it with maulstick record ink"),
        (["pen.take.npz", "--name", "a"], "pen.take.npz holds a take; read it with maulstick record motive"),
        (["cat.ink.npz", "./cat.ink.npz", "--name", "a"], "a recording, or its copy, is named twice, and its strokes"),
        (["cat.ink.npz", "--name", "../x"], "the name of a style is '../x'; it must be up to 40 of a-z, 0-9 and -"),
        (["cat.ink.npz", "--name", "free"], "the name of a style is 'free'; it must be up to 40 of a-z, 0-9 and -"),
        (["cat.ink.npz", "--name", BUILT_IN], f"the style {BUILT_IN} comes with Maulstick; choose another --name"),
        (["cat.ink.npz", "--name", "a", "--kind", "b"], "there is no kind 'b'; there are: exemplar, trajvae"),
        (["three.ink.npz", "--name", "a"], "the number of strokes of a millimetre or more is 3; it must be at least 5"),
        (["empty.ink.npz", "--name", "a"], "the number of strokes of a millimetre or more is 0; it must be at least 5"),
        (["few.strokes.npz", "--name", "a"], "the number of points of a stroke in few.strokes.npz is 8; it must be 32"),
    ],
)
def test_what_no_style_can_be_learned_from_is_refused(here: Path, words: list[str], text: str) -> None:
    Path("text.txt").write_text("not ink")
    write_arrays("pen.take.npz", "take", {})
    write_ink(waves(3, 0.02, 0.1), "three.ink.npz")
    write_ink(Ink.of([], (0.1, 0.1)), "empty.ink.npz")
    write_strokes(Strokes.of(waves(9, 0.02, 0.1), n=8), "few.strokes.npz")
    ran = run("style", "fit", *words)
    assert ran.code == 2
    assert ran.mistake.startswith(text)
    assert kept(here) == []


def test_ctrl_c_while_learning_leaves_nothing(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Hand, "of", interrupt)
    assert run("style", "fit", "cat.ink.npz", "--name", "cat") == (130, "", "")
    assert kept(here) == []


def test_a_file_name_of_any_bytes_can_be_learned_from(here: Path) -> None:
    odd = os.fsdecode(b"c\xff\x1b[31mat.ink.npz")
    os.rename("cat.ink.npz", odd)
    assert run("style", "fit", odd, "--name", "cat").code == 0
    assert cards.read_card(cards.style_path("cat")).source == "c??[31mat.ink.npz"


def test_the_list_has_the_styles_that_come_along_and_the_own_ones(here: Path, cat: str) -> None:
    ran = run("style", "list")
    listed = rows(ran.stdout)
    assert ran.code == 0
    assert listed["free"] == "nobody: any smooth stroke".rjust(len(listed["free"]))
    assert "exemplar" in listed[BUILT_IN]
    assert "comes with Maulstick: Wacom" in listed[BUILT_IN]
    assert listed["cat"] == "exemplar 12 your own: cat.ink.npz"


def test_a_broken_style_does_not_hide_the_others(here: Path, cat: str) -> None:
    cards.style_path("cat").write_text("{}")
    ran = run("style", "list")
    assert ran.code == 0
    assert "cannot be used:" in rows(ran.stdout)["cat"]
    assert BUILT_IN in rows(ran.stdout)
    assert "cat.json is not a style: name: Field required" in run("plan", "--demo", "--style", "cat").mistake


def test_a_sheet_and_a_map_are_drawn_of_a_style(here: Path, cat: str) -> None:
    assert run("style", "show", "cat", "--px", "300") == (0, "cat.png\n", "")
    assert run("style", "show", "cat", "--px", "300", "--map") == (0, "cat-map.png\n", "")
    for picture in ("cat.png", "cat-map.png"):
        with Image.open(picture) as opened:
            assert opened.height == 300
    assert Path("cat.png").read_bytes() != Path("cat-map.png").read_bytes()


def test_a_map_shows_several_styles_and_a_sheet_does_not(here: Path, cat: str) -> None:
    ran = run("style", "show", "cat", BUILT_IN)
    assert ran.code == 2
    assert ran.mistake == "a sheet shows one style, and 2 are named; name one, or add --map"
    json = cards.style_path("cat")
    ran = run("style", "show", json, BUILT_IN, "--map", "--px", "240", "--out", "a.png")
    assert ran == (0, "a.png\n", "")


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (["free"], 2, "the style free is nobody's and has no strokes to look at; name one of maulstick style list"),
        (["rococo"], 2, "there is no style 'rococo'; there are: FILE.json, "),
        (["none.json"], 2, "there is no style none.json; check its name and folder"),
        ([BUILT_IN, "--px", "5"], 2, "--px is 5; it must be from 240 to 2400"),
        ([BUILT_IN, "--out", "a.jpg"], 2, "--out is a.jpg; a picture is written as PNG, so let its name end in .png"),
        ([BUILT_IN, "--out", "there.png"], 1, "there.png is already there; choose another --out, or add --overwrite"),
        ([BUILT_IN, BUILT_IN, "--map"], 2, f"{BUILT_IN} is named twice; name each style once"),
    ],
)
def test_what_cannot_be_shown_is_refused(here: Path, words: list[str], code: int, text: str) -> None:
    Path("there.png").write_bytes(b"before")
    ran = run("style", "show", *words)
    assert ran.code == code
    assert ran.mistake.startswith(text)
    assert Path("there.png").read_bytes() == b"before"


def test_a_map_of_too_many_styles_is_refused(here: Path, cat: str) -> None:
    ran = run("style", "show", *SIX, cat, "--map")
    assert ran.mistake == "the number of styles on a map is 7; it must be from 1 to 6"


def test_a_comparison_says_what_differs(here: Path, cat: str) -> None:
    run("style", "fit", "dog.strokes.npz", "--name", "dog")
    ran = run("style", "compare", "cat", "dog")
    told = rows(ran.stdout)
    assert ran.code == 0
    distance, floor, accuracy = (
        float(told[name].split()[0]) for name in ("energy distance", "of halves of cat", "1-NN accuracy")
    )
    assert distance > 1 > abs(floor)
    assert accuracy > 0.9
    words = ran.stdout.splitlines()[-1]
    assert words.startswith("compared with the strokes of cat, those of dog ")
    assert "bend more" in words


def test_recordings_of_one_hand_are_told_to_be_alike(here: Path, cat: str) -> None:
    write_ink(waves(13, 0.02, 0.05), "again.ink.npz")
    run("style", "fit", "again.ink.npz", "--name", "again")
    told = rows(run("style", "compare", "cat", "again").stdout)
    assert abs(float(told["energy distance"].split()[0])) < 0.5
    assert 0.3 < float(told["1-NN accuracy"].split()[0]) < 0.7


def test_a_style_is_not_compared_with_itself_or_nobody(here: Path, cat: str) -> None:
    path = cards.style_path("cat")
    assert run("style", "compare", "cat", "cat").mistake == "cat is named twice; name each style once"
    assert run("style", "compare", "cat", path).mistake == f"{path} is named twice; name each style once"
    assert run("style", "compare", "cat", "free").mistake.startswith("the style free is nobody's")


def test_hands_with_strokes_in_common_are_told_to_have_them(here: Path, cat: str) -> None:
    run("style", "fit", "cat.ink.npz", "--name", "twin")
    run("style", "fit", "cat.ink.npz", "dog.strokes.npz", "--name", "both")
    ran = run("style", "compare", "cat", "twin")
    assert ran == (0, "cat and twin were learned from the same strokes\n", "")
    ran = run("style", "compare", "cat", "both")
    assert ran == (0, "cat and both were learned in part from the same strokes\n", "")


def test_a_style_without_its_arrays_says_what_is_missing(here: Path, cat: str) -> None:
    Path("alone.json").write_bytes(cards.style_path("cat").read_bytes())
    assert run("style", "show", "alone.json").mistake == "alone.json has no alone.safetensors beside it; copy both"
