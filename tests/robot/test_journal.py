import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError, OutputError
from maulstick.painting.painting_file import write_painting
from maulstick.robot.journal import Journal, journal_of
from tests.support.robot.small_paintings import SIX

HOLD = """
import sys
from pathlib import Path
from maulstick.robot.journal import Journal
with Journal.open(Path(sys.argv[1])):
    print("open", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    write_painting(SIX, tmp_path / "painting.json")
    return tmp_path / "painting.json"


@pytest.fixture
def path(painting: Path) -> Path:
    """Path of a journal in which stroke 10 is painted and 11 was begun."""
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
        journal.begin(10)
        journal.end(10)
        journal.begin(11)
    return journal_of(painting)


def state(path: Path) -> tuple[set[int], int | None, int]:
    with Journal.open(path) as journal:
        return journal.painted, journal.unfinished, journal.revisions


def fault(path: Path) -> str:
    before = path.read_bytes()
    with pytest.raises(InputError) as caught, Journal.open(path):
        pass
    assert "\n" not in str(caught.value)
    assert path.read_bytes() == before
    return str(caught.value)


def test_a_journal_lies_beside_its_painting() -> None:
    assert journal_of(Path("out/painting.json")) == Path("out/painting.log.jsonl")


def test_a_journal_says_what_was_written_into_it(path: Path) -> None:
    assert state(path) == ({10}, 11, 1)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [line["event"] for line in lines] == ["revision", "begin", "end", "begin"]
    assert (lines[0]["schema_version"], lines[0]["file"]) == (1, "painting.json")


@pytest.mark.parametrize(("answer", "painted"), [(Journal.end, {10, 11}), (Journal.again, {10})])
def test_a_person_says_what_became_of_the_unfinished_stroke(
    path: Path, answer: Callable[[Journal, int], None], painted: set[int]
) -> None:
    with Journal.open(path) as journal:
        answer(journal, 11)
    assert state(path) == (painted, None, 1)


def test_strokes_may_count_as_painted_from_the_start(painting: Path) -> None:
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting, painted=[10, 12])
    assert state(journal_of(painting)) == ({10, 12}, None, 1)


def test_a_journal_knows_its_painting(path: Path, painting: Path) -> None:
    with Journal.open(path) as journal:
        assert journal.painting() == painting


def test_the_latest_revision_is_the_painting(path: Path, painting: Path) -> None:
    later = painting.with_name("painting.r1.json")
    write_painting(SIX.model_copy(update={"strokes": SIX.strokes[:2]}), later)
    with Journal.open(path) as journal:
        journal.revise(later)
    with Journal.open(path) as journal:
        assert (journal.painting(), journal.revisions, journal.painted) == (later, 2, {10})


def test_a_painting_that_was_changed_since_is_refused(path: Path, painting: Path) -> None:
    write_painting(SIX.model_copy(update={"strokes": SIX.strokes[:2]}), painting)
    with Journal.open(path) as journal, pytest.raises(InputError) as caught:
        journal.painting()
    assert str(caught.value) == (
        f"{painting} is not the file that {path} was begun with; put that one back, or start again with restart=True"
    )


def test_a_painting_that_is_gone_is_refused(path: Path, painting: Path) -> None:
    painting.unlink()
    with Journal.open(path) as journal, pytest.raises(InputError, match=r"^there is no painting "):
        journal.painting()


@pytest.mark.parametrize("cut", range(1, 30))
def test_a_line_that_a_power_cut_tore_is_dropped(path: Path, cut: int) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    assert state(path) == ({10}, None, 1)
    assert path.read_bytes() == whole[: whole[:-cut].rfind(b"\n") + 1]
    with Journal.open(path) as journal:
        journal.begin(12)
    assert state(path) == ({10}, 12, 1)


def test_zeros_at_the_end_are_torn_too(path: Path) -> None:
    path.write_bytes(path.read_bytes() + bytes(4096))
    assert state(path) == ({10}, 11, 1)


@pytest.mark.parametrize(
    "garbage",
    [
        b"",
        b"garbage",
        b"\x00\xff",
        b"[]",
        b"[" * 9999,
        b'{"event": "begun", "stroke": 1}',
        b'{"event": "begin", "stroke": -1}',
        b'{"event": "begin", "stroke": 1, "by": "me"}',
        b'{"event": "revision", "schema_version": 2, "file": "painting.json", "sha256": "%s"}' % (b"0" * 64),
        b'{"event": "revision", "schema_version": 1, "file": "../painting.json", "sha256": "%s"}' % (b"0" * 64),
    ],
)
def test_garbage_in_the_middle_is_refused_with_its_line(path: Path, garbage: bytes) -> None:
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([*lines[:2], garbage + b"\n", *lines[2:]]))
    said = fault(path)
    assert said == f"line 3 of {path} is not one of a journal; mend it, or start again with restart=True"


def test_a_journal_without_a_painting_is_refused(path: Path) -> None:
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[1:]))
    assert fault(path).startswith(f"line 1 of {path} is not one of a journal")


@settings(max_examples=30, deadline=None)
@given(st.binary(max_size=60))
def test_whatever_is_in_the_file_it_is_read_or_refused_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.log.jsonl"
    path.write_bytes(content)
    try:
        with Journal.open(path) as journal:
            assert journal.painted == set()
            assert journal.revision is None
    except InputError:
        assert path.read_bytes() == content


def test_a_journal_into_which_nothing_was_written_leaves_nothing(tmp_path: Path) -> None:
    with Journal.open(tmp_path / "a.log.jsonl"):
        pass
    assert not (tmp_path / "a.log.jsonl").exists()


def test_another_process_is_refused_until_the_first_has_finished(path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdin is not None
        assert other.stdout is not None
        assert other.stdout.readline() == b"open\n"
        assert fault(path) == f"another maulstick paints by {path}; wait until it has finished, or stop it"
        other.stdin.close()
        other.wait(30)
    assert state(path) == ({10}, 11, 1)


def test_a_process_that_was_killed_holds_nothing(path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == b"open\n"
        other.kill()
    assert state(path) == ({10}, 11, 1)


def test_a_stroke_that_is_written_down_is_on_the_disk(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Journal.open(path) as journal:
        sizes: list[int] = []
        monkeypatch.setattr("os.fsync", lambda file: sizes.append(os.fstat(file).st_size))
        journal.end(11)
        assert sizes == [path.stat().st_size]


def test_the_name_of_a_new_journal_is_on_the_disk(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    monkeypatch.setattr("os.fsync", lambda file: synced.append(os.fstat(file).st_ino))
    with Journal.open(path.with_name("new.log.jsonl")):
        assert path.parent.stat().st_ino in synced


def refuse_to_write(_: int, __: bytes) -> int:
    raise OSError(errno.EDQUOT, "Disk quota exceeded")


def write_half(file: int, content: bytes, write: Callable[[int, bytes], int] = os.write) -> int:
    return write(file, content[: len(content) // 2])


def fail_to_flush(_: int) -> None:
    raise OSError(errno.EIO, "Input/output error")


@pytest.mark.parametrize(
    ("call", "failing", "said"),
    [
        ("os.write", refuse_to_write, "Disk quota exceeded"),
        ("os.write", write_half, "No space left on device"),
        ("os.fsync", fail_to_flush, "Input/output error"),
    ],
)
def test_a_full_disk_leaves_the_journal_as_it_was(
    path: Path, monkeypatch: pytest.MonkeyPatch, call: str, failing: Callable[..., object], said: str
) -> None:
    before = path.read_bytes()
    with Journal.open(path) as journal:
        with monkeypatch.context() as patch:
            patch.setattr(call, failing)
            with pytest.raises(OutputError) as caught:
                journal.end(11)
        assert str(caught.value) == f"cannot write {path}: {said}; mend that; then go on with paint(..., resume=True)"
        assert path.read_bytes() == before
        assert (journal.painted, journal.unfinished) == ({10}, 11)
        journal.end(11)
    assert state(path) == ({10, 11}, None, 1)


def test_a_journal_that_is_a_folder_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "a.log.jsonl").mkdir()
    with pytest.raises(OutputError, match="mend that before painting"), Journal.open(tmp_path / "a.log.jsonl"):
        pass


def test_any_name_of_a_painting_is_kept(tmp_path: Path) -> None:
    painting = tmp_path / os.fsdecode("straße\\ \xff.json".encode("latin-1"))
    write_painting(SIX, painting)
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
    with Journal.open(journal_of(painting)) as journal:
        assert journal.painting() == painting
