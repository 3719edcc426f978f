"""Styles of the studio: what the desk computes of them, what happens to their files, and how they are drawn."""

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from scipy.spatial.distance import pdist

from maulstick.errors import InputError, MaulstickError, OutputError
from maulstick.strokes.strokes import path_lengths
from maulstick.studio.panels.styles.map import HIGH, WIDE, description_of, large_svg, map_svg, neighbours
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.styles import Styles
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.spread import spread_apart
from maulstick.studio.workers.style_work import Difference, Map
from maulstick.style.cards import STYLES, style_path
from maulstick.style.store import read_style, write_style
from tests.support.style.synthetic_hands import circle, exemplar_of

THREE = ["cursive", "loops", "hatching"]


def write_own(name: str) -> Path:
    """Write a style among the user's own; return its JSON file."""
    return write_style(replace(exemplar_of(circle, 8), name=name), "me.ink.npz", STYLES.own())


@pytest.fixture
def styles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Styles]:
    """Styles that come with Maulstick, and one of the user's own, `cat`."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    write_own("cat")
    with Folder.opened(tmp_path / "studio") as folder:
        yield Styles(folder, Desk())


@dataclass(frozen=True)
class Found:
    """Results of the desk."""

    sheets: list[Path]
    size: tuple[int, int]
    refusal: str
    arranged: list[str]
    map: Map
    differences: tuple[Difference, ...]


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Found]:
    """Results for all tests from one desk, whose process takes seconds to start."""

    async def find(folder: Folder) -> Found:
        desk = Desk()
        styles = Styles(folder, desk)
        try:
            sheet = await styles.sheet("loops")
            drawn = sheet.stat().st_mtime_ns
            again = await styles.sheet("loops")
            assert again.stat().st_mtime_ns == drawn
            with pytest.raises(MaulstickError) as refused:
                await styles.sheet("torn")
            with Image.open(sheet) as picture:
                size = picture.size
            return Found(
                [sheet, again],
                size,
                str(refused.value),
                [name for name in (*THREE, "elephant") if await styles.is_arranged(name)],
                await styles.map_of(THREE),
                await styles.differences_of(THREE),
            )
        finally:
            desk.close()

    root = tmp_path_factory.mktemp("styles")
    with pytest.MonkeyPatch.context() as patch, Folder.opened(root / "studio") as folder:
        patch.setenv("XDG_DATA_HOME", str(root / "data"))
        write_own("torn").with_suffix(".safetensors").write_bytes(b"\x80\x04cos\nsystem\n")
        yield asyncio.run(find(folder))


def test_a_sheet_is_drawn_once_and_kept(found: Found) -> None:
    assert found.sheets[0] == found.sheets[1]
    assert found.size[0] > found.size[1] > 500


def test_a_style_with_damaged_arrays_is_refused_in_a_sentence(found: Found) -> None:
    assert "torn.safetensors does not belong to" in found.refusal
    assert "\n" not in found.refusal


def test_a_style_of_a_whole_drawing_is_arranged_and_others_are_not(found: Found) -> None:
    assert found.arranged == ["elephant"]


def test_a_map_has_every_stroke_of_its_styles_once_and_with_its_length(found: Found) -> None:
    hands = [read_style(style_path(name)).hand for name in THREE]
    assert found.map.names == tuple(THREE)
    assert np.bincount(found.map.whose).tolist() == [len(hand) for hand in hands]
    assert found.map.strokes == len(found.map.whose)
    assert np.array_equal(found.map.lengths, np.concatenate([path_lengths(hand.paths) for hand in hands]))
    assert np.abs(found.map.places).max() <= 0.5


def test_no_spot_of_a_map_lies_on_another(found: Found) -> None:
    spots = ElementTree.fromstring(map_svg(found.map)).findall("g/circle")
    centres = np.array([[float(spot.attrib[axis]) for axis in ("cx", "cy")] for spot in spots])
    across = 2 * float(spots[0].attrib["r"])
    assert pdist(centres).min() >= across - 0.2, "to the tenth of a unit that is written"
    assert across > 0.6 * np.sqrt(WIDE * HIGH / len(spots)), "and each can be pointed at"


@given(st.lists(st.tuples(*[st.floats(-0.5, 0.5)] * 2), min_size=1, max_size=60))
def test_places_that_are_moved_apart_stay_on_the_map(places: list[tuple[float, float]]) -> None:
    moved = spread_apart(np.array(places), 1.4)
    assert np.abs(moved).max() <= 0.5
    assert pdist(moved * [1.4, 1]).min(initial=1.0) > 0.5 * np.sqrt(1.4 / len(places))


def test_hands_that_draw_other_strokes_are_farther_apart(found: Found) -> None:
    apart = {(each.first, each.second): each for each in found.differences}
    assert list(apart) == [("cursive", "loops"), ("cursive", "hatching"), ("loops", "hatching")]
    assert apart["loops", "hatching"].distance > 2 * apart["cursive", "loops"].distance > 0
    assert apart["cursive", "loops"].accuracy < apart["loops", "hatching"].accuracy <= 1
    assert "bend less" in apart["loops", "hatching"].words


def test_the_drawing_of_a_map_has_a_path_for_each_stroke_and_no_name_in_it(found: Found) -> None:
    drawn = ElementTree.fromstring(map_svg(replace(found.map, names=("<script>",) * 3)))
    paths = drawn.findall("g/path")
    assert [path.attrib["data-stroke"] for path in paths] == [str(number) for number in range(len(found.map.whose))]
    assert [path.attrib["tabindex"] for path in paths].count("0") == 1
    assert not drawn.findall(".//script")
    large = ElementTree.fromstring(large_svg(found.map.paths[0], 0))
    numbers = [float(each) for each in large.findall("path")[0].attrib["d"][1:].replace("L", " ").split()]
    assert 0 < min(numbers) < max(numbers) < 600


def test_a_stroke_is_description_of_as_far_as_anybody_knows(found: Found) -> None:
    some = replace(found.map, lengths=np.array([0.0123]), speeds=np.array([0.1]), pressure=np.array([np.nan]))
    some = replace(some, whose=np.array([1]))
    assert description_of(some, 0) == "Stroke 1 of 1, by loops, 12.3 mm long, drawn at 100 mm per second"
    pressed = replace(some, speeds=np.array([np.nan]), pressure=np.array([0.4]))
    assert description_of(pressed, 0) == "Stroke 1 of 1, by loops, 12.3 mm long, pen pressure 40 %"


def test_an_arrow_key_leads_to_the_nearest_stroke_on_that_side() -> None:
    #  1 . 0 . . 2     left, right, up, down
    #      3
    centres = np.array([[0.0, 0.0], [-2.0, 0.0], [3.0, 0.5], [0.0, 1.0]])
    assert neighbours(centres)[0].tolist() == [1, 2, 0, 3]
    assert neighbours(centres)[3].tolist() == [1, 2, 0, 3]
    assert neighbours(np.zeros((2, 2))).tolist() == [[0] * 4, [1] * 4]


def test_a_broken_card_is_an_entry_that_says_why(styles: Styles) -> None:
    (STYLES.own() / "torn.json").write_text("{")
    assert [styles.entry(name).name for name in styles.names()][-2:] == ["cat", "torn"]
    broken, whole = styles.entry("torn"), styles.entry("cat")
    assert broken.card is None
    assert "torn.json is not a style" in broken.fault
    assert whole.card is not None
    assert (whole.card.strokes, whole.is_built_in, styles.entry("loops").is_built_in) == (8, False, True)


def test_a_style_is_renamed_and_all_pages_know(styles: Styles) -> None:
    told: list[list[str]] = []
    styles.changed.subscribe(lambda: told.append(styles.names()))
    assert asyncio.run(styles.rename("cat", "Änna")) == "anna"
    (names,) = told
    assert "anna" in names
    assert "cat" not in names
    assert style_path("cat") == style_path("anna"), "plans that ask for it still find it"
    assert asyncio.run(styles.rename("anna", "Ännä")) == "anna", "its name is its own"
    assert styles.titles()["anna"] == "Ännä"


@pytest.mark.parametrize(
    ("title", "name"),
    [("loops", "loops-2"), ("free", "free-2"), ("<b>cat</b>", "b-cat-b"), ("../cat", "cat"), ("安娜", "style")],
)
def test_any_title_gives_a_style_a_name_that_none_has(styles: Styles, title: str, name: str) -> None:
    assert asyncio.run(styles.rename("cat", title)) == name
    assert styles.own_title(name) == title
    assert read_style(style_path(name)).name == name


@pytest.mark.parametrize(
    ("name", "new", "text"),
    [
        ("cat", " \N{RIGHT-TO-LEFT OVERRIDE}\n", "there is no title yet; write one"),
        ("loops", "mine", "there is no style of your own called 'loops'"),
        ("nobody", "mine", "there is no style of your own called 'nobody'"),
    ],
)
def test_a_name_that_cannot_be_is_refused_and_nothing_moves(styles: Styles, name: str, new: str, text: str) -> None:
    before = sorted(STYLES.own().iterdir())
    with pytest.raises((InputError, OutputError)) as caught:
        asyncio.run(styles.rename(name, new))
    assert str(caught.value).startswith(text)
    assert sorted(STYLES.own().iterdir()) == before


def test_a_deleted_style_is_had_again_whole(styles: Styles) -> None:
    before = {path.name: path.read_bytes() for path in STYLES.own().iterdir()}
    thrown = asyncio.run(styles.delete("cat"))
    assert "cat" not in styles.names()
    assert not list(STYLES.own().iterdir())
    assert styles.thrown_away == [thrown]
    styles.take_back(thrown.trashed)
    assert {path.name: path.read_bytes() for path in STYLES.own().iterdir()} == before
    assert styles.thrown_away == []
    with pytest.raises(InputError, match="it was taken out of the trash already"):  # another page was quicker
        styles.take_back(thrown.trashed)


def test_a_deleted_style_does_not_come_back_over_another(styles: Styles) -> None:
    asyncio.run(styles.delete("cat"))
    write_own("cat")
    with pytest.raises(OutputError, match=r"another one has the name cat\.\w+ by now"):
        styles.take_back(styles.thrown_away[0].trashed)
    assert len(styles.thrown_away) == 1, "it can still be had under another name"
    styles.take_back(styles.thrown_away[0].trashed, "cat-2")
    assert read_style(style_path("cat-2")).name == "cat-2"


def test_a_style_that_is_learned_anew_is_in_its_place_until_then_and_afterwards_in_the_trash(styles: Styles) -> None:
    before = (STYLES.own() / "cat.json").read_bytes()

    async def learn() -> None:
        assert (STYLES.own() / "cat.json").read_bytes() == before
        write_style(replace(exemplar_of(circle, 9), name="cat"), "me.ink.npz", STYLES.own())

    assert asyncio.run(styles.renew("cat", learn))
    (thrown,) = styles.thrown_away
    assert (thrown.trashed / "cat.json").read_bytes() == before
    assert read_style(thrown.trashed / "cat.json").name == "cat"
    assert len(read_style(style_path("cat")).hand) == 9


def test_a_style_that_cannot_be_learned_anew_stays_and_leaves_nothing_in_the_trash(styles: Styles) -> None:
    async def fail() -> None:
        raise InputError("draw more")

    with pytest.raises(InputError, match="draw more"):
        asyncio.run(styles.renew("cat", fail))
    assert len(read_style(style_path("cat")).hand) == 8
    assert list(styles.sheets.parents[1].joinpath("trash").iterdir()) == []
    assert styles.thrown_away == []


def test_what_comes_with_maulstick_stays(styles: Styles) -> None:
    with pytest.raises(InputError, match="the style loops comes with Maulstick and stays; only your own"):
        asyncio.run(styles.delete("loops"))
    assert "loops" in styles.names()


@pytest.mark.parametrize("names", [[], ["loops"], ["loops", "loops"], ["loops", "nobody"]])
def test_what_cannot_be_compared_is_refused_before_the_desk_is_asked(styles: Styles, names: list[str]) -> None:
    with pytest.raises(InputError, match=r"there is no style 'nobody'|the number of styles is [01]; it must be from 2"):
        asyncio.run(styles.differences_of(names))
