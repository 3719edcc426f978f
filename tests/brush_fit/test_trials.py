import json
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from PIL import Image

from maulstick.brush_fit import trials as module
from maulstick.brush_fit.trials import Trial, Trials
from maulstick.errors import InputError, OutputError
from maulstick.painting.picture import read_picture
from maulstick.storage.arrays import Floats
from tests.support.pages import DOCS, blocks
from tests.support.tolerances import EXECUTED_PATH, PHOTOGRAPH

Picture = NDArray[np.float32]
PATH = np.array([[0.01, 0.02, 0.0], [0.03, 0.04, 0.5], [0.1, 0.05, 1.0]])


def paper(grey: float, height: int = 4, width: int = 6) -> Picture:
    """A photograph with nothing on it but one red pixel, by which its upper left corner is known."""
    photograph = np.full((height, width, 3), grey, dtype=np.float32)
    photograph[0, 0] = (1, 0, 0)
    return photograph


def made(folder: Path) -> Trials:
    return Trials.make(folder, medium="a brush pen", pixels_per_metre=5000)


@pytest.fixture
def three(tmp_path: Path) -> Path:
    """Three strokes on one sheet, from grey 0.8 to 0.2."""
    trials = made(tmp_path / "three")
    trials.begin(paper(0.8))
    for grey in (0.6, 0.4, 0.2):
        trials.append(PATH, paper(grey))
    return trials.folder


def greys(trial: Trial) -> tuple[float, float]:
    return round(float(trial.before[-1, -1, 0]), 6), round(float(trial.after[-1, -1, 0]), 6)


def pngs(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name != "trials.json")


def paths() -> st.SearchStrategy[Floats]:
    point = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 1))
    return st.lists(point, min_size=1, max_size=4).map(np.array)


@st.composite
def sheets(draw: st.DrawFn) -> tuple[Picture, list[tuple[Floats, Picture]]]:
    """A photograph of the paper, and strokes on it, each with one."""
    shape = (draw(st.integers(1, 3)), draw(st.integers(1, 3)), 3)
    photographs = arrays(np.float32, shape, elements=st.floats(0, 1, width=32))
    return draw(photographs), draw(st.lists(st.tuples(paths(), photographs), max_size=3))


@settings(max_examples=25, deadline=None)
@given(st.lists(sheets(), min_size=1, max_size=2), st.sampled_from([(0.0, 0.0), (0.001, -0.0125)]))
def test_every_stroke_comes_back_with_its_photographs(
    tmp_path_factory: pytest.TempPathFactory,
    drawn: list[tuple[Picture, list[tuple[Floats, Picture]]]],
    depth: tuple[float, float],
) -> None:
    folder = tmp_path_factory.mktemp("trials")
    trials = Trials.make(folder, medium="Sharpie, schwarz \u2014 neu", pixels_per_metre=5000.5, depth=depth)
    expected = []
    for before, strokes in drawn:
        trials.begin(before)
        for path, after in strokes:
            trials.append(path, after)
            expected.append((path, before, after))
            before = after
    again = Trials.open(folder)
    assert (again.folder, again.medium) == (folder, "Sharpie, schwarz \u2014 neu")
    assert (again.pixels_per_metre, again.depth) == (5000.5, depth)
    assert len(again) == len(trials) == len(expected)
    for source in (trials, again):
        for index, (trial, (path, before, after)) in enumerate(zip(source, expected, strict=True)):
            assert trial.name == f"stroke {index + 1}"
            assert trial.path.shape == path.shape
            assert np.abs(trial.path - path).max() <= EXECUTED_PATH
            for kept, came in ((trial.before, before), (trial.after, after)):
                assert kept.shape == came.shape
                assert kept.dtype == np.float32
                assert np.abs(kept - came).max() <= PHOTOGRAPH


def test_consecutive_strokes_share_a_photograph(three: Path) -> None:
    assert pngs(three) == ["0000.png", "0001.png", "0002.png", "0003.png"]
    trials = Trials.open(three)
    assert [greys(trial) for trial in trials] == [(0.8, 0.6), (0.6, 0.4), (0.4, 0.2)]
    assert all(trial.after.shape == (4, 6, 3) and trial.after[0, 0].tolist() == [1, 0, 0] for trial in trials)


