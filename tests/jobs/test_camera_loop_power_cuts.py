"""Power cuts while painting by eye: whatever the moment, every stroke is on the sheet once in the end."""

from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from maulstick.jobs.paint.camera_loop import paint_by_eye
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.workplace import Workplace
from tests.support.robot.mortal_painter import Cut, Painter, PowerCutError, World, power_cuts, put_painting
from tests.support.robot.recorder import EASEL

ALL = list(range(10, 16))


def look() -> tuple[Any, Easel]:
    return np.ones((4, 6, 3), dtype=np.float32), EASEL


def paint(folder: Path, cut: Cut) -> list[int]:
    """Begin, or go on, painting by eye, with a look after every two strokes; return the unfinished strokes.

    What is left is planned again at each look: the same strokes, each with a new name.
    """
    world, file, unfinished = World(folder), folder / "painting.json", []
    with power_cuts(cut), Journal.open(journal_of(file)) as journal:

        def again(painting: Painting, _: Any) -> Painting:
            strokes = [
                stroke if stroke.id in journal.painted else stroke.model_copy(update={"id": stroke.id + 100})
                for stroke in painting.strokes
            ]
            return painting.model_copy(update={"strokes": tuple(strokes)})

        if journal.revision is None:
            journal.revise(file)
        plan = read_painting(journal.painting())
        if (stroke := journal.unfinished) is not None:
            unfinished.append(stroke)
            (journal.end if stroke % 100 in world.painted() else journal.again)(stroke)
        with Painter(world, cut) as robot:
            place = Workplace(robot, EASEL, journal, ask=lambda ask: None)
            paint_by_eye(plan, place, look, again, lambda painted: painted == 2)
    return unfinished


def cut_off() -> NoReturn:
    raise PowerCutError


@pytest.fixture(scope="module")
def moments(tmp_path_factory: pytest.TempPathFactory) -> int:
    """Number of moments for a power cut: those of the journal and the strokes, and two per new file of the painting."""
    folder = tmp_path_factory.mktemp("whole")
    put_painting(folder)
    cut = Cut(0, cut_off)
    paint(folder, cut)
    return cut.moments


def test_after_a_power_cut_at_any_moment_every_stroke_is_painted_once(
    tmp_path_factory: pytest.TempPathFactory, moments: int
) -> None:
    assert moments == 1 + 15 * 4 + 6 * 2 + 2 * 2
    for at in range(1, moments + 1):
        folder = tmp_path_factory.mktemp("cut")
        put_painting(folder)
        with pytest.raises(PowerCutError):
            paint(folder, Cut(at, cut_off))
        unfinished = paint(folder, Cut(0, cut_off))
        assert len(unfinished) <= 1
        assert sorted(World(folder).painted()) == ALL


def test_a_new_plan_of_which_the_journal_does_not_know_is_written_over(tmp_path: Path) -> None:
    """Power cuts between a revision's file and its line in the journal: the old plan holds, and is replanned again."""
    put_painting(tmp_path)
    later = tmp_path / "painting.r1.json"
    plan = read_painting(tmp_path / "painting.json")
    write_painting(plan.model_copy(update={"strokes": plan.strokes[:1]}), later)
    paint(tmp_path, Cut(0, cut_off))
    assert sorted(World(tmp_path).painted()) == ALL
    assert len(read_painting(later).strokes) == 6


def test_painted_strokes_are_frozen_and_the_latest_plan_is_the_one_that_goes_on(tmp_path: Path) -> None:
    put_painting(tmp_path)
    paint(tmp_path, Cut(0, cut_off))
    first, second = (read_painting(tmp_path / f"painting.r{number}.json").strokes for number in (1, 2))
    assert [stroke.id // 100 for stroke in first] == [0] * 2 + [1] * 4
    assert [stroke.id // 100 for stroke in second] == [0] * 2 + [1] * 2 + [2] * 2
    assert second[:2] == first[:2]
    with Journal.open(journal_of(tmp_path / "painting.json")) as journal:
        assert journal.painting() == tmp_path / "painting.r2.json"
        assert journal.painted == {stroke.id for stroke in second}
