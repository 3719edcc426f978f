"""What was chosen last for a plan: kept in the studio's folder, and never a reason to fail."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.studio.state.folder import Folder
from maulstick.studio.state.settings import Choices, Settings

CHOSEN = {"machine": "axidraw", "brush": "micron-01", "kind": "ink", "strokes": 900, "weights": {"edges": 0.5}}


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    with Folder.opened(tmp_path / "studio") as folder:
        return folder


def kept(folder: Folder, *all_values: dict[str, Any]) -> Choices:
    """Keep values one after another, write them, and return what a studio that is opened later begins with."""

    async def keep() -> None:
        settings = Settings(folder)
        for values in all_values:
            settings.keep(values)
        settings.write()

    asyncio.run(keep())
    return Settings(folder).choices


def test_what_was_chosen_is_there_in_a_studio_that_is_opened_later(folder: Folder) -> None:
    assert Settings(folder).choices == Choices()
    assert kept(folder, CHOSEN) == Choices.model_validate(CHOSEN)
    assert kept(folder, {"strokes": 20}) == Choices.model_validate({**CHOSEN, "strokes": 20})


def test_a_text_is_not_kept(folder: Folder) -> None:
    kept(folder, {**CHOSEN, "text": "a secret"})
    assert "secret" not in (folder.root / "settings.json").read_text()


def test_it_is_written_by_itself_a_little_later(folder: Folder) -> None:
    async def keep() -> None:
        Settings(folder).keep(CHOSEN)
        while not (folder.root / "settings.json").is_file():
            await asyncio.sleep(0.02)

    asyncio.run(keep())
    assert Settings(folder).choices.machine == "axidraw"


@pytest.mark.parametrize(
    "wrong",
    [{"strokes": None}, {"strokes": 0.5}, {"hand_size": -1}, {"kind": "oil"}, {"brush": "x" * 1000},
     {"weights": {"tone": "much"}}],
)  # fmt: skip
def test_what_is_half_typed_or_out_of_its_range_leaves_that_as_it_was_and_keeps_the_rest(
    folder: Folder, wrong: dict[str, Any]
) -> None:
    expected = Choices.model_validate({**CHOSEN, "style": "elephant"})
    assert kept(folder, CHOSEN, {"style": "elephant", **wrong}) == expected


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"\xff\xfe",
        b'{"schema_version": 2}',
        b'{"schema_version": 1, "strokes": "many"}',
        b"0" * 2**21,
    ],
)
def test_a_file_that_is_broken_or_of_another_version_counts_as_none(folder: Folder, content: bytes) -> None:
    (folder.root / "settings.json").write_bytes(content)
    assert Settings(folder).choices == Choices()
    assert kept(folder, CHOSEN) == Choices.model_validate(CHOSEN)


def test_what_another_version_added_is_passed_over(folder: Folder) -> None:
    (folder.root / "settings.json").write_text(json.dumps({"schema_version": 1, "machine": "grbl", "smell": "oil"}))
    assert Settings(folder).choices == Choices(machine="grbl")


def test_a_folder_in_its_place_is_no_reason_to_fail(folder: Folder) -> None:
    (folder.root / "settings.json").mkdir()
    assert kept(folder, CHOSEN) == Choices()


@given(st.binary(max_size=200))
def test_no_file_makes_it_fail(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    with Folder.opened(tmp_path_factory.mktemp("studio")) as folder:
        (folder.root / "settings.json").write_bytes(content)
        assert Settings(folder).choices == Choices()