def test_a_stroke_is_a_line_of_the_list_with_numbers_no_longer_than_they_mean_anything(tmp_path: Path) -> None:
    trials = Trials.make(tmp_path, medium="pen", pixels_per_metre=5000, depth=(0.00012345678, -0.01))
    trials.begin(paper(1))
    trials.append(np.array([[0.123456789, -1e-9, 2 / 3]]), paper(0))
    trials.append_darkness(PATH[:1], np.ones((2, 3)))
    assert (tmp_path / "trials.json").read_text() == (
        '{\n  "schema_version": 1,\n  "medium": "pen",\n  "pixels_per_metre": 5000.0,\n  "depth": [0.000123, -0.01],\n'
        '  "strokes": [\n    {"before":"0000.png","after":"0001.png","path":[[0.123457,0.0,0.666667]]},\n'
        '    {"after":"0002.png","path":[[0.01,0.02,0.0]]}\n  ]\n}\n'
    )


def test_collecting_goes_on_after_the_folder_was_opened_again(three: Path) -> None:
    Trials.open(three).append(PATH, paper(0))
    assert greys(Trials.open(three)[3]) == (0.2, 0)


def test_a_new_sheet_is_what_the_next_stroke_finds_even_after_a_restart(three: Path) -> None:
    Trials.open(three).begin(paper(1, 3, 2))
    trials = Trials.open(three)
    trials.append(PATH[:1], paper(0, 3, 2))
    assert [greys(trial) for trial in trials][2:] == [(0.4, 0.2), (1, 0)]
    assert trials[3].before.shape == (3, 2, 3)


def test_a_sheet_that_is_begun_twice_is_the_later_one(three: Path) -> None:
    trials = Trials.open(three)
    trials.begin(paper(1))
    trials.begin(paper(0.6))
    trials.append(PATH, paper(0))
    assert greys(trials[3]) == (0.6, 0)


def test_what_is_appended_cannot_change_what_was_there(three: Path) -> None:
    before = {name: (three / name).read_bytes() for name in pngs(three)}
    path, after = PATH.copy(), paper(0.25)
    trials = Trials.open(three)
    trials.append(path, after)
    assert np.array_equal(path, PATH)
    assert np.array_equal(after, paper(0.25))
    assert {name: (three / name).read_bytes() for name in before} == before
    with pytest.raises(ValueError, match="read-only"):
        trials[0].after[:] = 0


@settings(max_examples=25, deadline=None)
@given(darkness=arrays(np.float64, (2, 3), elements=st.floats(0, 1)), path=paths())
def test_a_stroke_known_by_its_darkness_alone_lies_on_empty_paper(
    tmp_path_factory: pytest.TempPathFactory, darkness: Floats, path: Floats
) -> None:
    trials = made(tmp_path_factory.mktemp("trials"))
    trials.append_darkness(path, darkness)
    trial = Trials.open(trials.folder)[0]
    assert trial.before.shape == trial.after.shape == (2, 3, 1)
    assert trial.before.dtype == trial.after.dtype == np.float32
    assert not trial.before.any()
    assert np.abs(trial.after[..., 0] - darkness).max() <= PHOTOGRAPH
    assert np.abs(trial.path - path).max() <= EXECUTED_PATH
    with Image.open(trials.folder / "0001.png") as image:
        assert image.mode == "L"


def test_a_photograph_after_a_darkness_image_needs_one_before(three: Path) -> None:
    trials = Trials.open(three)
    trials.append_darkness(PATH, np.ones((2, 2)))
    with pytest.raises(InputError, match="there is no photograph of the paper before the stroke; begin with one"):
        Trials.open(three).append(PATH, paper(0))
    trials.begin(paper(1))
    trials.append(PATH, paper(0))
    assert [greys(trial) for trial in Trials.open(three)][3:] == [(0, 1), (1, 0)]


