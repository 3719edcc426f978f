from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError, OutputError
from maulstick.painting.painting_file import write_painting
from maulstick.robot.execute import PaintProgress, execute
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.logbook import LoggedRun, PenUse, Tally, logbook_path, read_logbook, totals
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import routine
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import SIX

RED, BLUE = (f"marker {paint.hex}" for paint in SIX.paints)
uses = st.builds(
    PenUse,
    pen=st.sampled_from(["a", "b", "c"]),
    metres=st.floats(0, 1e3),
    seconds=st.floats(0, 1e4),
    strokes=st.integers(0, 999),
)


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the user's data, and a painting."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    write_painting(SIX, tmp_path / "painting.json")
    return tmp_path


def tallied(folder: Path, robot: Recorder) -> Tally:
    tally = Tally(SIX)
    with Journal.open(journal_of(folder / "painting.json")) as journal:
        try:
            with robot:
                execute(routine(SIX, EASEL, LIMITS), robot, journal, lambda ask: None, tally.note)
        except StoppedError:
            pass
    return tally


def test_a_run_is_one_line_with_what_each_pen_drew(data: Path) -> None:
    assert read_logbook() == []
    tallied(data, Recorder()).write("grbl:/dev/ttyUSB0", data / "painting.json")
    (run,) = read_logbook()
    assert (run.machine, run.painting) == ("grbl:/dev/ttyUSB0", str(data / "painting.json"))
    assert [(use.pen, use.strokes) for use in run.pens] == [(RED, 3), (BLUE, 3)]
    assert [use.metres for use in run.pens] == pytest.approx([0.03, 0.075])
    assert all(use.seconds > 0 for use in run.pens)


def test_a_run_that_is_stopped_counts_the_strokes_that_it_finished(data: Path) -> None:
    def stop(what: str) -> None:
        if what == "stroke" and robot.said.count("stroke") == 4:
            robot.stop()
            raise StoppedError

    robot = Recorder(before=stop)
    tallied(data, robot).write("grbl:/dev/ttyUSB0", data / "painting.json")
    (run,) = read_logbook()
    assert [(use.pen, use.strokes) for use in run.pens] == [(RED, 3), (BLUE, 1)]


def test_a_run_without_a_stroke_is_no_line(data: Path) -> None:
    Tally(SIX).write("grbl:/dev/ttyUSB0", data / "painting.json")
    assert not logbook_path().exists()


def test_several_looks_at_the_sheet_are_one_run(data: Path) -> None:
    tally, first = Tally(SIX), routine(SIX, EASEL, LIMITS)[1]
    for _ in range(2):
        tally.note(PaintProgress(first, 0.0, 1.0, 9.0, None, 0.0))
        tally.note(PaintProgress(None, 0.25, 1.0, 8.0, None, 2.0))
    tally.write("axidraw", data / "painting.json")
    assert read_logbook()[0].pens == (PenUse(pen=RED, metres=0.5, seconds=4, strokes=2),)


@given(st.lists(st.lists(uses, max_size=3), min_size=1, max_size=5))
def test_totals_add_up(runs: list[list[PenUse]]) -> None:
    lines = [
        LoggedRun(at=datetime(2026, 1, i + 1, tzinfo=UTC), machine="m", painting="p", pens=tuple(pens))
        for i, pens in enumerate(runs)
    ]
    found = totals(lines)
    assert set(found) == {use.pen for pens in runs for use in pens}
    every = [use for pens in runs for use in pens]
    assert sum(total.use.strokes for total in found.values()) == sum(use.strokes for use in every)
    assert sum(total.use.metres for total in found.values()) == pytest.approx(sum(use.metres for use in every))
    assert [total.use.metres for total in found.values()] == sorted(
        (t.use.metres for t in found.values()), reverse=True
    )


def test_an_incomplete_last_line_is_left_out_and_a_damaged_one_is_named(data: Path) -> None:
    tally = tallied(data, Recorder())
    tally.write("axidraw", data / "painting.json")
    whole = logbook_path().read_text()
    logbook_path().write_text(whole + whole[:30])
    assert len(read_logbook()) == 1
    logbook_path().write_text(f"{whole}{{}}\n")
    with pytest.raises(InputError, match=r"line 2 of .*logbook.jsonl is not one of a logbook: at: Field required"):
        read_logbook()
    logbook_path().write_bytes(b"\xff\n")
    with pytest.raises(InputError, match=r"line 1 of .* is not one of a logbook; remove it"):
        read_logbook()


@pytest.mark.parametrize("left", [1, 30])
def test_a_run_after_a_power_cut_is_a_line_of_its_own(data: Path, left: int) -> None:
    tally = tallied(data, Recorder())
    tally.write("axidraw", data / "painting.json")
    whole = logbook_path().read_text()
    logbook_path().write_text(whole + whole[:left])
    tally.write("grbl:/dev/ttyUSB0", data / "painting.json")
    assert [run.machine for run in read_logbook()] == ["axidraw", "grbl:/dev/ttyUSB0"]


def test_a_logbook_that_cannot_be_written_is_one_sentence(data: Path) -> None:
    (data / "data").write_text("a file")
    with pytest.raises(OutputError, match="cannot write the logbook"):
        tallied(data, Recorder()).write("axidraw", data / "painting.json")
