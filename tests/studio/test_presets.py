"""Settings of a plan that are kept under titles and shared as files, without a page."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.presets import Preset, Presets
from maulstick.studio.state.settings import Choices

INK = Choices(machine="axidraw", brush="micron-01", kind="ink", strokes=900, weights={"edges": 0.5}, paper="#eee8d0")
OIL = Choices(style="elephant", paints=7)


@pytest.fixture
def presets(tmp_path: Path) -> Presets:
    with Folder.opened(tmp_path / "studio") as folder:
        return Presets(folder)


def test_settings_are_kept_under_titles_in_any_script_and_are_there_in_a_studio_that_is_opened_later(
    presets: Presets, tmp_path: Path
) -> None:
    for title, settings in (("Ink, Élodie", INK), ("安娜", OIL)):
        assert not presets.keep(title, settings)
    with Folder.opened(tmp_path / "studio") as folder:
        later = Presets(folder)
    assert [*later.titles().values()] == ["Ink, Élodie", "安娜"]
    assert [later.of(name).settings for name in later.titles()] == [INK, OIL]


def test_what_a_title_stood_for_before_goes_into_the_trash(presets: Presets, tmp_path: Path) -> None:
    presets.keep("Ink", INK)
    assert presets.keep("Ink", OIL)
    assert presets.of("ink").settings == OIL
    (former,) = (tmp_path / "studio" / "trash").glob("*/ink.json")
    assert Preset.read(former.read_bytes(), "it").settings == INK


def test_settings_that_were_thrown_away_are_taken_back(presets: Presets) -> None:
    presets.keep("Ink", INK)
    trashed = presets.throw_away("ink")
    assert presets.titles() == {}
    presets.take_back(trashed)
    assert presets.of("ink") == Preset.of("Ink", INK)


def test_a_file_is_read_as_it_was_written_and_people_can_read_it_too(presets: Presets) -> None:
    written = Preset.of("Ink", INK).written()
    assert Preset.read(written, "it") == Preset.of("Ink", INK)
    plain = json.loads(written)
    assert (plain["format"], plain["version"], plain["title"]) == ("maulstick settings of a plan", 1, "Ink")
    assert plain["settings"]["weights"] == {"edges": 0.5}
    assert "/" not in written.decode()


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"", "Invalid JSON"),
        (b"{nonsense", "Invalid JSON"),
        (b"[1]", "the file: Input should be an object; choose"),
        (b"{}", "format: Field required"),
        (b'{"format": "vpype", "version": 1, "settings": {}}', "format: Input should be"),
        (b'{"format": "maulstick settings of a plan", "version": 2, "settings": {}}', "version: Input should be 1"),
        (
            b'{"format": "maulstick settings of a plan", "version": 1, "settings": {"strokes": "many"}}',
            "settings.strokes: Input should be a valid integer",
        ),
        (
            b'{"format": "maulstick settings of a plan", "version": 1, "settings": {"hand_size": NaN}}',
            "settings.hand_size: Input should be",
        ),
    ],
)
def test_a_file_that_holds_none_is_refused_in_a_sentence(content: bytes, fault: str) -> None:
    with pytest.raises(InputError, match=r"^cat\.json holds no settings of a plan: ") as refused:
        Preset.read(content, "cat.json")
    assert fault in str(refused.value)
    assert "b'" not in str(refused.value), "no bytes as Python writes them"
    assert "\n" not in str(refused.value)


@given(st.binary(max_size=200))
def test_any_file_is_read_or_refused(content: bytes) -> None:
    with pytest.raises(InputError):
        Preset.read(content, "it")


def test_what_another_version_added_is_passed_over(presets: Presets) -> None:
    plain = json.loads(Preset.of("Ink", INK).written())
    plain["settings"]["smell"] = plain["smell"] = "oil"
    assert Preset.read(json.dumps(plain).encode(), "it").settings == INK


def test_a_file_that_somebody_put_there_and_that_holds_none_is_left_out(presets: Presets, tmp_path: Path) -> None:
    presets.keep("Ink", INK)
    (tmp_path / "studio" / "presets" / "broken.json").write_text("{")
    (tmp_path / "studio" / "presets" / "Not A Name.json").write_bytes(Preset.of("x", INK).written())
    assert presets.titles() == {"ink": "Ink"}
    presets.keep("Broken", OIL)
    assert presets.titles() == {"broken-2": "Broken", "ink": "Ink"}


@pytest.mark.parametrize("name", ["../settings", "", "a/b", "nowhere"])
def test_a_name_of_none_is_refused(presets: Presets, name: str) -> None:
    with pytest.raises(InputError):
        presets.of(name)