def test_a_photograph_is_decoded_once_and_only_those_of_one_trial_are_kept(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    decoded: list[tuple[str, weakref.ref[Picture]]] = []

    def counted(path: Path) -> Picture:
        picture = read_picture(path)
        decoded.append((path.name, weakref.ref(picture)))
        return picture

    monkeypatch.setattr(module, "read_picture", counted)
    trials = Trials.open(three)
    assert decoded == []
    alive = []
    for index in range(3):
        assert greys(trials[index])[1] == round(0.6 - 0.2 * index, 6)
        alive.append([name for name, picture in decoded if picture() is not None])
    assert [name for name, _ in decoded] == ["0000.png", "0001.png", "0002.png", "0003.png"]
    assert alive == [["0000.png", "0001.png"], ["0001.png", "0002.png"], ["0002.png", "0003.png"]]


def test_a_lost_photograph_takes_only_its_own_strokes_with_it(three: Path) -> None:
    (three / "0001.png").unlink()
    trials = Trials.open(three)
    for index in (0, 1):
        with pytest.raises(InputError) as caught:
            trials[index]
        remedy = f"put it back into {three}"
        assert str(caught.value) == f"stroke {index + 1}: the photograph 0001.png is missing; {remedy}"
    assert greys(trials[2]) == (0.4, 0.2)


def test_the_name_of_a_lost_photograph_is_not_given_away(three: Path) -> None:
    (three / "0003.png").unlink()
    trials = Trials.open(three)
    trials.begin(paper(1))
    trials.append(PATH, paper(0))
    assert greys(trials[3]) == (1, 0)
    with pytest.raises(InputError, match=r"stroke 3: the photograph 0003\.png is missing"):
        trials[2]


def test_a_power_cut_between_photograph_and_list_loses_only_that_stroke(
    three: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def cut(path: Path, content: bytes) -> None:
        if path.suffix == ".json":
            raise OutputError("the lights went out")
        path.write_bytes(content)

    trials = Trials.open(three)
    with monkeypatch.context() as patch:
        patch.setattr(module, "atomic_write", cut)
        with pytest.raises(OutputError, match="the lights went out"):
            trials.append(PATH, paper(1))
    orphan = (three / "0004.png").read_bytes()
    (three / ".maulstick-0123.part").write_bytes(b"half a file")
    for source in (trials, Trials.open(three)):
        assert len(source) == 3
        source.append(PATH, paper(0))
        assert greys(source[3]) == (0.2, 0)
        assert (three / "0004.png").read_bytes() == orphan


def rgb(width: int, height: int) -> Image.Image:
    return Image.new("RGB", (width, height))


@pytest.mark.parametrize(
    ("damage", "text"),
    [
        (lambda png: png.write_bytes(b"hello"), "{png} is not a picture that can be read; save it as one of JPEG, PNG"),
        (lambda png: png.write_bytes(png.read_bytes()[:60]), "cannot read the picture {png}: "),
        (lambda png: png.write_bytes(b""), "the picture {png} is empty; make or copy it again"),
        (lambda png: (png.unlink(), png.mkdir()), "{png} is a folder; name the picture itself"),
        (
            lambda png: rgb(16, 10).save(png),
            "the photographs before and after have 6 x 4 and 16 x 10 pixels; rectify both to one size",
        ),
    ],
)
def test_a_photograph_that_cannot_be_used_is_reported_with_its_stroke(
    three: Path, damage: Callable[[Path], object], text: str
) -> None:
    damage(three / "0002.png")
    trials = Trials.open(three)
    with pytest.raises(InputError) as caught:
        trials[1]
    assert str(caught.value).startswith("stroke 2: " + text.format(png=three / "0002.png"))
    assert "\n" not in str(caught.value)
    assert greys(trials[0]) == (0.8, 0.6)


def test_a_photograph_may_be_grey_of_16_bits_or_transparent(three: Path) -> None:
    Image.fromarray(np.full((4, 6), 0.25 * 65535, dtype=np.uint16)).save(three / "0001.png")
    Image.new("RGBA", (6, 4), (0, 0, 0, 51)).save(three / "0002.png")
    trial = Trials.open(three)[1]
    assert np.abs(trial.before - 0.25).max() < 1 / 65535
    assert np.abs(trial.after - 0.8).max() <= PHOTOGRAPH


@pytest.mark.parametrize("mode", ["RGB", "LA", "RGBA", "I;16", "1", "P"])
def test_a_darkness_image_is_grey_or_refused(tmp_path: Path, mode: str) -> None:
    trials = made(tmp_path)
    trials.append_darkness(PATH, np.ones((2, 2)))
    Image.new(mode, (2, 2)).save(tmp_path / "0001.png")
    with pytest.raises(InputError) as caught:
        trials[0]
    remedy = "save it as 8-bit grey"
    assert str(caught.value) == f"stroke 1: the darkness image 0001.png is of mode {mode}; {remedy}"


def test_there_is_no_trial_before_the_first_or_after_the_last(three: Path) -> None:
    trials = Trials.open(three)
    for index in (-1, 3):
        with pytest.raises(IndexError, match=f"there is no trial {index}; there are 3, from 0"):
            trials[index]


@pytest.mark.parametrize(
    ("photograph", "text"),
    [
        (np.zeros((4, 5)), "a photograph has shape (4, 5); it must be (H, W, 3), with pixels in it"),
        (np.zeros((4, 5, 4)), "a photograph has shape (4, 5, 4); it must be (H, W, 3)"),
        (np.zeros((0, 5, 3)), "a photograph has shape (0, 5, 3); it must be (H, W, 3)"),
        (np.zeros((4, 5, 3), np.uint8), "a photograph is made of uint8; it must be made of floats in [0, 1], so"),
        (np.full((4, 5, 3), 255.0), "a photograph is from 255 to 255; it must be in [0, 1]"),
        (np.full((4, 5, 3), -0.01), "a photograph is from -0.01 to -0.01; it must be in [0, 1]"),
        (np.full((4, 5, 3), np.nan), "a photograph is from nan to nan; it must be in [0, 1]"),
    ],
)
def test_what_is_no_photograph_is_refused_and_nothing_written(three: Path, photograph: Any, text: str) -> None:
    trials = Trials.open(three)
    listed = (three / "trials.json").read_bytes()
    for take in (trials.begin, lambda after: trials.append(PATH, after)):
        with pytest.raises(InputError) as caught:
            take(photograph)
        assert str(caught.value).startswith(text)
    with pytest.raises(InputError, match=r"a darkness image (has shape|is made of|is from) .*; it must be "):
        trials.append_darkness(PATH, photograph if photograph.ndim == 3 else np.full((2, 2), 2.0))
    assert (three / "trials.json").read_bytes() == listed
    assert len(pngs(three)) == 4


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (np.zeros((0, 3)), "path: Tuple should have at least 1 item"),
        (np.zeros(3), "path[0]: Input should be a valid tuple (got 0.0)"),
        (np.zeros((2, 2)), "path[0][2]: Field required"),
        (np.zeros((2, 4)), "path[0]: Tuple should have at most 3 items"),
        (np.array([[0, 0, 1.1]]), "path[0][2]: Input should be less than or equal to 1 (got 1.1)"),
        (np.array([[0, 0, 0], [0, 0, -0.1]]), "path[1][2]: Input should be greater than or equal to 0 (got -0.1)"),
        (
            np.array([[0, -150.0, 0]]),
            "path[0][1]: it must be at most 100 metres, so divide millimetres by",
        ),
        (np.array([[0, np.nan, 0]]), "path[0][1]: Input should be a finite number (got nan)"),
        (np.array([[np.inf, 0, 0]]), "path[0][0]: Input should be a finite number (got inf)"),
    ],
)
def test_what_is_no_path_is_refused_and_nothing_written(three: Path, path: Floats, text: str) -> None:
    trials = Trials.open(three)
    listed = (three / "trials.json").read_bytes()
    with pytest.raises(InputError) as caught:
        trials.append(path, paper(0))
    with pytest.raises(InputError) as caught_too:
        trials.append_darkness(path, np.zeros((2, 2)))
    assert str(caught.value).startswith(f"stroke 4 cannot be kept: {text}")
    assert str(caught_too.value) == str(caught.value)
    assert (three / "trials.json").read_bytes() == listed
    assert len(pngs(three)) == 4


