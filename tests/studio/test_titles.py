"""Titles of things: kept as they were typed, in any script, beside names that are never paths."""

import asyncio
import os
import re
import unicodedata
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.storage.library import NAME
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.thrown import RECORD
from maulstick.studio.state.titles import (
    MOST_LETTERS,
    clean_title,
    file_name,
    label_of,
    numbered,
    plain_name,
    relabel,
    retitle,
    title_of,
    title_of_file,
    titles_apart,
)
from tests.support.studio.plans_to_paint import put_plan

TITLES = {
    "Dr. Anna's hand": "dr-anna-s-hand",
    "Élodie Müller-Łódź": "elodie-muller-lodz",
    "Анна": "",
    "安娜": "",
    "می‌خواهم": "",  # with a ZWNJ
    "हिन्दी 👩‍🎨": "",  # with a ZWJ
}
"""Titles in five scripts, with their plain names."""


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Folder]:
    with Folder.opened(tmp_path / "studio") as opened:
        yield opened


@pytest.mark.parametrize("title", TITLES)
def test_a_title_is_kept_as_it_was_typed_and_has_a_plain_name(folder: Folder, title: str) -> None:
    assert clean_title(f"  {title}\t\n") == title
    assert plain_name(title) == TITLES[title]
    name = folder.free_name("hands", title)
    assert name == (TITLES[title] or "hand")
    folder.of("hands", name).mkdir()
    assert retitle(folder.of("hands", name), title) == title
    assert folder.titles("hands") == {name: folder.title("hands", name)}
    assert title in folder.title("hands", name)
    assert title_of(folder.of("hands", name)) == title


@given(st.text(max_size=200))
@settings(max_examples=300, deadline=None)
@example("a" + "\N{COMBINING ACUTE ACCENT}" * 200)
@example("👩‍🎨" * 60)
@example("\ue000option:px\ue001")
@example("x\ud800y")
@example("\N{ZERO WIDTH JOINER}")
def test_any_text_is_one_line_that_can_be_seen_kept_and_saved(
    tmp_path_factory: pytest.TempPathFactory, typed: str
) -> None:
    title = clean_title(typed)
    assert len(title) <= MOST_LETTERS
    assert clean_title(title) == title == unicodedata.normalize("NFC", title.strip())
    assert not {unicodedata.category(letter) for letter in title} & {"Cc", "Cs", "Co", "Zl", "Zp"}
    assert re.fullmatch(rf"({NAME})?", plain_name(title))
    assert not re.search(r'[\\/:*?"<>|]', file_name(title, "-painting.json"))
    assert len(file_name(title, "-painting.json").encode()) <= 255
    thing = tmp_path_factory.getbasetemp() / "thing"
    thing.mkdir(exist_ok=True)
    if title:
        retitle(thing, typed)
        assert title_of(thing) == title
    else:
        with pytest.raises(InputError, match="there is no title yet; write one"):
            retitle(thing, typed)


@pytest.mark.parametrize(
    ("typed", "kept"),
    [
        ("a\u202eb\u2066c\u200fd", "abcd"),
        ("two\r\nlines\u2028and\u0085more", "two lines and more"),
        ("a\0b\x1b[31m", "ab[31m"),
        ("e\N{COMBINING ACUTE ACCENT}", "é"),
        ("x" * 79 + "e\N{COMBINING DOT BELOW}\N{COMBINING MACRON BELOW}", "x" * 79),
        ("👩‍🎨" * 27, "👩‍🎨" * 26),
    ],
)
def test_what_would_turn_or_break_a_line_is_left_out_and_no_letter_is_cut(typed: str, kept: str) -> None:
    assert clean_title(typed) == kept


@pytest.mark.parametrize(
    ("file", "title"),
    [
        ("Dr. Anna's hand.SVG", "Dr. Anna's hand"),
        ("Dr. Anna's hand", "Dr. Anna's hand"),
        ("C:\\pictures\\cat.v2.jpeg", "cat.v2"),
        ("hand.ink.npz", "hand"),
        (".png", ""),
        ("安娜.heic", "安娜"),
    ],
)
def test_a_file_that_is_brought_loses_its_ending_alone(file: str, title: str) -> None:
    assert title_of_file(file) == title


def test_two_of_one_title_are_told_apart_by_name_and_what_comes_by_itself_by_number() -> None:
    assert titles_apart({"a": "Cat", "b": "Cat", "c": "Dog"}) == {"a": "Cat (a)", "b": "Cat (b)", "c": "Dog"}
    assert titles_apart({"cat": "cat", "cat-2": "cat"}) == {"cat": "cat", "cat-2": "cat (cat-2)"}
    assert titles_apart({"a": "آنا"}) == {"a": "\N{FIRST STRONG ISOLATE}آنا\N{POP DIRECTIONAL ISOLATE}"}
    assert numbered("Cat", ["Cat", "Cat 2"]) == "Cat 3"
    assert numbered("x" * 80, ["x" * 80]) == "x" * 78 + " 2"


def test_a_folder_without_a_title_or_with_a_broken_one_shows_its_name(folder: Folder) -> None:
    cat = folder.of("plans", "cat")
    cat.mkdir()
    for content in ("", "{", '{"title": 3}', '{"title": "\\u202e"}', '{"version": 9, "title": "x"}'):
        (cat / "title.json").write_text(content)
        assert title_of(cat) == "cat"
    (cat / "title.json").write_text('{"title": "by\\nhand"}')
    assert title_of(cat) == "by hand"


