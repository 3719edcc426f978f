import errno
import os
import resource
import shutil
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest

from maulstick.cli.plan import run as paint_run
from maulstick.jobs.plan import results
from maulstick.painting.painting_file import read_painting
from maulstick.storage import folders as folder
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Ran, contents, paint, run_command


def last_line(ran: Ran) -> str:
    """What was said last; a note may come before."""
    assert "Traceback" not in ran.stderr
    return ran.stderr.splitlines()[-1].removeprefix("maulstick: ")


def test_a_folder_with_something_in_it_is_kept_unless_told_otherwise(tmp_path: Path) -> None:
    (tmp_path / "letter").write_text("dear")
    (tmp_path / "painting.json").write_text("before")
    ran = paint(tmp_path)
    assert ran.code == 1
    assert ran.mistake == f"the folder {tmp_path} is not empty; choose another --out, or add --overwrite"
    assert contents(tmp_path) == {"letter": b"dear", "painting.json": b"before"}
    assert paint(tmp_path, "--overwrite").code == 0
    assert sorted(os.listdir(tmp_path)) == ["letter", *RESULTS]
    assert (tmp_path / "letter").read_text() == "dear"
    assert read_painting(tmp_path / "painting.json").strokes


def test_all_that_planning_writes_is_known_by_name() -> None:
    assert {*RESULTS, *(f"progress.{kind}" for kind in ("mp4", "gif"))} == set(results.RESULTS)


def test_what_is_planned_from_is_not_written_over(tmp_path: Path) -> None:
    picture, link = tmp_path / "plan" / "preview.png", tmp_path / "link"
    picture.parent.mkdir()
    shutil.copy(PORTRAIT, picture)
    link.symlink_to(picture.parent)
    ran = paint(link, "--overwrite", photo=picture)
    assert ran.mistake == f"{picture} is planned from, and the results in {link} would replace it; name another --out"
    assert contents(picture.parent) == {"preview.png": Path(PORTRAIT).read_bytes()}


def test_a_file_is_no_folder_to_paint_into(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("before")
    for words in ((), ("--overwrite",)):
        ran = paint(file, *words)
        assert ran.code == 1
        assert ran.mistake == f"{file} is a file, not a folder; choose another --out"
    below = paint(file / "below")
    assert below.code == 1
    assert last_line(below) == f"cannot write into the folder {file}/below: Not a directory; choose another --out"
    assert file.read_text() == "before"


@pytest.mark.parametrize("encoding", ["utf-8:strict", "ascii:strict"])
def test_a_folder_may_have_any_name_and_a_terminal_any_alphabet(tmp_path: Path, encoding: str) -> None:
    out = tmp_path / "[/bold]\udcff"
    ran = run_command("plan", PORTRAIT, *QUICK, "--out", out, PYTHONIOENCODING=encoding)
    assert ran.code == 0
    assert "[/bold]\\udcff" in "".join(ran.stdout.split())
    assert sorted(os.listdir(out)) == RESULTS


@pytest.fixture
def small_disk() -> Iterator[None]:
    """No file may grow beyond 100 kB."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.usefixtures("small_disk")
def test_a_disk_without_room_is_found_before_planning_and_no_folder_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paint_run, "plan_with", None)  # to call it would be a traceback
    out = tmp_path / "new" / "folder"
    ran = paint(out)
    assert ran.code == 1
    assert last_line(ran) == f"cannot write into the folder {out}: File too large; choose another --out"
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("failing", [1, 3])
def test_a_disk_that_fills_up_leaves_the_painting_that_was_there(
    painted: tuple[Path, Ran], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int
) -> None:
    for name, content in contents(painted[0]).items():
        (tmp_path / name).write_bytes(content)
    calls: list[None] = []

    def fill(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            return
        calls.append(None)
        if len(calls) == failing:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", fill)
    ran = paint(tmp_path, "--seed", "1", "--overwrite")
    file = tmp_path / ("painting.json" if failing == 1 else "preview.png")
    assert ran.code == 1
    assert last_line(ran) == f"cannot write {file}: the disk is full; free some space and run again"
    assert contents(tmp_path) == contents(painted[0])


def test_a_folder_in_the_place_of_a_file_is_kept_and_nothing_is_written(tmp_path: Path) -> None:
    (tmp_path / "preview.png").mkdir()
    ran = paint(tmp_path, "--overwrite")
    assert ran.code == 1
    assert last_line(ran) == f"cannot write {tmp_path}/preview.png: it is a folder; choose another --out"
    assert os.listdir(tmp_path) == ["preview.png"]


def test_a_folder_that_can_only_be_read_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(folder, "TemporaryFile", refuse)  # root may write anywhere
    ran = paint(tmp_path)
    assert ran.code == 1
    assert last_line(ran) == f"cannot write into the folder {tmp_path}: Read-only file system; choose another --out"
    assert tmp_path.is_dir()


@pytest.mark.parametrize("there", [True, False])
def test_a_plan_that_fails_takes_its_empty_folder_along_unless_it_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, there: bool
) -> None:
    def fail(*_: object) -> None:
        raise KeyboardInterrupt

    if there:
        (tmp_path / "out").mkdir()
    monkeypatch.setattr(paint_run, "plan_with", fail)
    assert paint(tmp_path / "out").code == 130
    assert os.listdir(tmp_path) == (["out"] if there else [])