def test_strokes_cannot_be_appended_to_trials_that_have_not_begun(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no photograph of the paper before the stroke; begin with one"):
        made(tmp_path / "new").append(PATH, paper(0))


def test_photographs_that_cannot_be_written_leave_the_trials_as_they_were(three: Path) -> None:
    trials = Trials.open(three)
    three.rename(three.with_name("moved"))
    remedy = r"cannot write .*\.png: its folder does not exist; make the folder first"
    with pytest.raises(OutputError, match=remedy):
        trials.begin(paper(0))
    with pytest.raises(OutputError, match=remedy):
        trials.append(PATH, paper(0))
    assert len(trials) == 3


def test_trials_are_made_in_a_new_or_an_empty_folder_only(tmp_path: Path, three: Path) -> None:
    assert len(made(tmp_path / "a" / "new")) == 0
    assert list(Trials.open(tmp_path / "a" / "new")) == []
    (tmp_path / "empty").mkdir()
    assert len(made(tmp_path / "empty")) == 0
    for folder in (three, tmp_path / "empty"):
        with pytest.raises(OutputError) as caught:
            made(folder)
        assert str(caught.value) == f"the folder {folder} is not empty; choose another for the trials"
    assert len(Trials.open(three)) == 3
    (tmp_path / "file").write_text("kept")
    for folder in (tmp_path / "file", tmp_path / "file" / "new"):
        with pytest.raises(OutputError) as caught:
            made(folder)
        assert str(caught.value) == f"{folder} is or lies in a file; choose another folder for the trials"
    assert (tmp_path / "file").read_text() == "kept"
    with pytest.raises(OutputError, match=r"cannot make the folder .*: File name too long; choose another"):
        made(tmp_path / ("a" * 300))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"medium": ""}, "medium: String should have at least 1 character"),
        ({"medium": "a\nb"}, "medium: a name must be made of printable characters"),
        ({"pixels_per_metre": 0}, "pixels_per_metre: Input should be greater than 0 (got 0)"),
        ({"pixels_per_metre": float("inf")}, "pixels_per_metre: Input should be a finite number (got inf)"),
        ({"pixels_per_metre": 1e300}, "pixels_per_metre: it must be from 100 to 1000000 pixels per metre (got 1e+300)"),
        ({"depth": (0.0, 1e300)}, "depth[1]: it must be at most 100 metres, so divide millimetres by 1000 (got"),
        ({"depth": (0.0, float("nan"))}, "depth[1]: Input should be a finite number (got nan)"),
    ],
)
def test_trials_of_impossible_numbers_are_not_made(tmp_path: Path, change: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError) as caught:
        Trials.make(tmp_path / "new", **{"medium": "pen", "pixels_per_metre": 5000.0, **change})
    assert str(caught.value).startswith(f"there can be no such trials: {text}")
    assert not (tmp_path / "new").exists()


