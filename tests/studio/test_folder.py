"""Folder of the studio: names are never paths, and the trash loses nothing."""

import errno
import os
from pathlib import Path
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError, OutputError
from maulstick.studio.state.folder import KINDS, Folder
from maulstick.studio.state.thrown import RECORD


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    with Folder.opened(tmp_path / "studio") as folder:
        return folder


def contents(root: Path) -> dict[str, bytes]:
    files = [path for path in sorted(root.rglob("*")) if path.is_file() and path.name != RECORD]
    return {str(path.relative_to(root)): path.read_bytes() for path in files}


@pytest.mark.parametrize(
    "name",
    ["", ".", "..", "../x", "a/b", "a\\b", "/etc", "a\0", "a\n", "A", "ä", "-a", "_a", "a.b", "%2e%2e", "a" * 41, "٣"],
)
def test_what_is_no_name_is_never_a_path(folder: Folder, name: str) -> None:
    with pytest.raises(InputError, match="is no name; use up to 40 of a-z, 0-9 and -"):
        folder.of("plans", name)


@pytest.mark.parametrize("kind", ["", "trash", "..", "plans/..", "Plans", "/"])
def test_there_are_no_other_kinds(folder: Folder, kind: str) -> None:
    with pytest.raises(InputError):
        folder.of(kind, "a")


@given(wish=st.text(max_size=80), kind=st.sampled_from(KINDS))
@settings(max_examples=100, deadline=None)
def test_any_wish_becomes_a_name_that_is_free(tmp_path_factory: pytest.TempPathFactory, wish: str, kind: str) -> None:
    with Folder.opened(tmp_path_factory.getbasetemp() / "wishes") as folder:
        name = folder.free_name(kind, wish)
        path = folder.of(kind, name)
        assert path.parent == folder.root / kind
        path.mkdir()
        assert folder.free_name(kind, wish) != name


def test_a_wish_for_a_path_is_its_last_word(folder: Folder) -> None:
    assert folder.title_for_file("plans", "../../etc/My Cat's portrait.JPG") == "My Cat's portrait"
    assert folder.free_name("plans", "My Cat's portrait") == "my-cat-s-portrait"
    assert folder.free_name("plans", "..") == "plan"
    assert folder.free_name("surveys", "猫") == "survey"
    assert len(folder.free_name("plans", "a" * 5000)) == 32


def test_names_are_told_oldest_first_whatever_else_lies_there(folder: Folder) -> None:
    plans = folder.root / "plans"
    for age, name in enumerate(["new", "old", "older"]):
        (plans / name).mkdir()
        os.utime(plans / name, (1e9 - age, 1e9 - age))
    (plans / ".DS_Store").touch()
    (plans / "Not a name").mkdir()
    (plans / "dangling").symlink_to(folder.root / "nowhere")
    assert folder.names("plans") == ["older", "old", "new", "dangling"]


def test_a_thing_that_goes_while_names_are_told_is_left_out(folder: Folder) -> None:
    (folder.root / "plans" / "here").mkdir()
    gone = folder.root / "plans" / "gone"
    with patch.object(Path, "iterdir", lambda self: iter([self / "here", gone])):
        assert folder.names("plans") == ["here"]


things = st.dictionaries(st.from_regex(r"[a-z]{1,8}(\.json)?", fullmatch=True), st.binary(max_size=20), min_size=1)


@given(things, st.booleans())
@settings(max_examples=40, deadline=None)
def test_what_was_thrown_away_is_had_again_whole(
    tmp_path_factory: pytest.TempPathFactory, things: dict[str, bytes], elsewhere: bool
) -> None:
    root = tmp_path_factory.mktemp("thrown")
    with Folder.opened(root / "studio") as folder:
        at = root / "styles"
        at.mkdir()
        paths = []
        for name, content in things.items():
            paths.append(at / name)
            if name.endswith(".json"):
                paths[-1].write_bytes(content)
            else:
                (paths[-1] / "within").mkdir(parents=True)
                (paths[-1] / "within" / "file").write_bytes(content)
        before = contents(at)
        with patch("os.rename", side_effect=_another_disk if elsewhere else os.rename):
            trashed = folder.throw_away(*paths)
            assert list(at.iterdir()) == []
            assert contents(trashed) == before
            folder.take_back(trashed, at)
        assert contents(at) == before
        assert not trashed.exists()


def _another_disk(*_: object) -> None:
    raise OSError(errno.EXDEV, os.strerror(errno.EXDEV))