def test_a_new_title_leaves_the_note_the_star_and_the_age(folder: Folder) -> None:
    for name in ("old", "new"):
        folder.of("plans", name).mkdir()
    os.utime(folder.of("plans", "old"), (1e9, 1e9))
    relabel(folder.of("plans", "old"), note="too dark", starred=True)
    retitle(folder.of("plans", "old"), "Old")
    label = label_of(folder.of("plans", "old"))
    assert (label.title, label.note, label.starred) == ("Old", "too dark", True)
    assert folder.names("plans") == ["old", "new"]


def test_what_is_thrown_away_meanwhile_gets_no_title_and_is_said_to_be_in_the_trash(folder: Folder) -> None:
    with pytest.raises(InputError, match="six is there no more; look in the trash"):
        retitle(folder.of("plans", "six"), "Six")
    assert not folder.of("plans", "six").exists()


def test_titles_go_through_the_trash_and_back_in_a_studio_opened_later(tmp_path: Path) -> None:
    async def throw(root: Path) -> None:
        with Folder.opened(root) as folder:
            studio = Studio(folder)
            for plan in list(studio.plans.plans.values()):
                studio.plans.relabel(plan, title=list(TITLES)[int(plan.name[-1])])
                studio.plans.throw_away(plan)
            await studio.close()

    async def put_back(root: Path) -> dict[str, str]:
        with Folder.opened(root) as folder:
            studio = Studio(folder)
            things = studio.trash.things()
            assert [(thing.title, thing.where) for thing in things] == [(each, "plans") for each in reversed(TITLES)]
            for thing in things:
                assert studio.trash.picture(thing.id) is not None
                studio.trash.put_back(thing, studio.trash.free_name(thing))
            assert studio.trash.things() == []
            titles = {name: plan.title for name, plan in studio.plans.plans.items()}
            await studio.close()
            return titles

    for number in range(len(TITLES)):
        put_plan(tmp_path / "studio", f"plan-{number}")
    asyncio.run(throw(tmp_path / "studio"))
    found = asyncio.run(put_back(tmp_path / "studio"))
    assert found == {f"plan-{number}": title for number, title in enumerate(TITLES)}


def test_what_lost_its_name_comes_back_under_a_free_one_and_settings_change_places(tmp_path: Path) -> None:
    put_plan(tmp_path / "studio", "cat")

    async def live() -> None:
        with Folder.opened(tmp_path / "studio") as folder:
            studio = Studio(folder)
            studio.plans.relabel(studio.plans.of("cat"), title="Кот")
            studio.plans.throw_away(studio.plans.of("cat"))
            put_plan(folder.root, "cat")
            (thing,) = studio.trash.things()
            assert studio.trash.free_name(thing) == "cat-2"
            studio.trash.put_back(thing, "cat-2")
            assert studio.plans.of("cat-2").title == "Кот"
            with pytest.raises(InputError, match="it was taken out of the trash already"):
                studio.trash.thing(thing.id)

            for tubes in (b"ochre,#c08a35", b"umber,#6b4a2a"):
                await studio.mixing.use_tubes(tubes)
            (former,) = studio.trash.things()
            studio.trash.put_back(former, studio.trash.free_name(former))
            assert [tube.name for tube in studio.mixing.tubes()] == ["ochre"]
            (latter,) = studio.trash.things()
            assert b"umber" in (folder.root / "trash" / latter.id / "tubes.csv").read_bytes()
            await studio.close()

    asyncio.run(live())


def test_what_an_earlier_studio_threw_away_is_listed_by_its_names_and_stays(folder: Folder) -> None:
    async def look() -> None:
        studio = Studio(folder)
        trash = folder.throw_away(folder.of("plans", "cat"))
        (trash / RECORD).unlink()
        (folder.root / "trash" / "notes").mkdir()
        (thing,) = studio.trash.things()
        assert (thing.title, thing.where) == ("cat", None)
        with pytest.raises(InputError, match="nothing says where that was; move it by hand"):
            studio.trash.put_back(thing, "cat")
        for id in ("..", "notes", "../plans", "1-00000000"):
            assert studio.trash.picture(id) is None
        await studio.close()

    folder.of("plans", "cat").mkdir()
    asyncio.run(look())


def test_a_hand_keeps_its_folder_near_its_title_and_a_learned_style_has_the_title(tmp_path: Path) -> None:
    async def rename(folder: Folder) -> list[tuple[str, str]]:
        studio, seen = Studio(folder), []
        drawing = studio.drawing
        drawing.add(1000, [0.0, 10, 10, 0.2, 5, -5, 8.0, 20, 15, 0.7, 6, -6])
        await drawing.close()
        for title in ("Élodie", "Elodie", "安娜", "安娜 2"):
            await drawing.rename(title)
            assert title_of(folder.of("hands", drawing.name)) == title
            seen.append((drawing.name, drawing.title))
        await studio.close()
        return seen

    with Folder.opened(tmp_path / "studio") as folder:
        assert asyncio.run(rename(folder)) == [
            ("elodie", "Élodie"),
            ("elodie", "Elodie"),
            ("hand", "安娜"),
            ("hand-2", "安娜 2"),
        ]