def of_stroke(index: int, **change: object) -> Callable[[dict[str, Any]], object]:
    return lambda content: content["strokes"][index].update(change)


@pytest.mark.parametrize(
    ("damage", "text"),
    [
        (
            lambda c: c.update(schema_version=2, more=1),
            "schema_version: it is 2, and this Maulstick reads version 1; up",
        ),
        (lambda c: c.update(schema_version=0), "schema_version: it is 0, and this Maulstick reads version 1; collect"),
        (lambda c: (c.update(schema_version=9), c.pop("medium")), "schema_version: it is 9"),
        (lambda c: c.pop("schema_version"), "schema_version: Field required"),
        (lambda c: c.pop("medium"), "medium: Field required"),
        (lambda c: c.update(pixels_per_metre=-1), "pixels_per_metre: Input should be greater than 0 (got -1)"),
        (lambda c: c.update(pixels_per_metre=1e-300), "pixels_per_metre: it must be from 100 to 1000000 pixels per"),
        (lambda c: c.update(pixels_per_metre="5"), "pixels_per_metre: Input should be a valid number (got '5')"),
        (lambda c: c.update(depth=[0]), "depth[1]: Field required"),
        (lambda c: c.update(strokes=None), "strokes: Input should be a valid array (got None)"),
        (lambda c: c.update(canvas=[1, 1]), "canvas: Extra inputs are not permitted"),
        (
            of_stroke(1, before="../a.png"),
            "stroke 2: before: a photograph must be a PNG of the same folder",
        ),
        (lambda c: c.update(paper="../a.png"), "paper: a photograph must be a PNG of the same folder"),
        (lambda c: c["strokes"].append(1), "stroke 4: Input should be an object (got 1)"),
        (of_stroke(1, path=[]), "stroke 2: path: Tuple should have at least 1 item"),
        (of_stroke(0, path=[[0, 0]]), "stroke 1: path[0][2]: Field required"),
        (of_stroke(2, path=[[0, 0, 1.2]]), "stroke 3: path[0][2]: Input should be less than or equal to 1 (got 1.2)"),
        (of_stroke(2, path=[[0, float("nan"), 1]]), "stroke 3: path[0][1]: Input should be a finite number (got nan)"),
        (of_stroke(0, style="free"), "stroke 1: style: Extra inputs are not permitted (got 'free')"),
        (lambda c: c["strokes"][0].pop("after"), "stroke 1: after: Field required"),
        (
            lambda c: c["strokes"].append(c["strokes"][1]),
            "strokes: stroke 4 is stroke 2 again, and would count twice; take one out",
        ),
    ],
)
def test_a_list_with_a_fault_is_refused_by_stroke_and_field(
    three: Path, damage: Callable[[dict[str, Any]], object], text: str
) -> None:
    path = three / "trials.json"
    content = json.loads(path.read_text())
    damage(content)
    path.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        Trials.open(three)
    assert str(caught.value).startswith(f"{path} is not a list of trials: {text}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "name", ["../0000.png", "/0000.png", "a/0000.png", "a\\0.png", "c:0.png", "..", ".a.png", "a.json", "a\n.png", ""]
)
def test_a_photograph_outside_the_folder_is_refused(three: Path, name: str) -> None:
    path = three / "trials.json"
    content = json.loads(path.read_text())
    content["strokes"][1]["after"] = name
    path.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        Trials.open(three)
    expected = "stroke 2: after: a photograph must be a PNG of the same folder, named without folders"
    assert str(caught.value).startswith(f"{path} is not a list of trials: {expected}")


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"hello", " is not a list of trials: the file: Invalid JSON: expected value at line 1 column 1"),
        (b"[1, 2]", " is not a list of trials: the file: Input should be an object"),
        (b"\x89PNG\r\n\x1a\n", " is not a list of trials: the file: Invalid JSON"),
        (b'{"schema_version": 1, "canvas": {}, "strokes": []}', " is not a list of trials: medium: Field required"),
    ],
)
def test_a_list_that_is_something_else_is_refused(three: Path, content: bytes, text: str) -> None:
    (three / "trials.json").write_bytes(content)
    with pytest.raises(InputError) as caught:
        Trials.open(three)
    assert str(caught.value).startswith(f"{three / 'trials.json'}{text}")