def test_two_things_of_one_name_thrown_away_in_one_instant_do_not_meet(folder: Folder) -> None:
    graves = []
    with patch("time.time_ns", return_value=1):
        for content in ("one", "two"):
            (folder.root / "plans" / "cat").write_text(content)
            graves.append(folder.throw_away(folder.root / "plans" / "cat"))
    assert [(trashed / "cat").read_text() for trashed in graves] == ["one", "two"]


@pytest.mark.parametrize("taken_by", ["a folder", "a link to nowhere"])
def test_nothing_is_taken_back_over_something_else(folder: Folder, taken_by: str) -> None:
    styles = folder.root / "styles"
    styles.mkdir()
    for name in ("cat.json", "cat.safetensors"):
        (styles / name).write_text(name)
    trashed = folder.throw_away(styles / "cat.json", styles / "cat.safetensors")
    if taken_by == "a folder":
        (styles / "cat.safetensors").mkdir()
    else:
        (styles / "cat.safetensors").symlink_to("nowhere")
    with pytest.raises(OutputError, match=r"another one has the name cat\.safetensors by now; put it back"):
        folder.take_back(trashed, styles)
    assert contents(trashed) == {"cat.json": b"cat.json", "cat.safetensors": b"cat.safetensors"}
    assert [path.name for path in styles.iterdir()] == ["cat.safetensors"]


def test_undoing_twice_is_told(folder: Folder) -> None:
    (folder.root / "plans" / "cat").mkdir()
    trashed = folder.throw_away(folder.root / "plans" / "cat")
    folder.take_back(trashed, folder.root / "plans")
    with pytest.raises(InputError, match="it was taken out of the trash already"):
        folder.take_back(trashed, folder.root / "plans")


def test_what_cannot_be_moved_whole_stays_where_it_is(folder: Folder) -> None:
    styles = folder.root / "styles"
    styles.mkdir()
    (styles / "cat.json").write_text("{}")
    with pytest.raises(OutputError, match=r"cannot move cat\.safetensors: No such file or directory; it stays"):
        folder.throw_away(styles / "cat.json", styles / "cat.safetensors")
    assert contents(styles) == {"cat.json": b"{}"}


def test_former_files_are_in_the_trash_and_still_in_their_places(folder: Folder) -> None:
    (folder.root / "tray.json").write_text("{}")
    trashed = folder.keep_former(folder.root / "tray.json", folder.root / "none.json")
    assert contents(trashed) == {"tray.json": b"{}"}
    assert (folder.root / "tray.json").read_text() == "{}"
    assert not folder.keep_former(folder.root / "none.json").exists()


def test_what_cannot_be_copied_into_the_trash_is_told_and_leaves_nothing_there(folder: Folder) -> None:
    (folder.root / "tray.json").write_text("{}")
    with (
        patch("maulstick.studio.state.folder.atomic_write", side_effect=OutputError("the disk is full")),
        pytest.raises(OutputError, match=r"cannot copy tray\.json into the trash: the disk is full"),
    ):
        folder.keep_former(folder.root / "tray.json")
    assert list((folder.root / "trash").iterdir()) == []


def test_what_came_half_before_a_power_cut_is_cleared_away(tmp_path: Path) -> None:
    with Folder.opened(tmp_path) as folder:
        folder.incoming().write_bytes(b"half")
    with Folder.opened(tmp_path):
        assert [path.name for path in tmp_path.iterdir() if "incoming" in path.name] == []


def test_one_studio_at_a_time_works_in_a_folder(tmp_path: Path) -> None:
    with Folder.opened(tmp_path), pytest.raises(InputError, match="another studio works in"), Folder.opened(tmp_path):
        pass
    with Folder.opened(tmp_path):
        pass


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with (
        pytest.raises(OutputError, match=r"cannot work in .*: it is a file, and a folder is needed; name one"),
        Folder.opened(tmp_path / "file"),
    ):
        pass


def test_a_new_folder_is_for_its_owner_alone_and_one_that_was_there_stays_as_it_is(tmp_path: Path) -> None:
    with Folder.opened(tmp_path / "new" / "studio") as folder:
        assert folder.root.stat().st_mode & 0o777 == 0o700
    (tmp_path / "shared").mkdir(mode=0o750)
    with Folder.opened(tmp_path / "shared") as folder:
        assert folder.root.stat().st_mode & 0o777 == 0o750
