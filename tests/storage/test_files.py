import errno
import os
import resource
import stat
from pathlib import Path

import pytest

from maulstick.errors import InputError, OutputError
from maulstick.storage.files import atomic_write, file_to_read, read_whole


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """A file that must survive."""
    path = tmp_path / "kept.json"
    path.write_bytes(b"before")
    return path


def survives_alone(path: Path) -> bool:
    return path.read_bytes() == b"before" and os.listdir(path.parent) == [path.name]


def test_what_is_written_takes_the_place_of_what_was_there(kept: Path) -> None:
    atomic_write(kept, b"after")
    assert kept.read_bytes() == b"after"
    assert os.listdir(kept.parent) == ["kept.json"]


def test_a_new_file_has_the_permissions_that_the_user_gives_files(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        atomic_write(tmp_path / "new", b"")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


def test_writing_through_a_link_keeps_the_link(kept: Path) -> None:
    link = kept.with_name("link")
    link.symlink_to(kept.name)
    atomic_write(link, b"after")
    assert link.is_symlink()
    assert kept.read_bytes() == b"after"


def test_a_file_that_grows_too_large_for_its_disk_loses_nothing(kept: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    try:
        with pytest.raises(OutputError, match=r"cannot write .*kept\.json: the file would be larger than is allowed"):
            atomic_write(kept, bytes(20_000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert survives_alone(kept)


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (errno.ENOSPC, "the disk is full; free some space and run again"),
        (errno.EDQUOT, "your disk quota is used up; free some space and run again"),
        (errno.EACCES, "there is no permission to write there; choose another folder"),
        (errno.EROFS, "that disk can only be read; choose another folder"),
        (errno.EIO, os.strerror(errno.EIO)),
    ],
)
def test_a_disk_that_fails_is_one_line_and_loses_nothing(
    kept: Path, monkeypatch: pytest.MonkeyPatch, number: int, text: str
) -> None:
    def fails(_: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "fsync", fails)
    with pytest.raises(OutputError) as caught:
        atomic_write(kept, b"after")
    assert str(caught.value) == f"cannot write {kept}: {text}"
    assert survives_alone(kept)


def test_an_interrupted_write_loses_nothing(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupts(_: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupts)
    with pytest.raises(KeyboardInterrupt):
        atomic_write(kept, b"after")
    assert survives_alone(kept)


def test_a_folder_a_device_and_a_missing_folder_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="it is a folder; name a file"):
        atomic_write(tmp_path, b"")
    with pytest.raises(OutputError, match="it is a device or a pipe; name a file"):
        atomic_write("/dev/null", b"")
    with pytest.raises(OutputError, match="its folder does not exist; make the folder first"):
        atomic_write(tmp_path / "none" / "file", b"")
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="its folder is a file; choose another folder"):
        atomic_write(tmp_path / "file" / "file", b"")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a\0.json", "cannot write a?.json: embedded null byte; choose another name"),
        ("a\ud800.json", "cannot write a?.json: 'utf-8' codec can't encode .*; choose another name"),
        ("a" * 300, "cannot write a+: its name is too long; choose a shorter one"),
    ],
)
def test_a_name_that_no_file_can_have_is_one_line(name: str, text: str) -> None:
    with pytest.raises(OutputError, match=f"^{text.replace('?', '[?]')}$"):
        atomic_write(name, b"")


def test_behind_links_in_a_circle_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(OutputError, match=r"^cannot write .*/loop/letter: its links lead in a circle; choose another"):
        atomic_write(tmp_path / "loop" / "letter", b"")


def test_a_file_to_read_is_there_and_has_something_in_it(kept: Path) -> None:
    assert file_to_read(str(kept), "letter") == kept


def test_a_file_that_cannot_be_read_is_called_by_its_name_and_kind(tmp_path: Path) -> None:
    (tmp_path / "empty").touch()
    os.mkfifo(tmp_path / "pipe")
    for name, text in {
        "none": "there is no letter {path}; check its name and folder",
        "empty/none": "there is no letter {path}; check its name and folder",
        "empty": "the letter {path} is empty; make or copy it again",
        "": "{path} is a folder; name the letter itself",
        "pipe": "{path} is a device or a pipe; a letter must be a file",
        "x" * 300: "cannot read the letter {path}: File name too long",
    }.items():
        with pytest.raises(InputError) as caught:
            file_to_read(tmp_path / name, "letter")
        assert str(caught.value) == text.format(path=tmp_path / name)


def test_a_file_is_read_whole_unless_it_is_too_large(kept: Path, tmp_path: Path) -> None:
    assert read_whole(str(kept), "letter", 2**20) == kept.read_bytes()
    large = tmp_path / "large"
    large.write_bytes(bytes(2**20))
    assert len(read_whole(large, "letter", 2**20)) == 2**20
    large.write_bytes(bytes(2**20 + 1))
    with pytest.raises(InputError) as caught:
        read_whole(large, "letter", 2**20)
    assert str(caught.value) == f"{large} is larger than 1 MiB, too large for a letter; name another"
    with pytest.raises(InputError, match="there is no letter"):
        read_whole(tmp_path / "none", "letter", 2**20)


def test_a_file_that_fails_while_it_is_read_is_told_in_one_line(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(_: Path) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(Path, "read_bytes", fails)
    with pytest.raises(InputError) as caught:
        read_whole(kept, "letter", 2**20)
    assert str(caught.value) == f"cannot read the letter {kept}: Input/output error"


def test_a_file_without_permission_is_refused(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: not (path == kept and mode == os.R_OK))  # root may read all
    with pytest.raises(InputError, match="there is no permission to read the letter"):
        file_to_read(kept, "letter")