def test_a_truncated_list_is_refused_wherever_it_ends(three: Path) -> None:
    path = three / "trials.json"
    whole = path.read_bytes()
    for length in range(1, len(whole) - 2, 13):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"is not a list of trials: the file: Invalid JSON: EOF while parsing"):
            Trials.open(three)


def test_trials_that_are_missing_a_file_or_huge_are_refused(tmp_path: Path, three: Path) -> None:
    for folder in (tmp_path / "none", tmp_path):
        with pytest.raises(InputError) as caught:
            Trials.open(folder)
        assert str(caught.value) == f"there is no list of trials {folder / 'trials.json'}; check its name and folder"
    with pytest.raises(InputError) as caught:
        Trials.open(three / "trials.json")
    remedy = "name the folder of the trials, the one with trials.json in it"
    assert str(caught.value) == f"{three / 'trials.json'} is a file; {remedy}"
    with (three / "trials.json").open("wb") as file:
        file.truncate(2**34)  # a hole: it takes no disk
    with pytest.raises(InputError, match=r"trials\.json is larger than 256 MiB, too large for a list of trials"):
        Trials.open(three)


def test_the_list_in_the_docs_is_read(tmp_path: Path) -> None:
    (listed,) = blocks(DOCS / "brushes.md", "json")
    (tmp_path / "trials.json").write_text(listed, encoding="utf-8")
    for number in range(3):
        Image.new("RGB", (400, 400), "white").save(tmp_path / f"{number:04}.png")
    trials = list(Trials.open(tmp_path))
    assert [trial.path.shape for trial in trials] == [(2, 3), (2, 3)]
