import math
from pathlib import Path
from weakref import ref

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from maulstick.brush_fit.fit import fit_brush
from maulstick.calibration.collect import Photographs, collect, spread_apart, trials_of
from maulstick.calibration.eye import Eye
from maulstick.errors import InputError, MachineError, OutputError
from maulstick.jobs.practice import practice, room_around
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Sheet
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import Canvas
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import Draw, routine
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.robot.simulated.easel import SimulatedEasel
from maulstick.robot.simulated.sheets import ModelSheet
from maulstick.robot.workplace import Workplace
from maulstick.storage.arrays import Floats
from maulstick.style import load_style
from tests.support.nominal import nominal
from tests.support.robot.mortal_painter import row_of
from tests.support.robot.recorder import EASEL, LIMITS, Recorder
from tests.support.robot.small_paintings import HEIGHT, SIX, WIDTH
from tests.support.tolerances import EXECUTED_PATH, FOUND_OFFSET, FOUND_WIDTH, PHOTOGRAPH, ROUND_TRIP

Image = NDArray[np.float32]

PER_METRE = 2000.0
PIXELS = round(HEIGHT * PER_METRE), round(WIDTH * PER_METRE)
paths = st.integers(1, 12).flatmap(
    lambda count: st.lists(st.floats(-0.05, 0.05), min_size=10 * count, max_size=10 * count).map(
        lambda numbers: np.insert(np.reshape(numbers, (count, 5, 2)), 2, 0.5, axis=2)
    )
)


# Strokes apart.


@given(paths, st.floats(0.05, 0.5), st.floats(0.05, 0.5), st.floats(0, 0.01))
def test_strokes_are_kept_apart_and_on_the_sheet(strokes: Floats, width: float, height: float, room: float) -> None:
    before = strokes.copy()
    try:
        placed = spread_apart(strokes, (width, height), room)
    except InputError:
        assume(False)
    assert np.array_equal(strokes, before)
    low, high = placed[..., :2].min(axis=1) - room, placed[..., :2].max(axis=1) + room
    assert (low > -ROUND_TRIP).all()
    assert (high < np.array([width, height]) + ROUND_TRIP).all()
    beside = (low[:, None] > high[None] - ROUND_TRIP).any(axis=2)
    assert (beside | beside.T | np.eye(len(placed), dtype=bool)).all()
    steps, were = (np.diff(each[..., :2], axis=1) for each in (placed, strokes))
    sizes = np.linalg.norm(steps) / max(np.linalg.norm(were), 1e-300)
    assert steps == pytest.approx(sizes * were, abs=ROUND_TRIP), "all are made smaller alike"
    assert np.array_equal(placed[..., 2], strokes[..., 2])


def squares(count: int, side: float) -> Floats:
    return np.tile([[0.0, 0.0, 0.5], [side, side, 0.5]], (count, 1, 1))


def test_strokes_that_fit_keep_their_size_and_others_shrink_by_no_more_than_four_times() -> None:
    assert np.ptp(spread_apart(squares(4, 0.04), (0.1, 0.1), 0.005), axis=1)[:, 0] == pytest.approx([0.04] * 4)
    assert np.ptp(spread_apart(squares(4, 0.16), (0.1, 0.1), 0.005), axis=1).max() == pytest.approx(0.04)
    with pytest.raises(InputError) as caught:
        spread_apart(squares(5, 0.16), (0.1, 0.1), 0.005)
    assert str(caught.value) == (
        "4 of 5 strokes fit on a sheet of 100 x 100 mm with 10 mm between them; draw fewer, or take a larger sheet"
    )


@pytest.mark.parametrize("sheet", [(0.03, 0.2), (0.2, 0.03)])
def test_where_not_even_one_fits_it_says_so(sheet: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="0 of 3 strokes fit on a sheet of"):
        spread_apart(squares(3, 0.2), sheet, 0.0)


# Drawing and photographs, by a machine that writes down what it is told.


class Session:
    """Six strokes, a machine and a camera that shows how many strokes there are; it ends after `left` moments."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.path = folder, folder / "practice.json"
        self.machine = Recorder()
        self.before: list[int] = []  # what was drawn by machines before it
        self.left = math.inf  # moments
        write_painting(SIX, self.path)

    @property
    def drawn(self) -> list[int]:
        return self.before + [row_of(path) for what, path in self.machine.commands if what == "stroke"]

    def moment(self, what: str = "") -> None:
        self.left -= 1
        if self.left == 0:
            raise MachineError("the cable is out")

    def look(self) -> Image:
        self.moment()
        image = np.full((*PIXELS, 3), len(self.drawn) / 10, dtype=np.float32)
        self.moment()
        return image

    def collect(self, each: bool) -> Photographs:
        self.before, self.machine = self.drawn, Recorder(before=self.moment)
        with Journal.open(journal_of(self.path)) as journal, self.machine:
            if journal.revision is None:
                journal.revise(self.path)
            if (stroke := journal.unfinished) is not None:
                (journal.end if stroke in self.drawn else journal.again)(stroke)
            place = Workplace(self.machine, EASEL, journal, lambda ask: None)
            return collect(SIX, place, self.look, self.folder, each=each)


@pytest.mark.parametrize(("each", "numbers"), [(False, [0, 6]), (True, [0, 1, 2, 3, 4, 5, 6])])
def test_there_is_a_photograph_before_and_after_all_or_each(tmp_path: Path, each: bool, numbers: list[int]) -> None:
    session = Session(tmp_path)
    taken = session.collect(each)
    assert sorted(taken) == numbers
    assert sorted(session.drawn) == list(range(10, 16))
    assert sorted(path.name for path in tmp_path.glob("*.png")) == [f"sheet-{number:04}.png" for number in numbers]
    for number, image in taken.items():
        assert read_picture(tmp_path / f"sheet-{number:04}.png") == pytest.approx(image, abs=PHOTOGRAPH)


def test_photographs_wait_on_the_disk_so_that_a_thousand_fit_into_memory(tmp_path: Path) -> None:
    session = Session(tmp_path)
    taken: list[ref[Image]] = []
    look = session.look

    def counted() -> Image:
        image = look()
        taken.append(ref(image))
        return image

    session.look = counted  # type: ignore[method-assign]
    photographs = session.collect(True)
    assert [image() for image in taken] == [None] * 7
    read = [ref(photographs[number]) for number in photographs]
    assert [image() is None for image in read] == [True] * 5 + [False] * 2
    assert 7 not in photographs
    with pytest.raises(KeyError):
        photographs[7]


def test_a_photograph_is_taken_with_the_tip_aside(tmp_path: Path) -> None:
    session = Session(tmp_path)
    places: list[Floats] = []
    write_painting(SIX, session.path)
    with Journal.open(journal_of(session.path)) as journal, Recorder() as robot:
        journal.revise(session.path)
        home = robot.place

        def look() -> Image:
            places.append(robot.place)
            return np.ones((*PIXELS, 3), dtype=np.float32)

        collect(SIX, Workplace(robot, EASEL, journal, lambda ask: None), look, tmp_path, each=True)
    assert places == [pytest.approx(home)] * 7


@pytest.mark.parametrize("each", [False, True])
def test_cut_off_at_any_moment_it_goes_on_and_draws_no_stroke_twice(tmp_path: Path, each: bool) -> None:
    moments = 0
    while True:
        moments += 1
        folder = tmp_path / str(moments)
        folder.mkdir()
        session = Session(folder)
        session.left = moments
        try:
            session.collect(each)
            break
        except MachineError:
            taken = session.collect(each)
        assert sorted(session.drawn) == list(range(10, 16))
        assert sorted(taken) == (list(range(7)) if each else [0, 6])
        assert all(image.mean() == pytest.approx(number / 10, abs=PHOTOGRAPH) for number, image in taken.items())
    assert moments > 20


def test_other_files_in_the_folder_are_no_photographs(tmp_path: Path) -> None:
    (tmp_path / "sheet-of-mine.png").write_bytes(b"")
    assert sorted(Session(tmp_path).collect(False)) == [0, 6]


# Trials.


def numbered(*numbers: int) -> dict[int, Image]:
    return {number: np.full((*PIXELS, 3), number / 10, dtype=np.float32) for number in numbers}


@pytest.mark.parametrize(
    ("numbers", "befores"), [((0, 6), [0] * 6), (range(7), range(6)), ((0, 2, 6), [0, 0, 2, 2, 2, 2])]
)
def test_each_trial_has_the_photographs_next_to_its_stroke(
    tmp_path: Path, numbers: list[int], befores: list[int]
) -> None:
    trials = trials_of(
        SIX, numbered(*numbers), tmp_path / "trials", pixels_per_metre=PER_METRE, medium="x", depth=(0, 1e-3), room=2e-3
    )
    assert (len(trials), trials.depth, trials.pixels_per_metre) == (6, (0, 1e-3), pytest.approx(PER_METRE))
    for stroke, (trial, before) in enumerate(zip(trials, befores, strict=True)):
        after = next(number for number in numbers if number > stroke)
        assert trial.before is not None
        assert trial.before.mean() == pytest.approx(before / 10, abs=PHOTOGRAPH)
        assert trial.after.mean() == pytest.approx(after / 10, abs=PHOTOGRAPH)


def test_a_trial_is_cut_out_around_its_stroke_and_its_path_goes_with_it(tmp_path: Path) -> None:
    down, across = np.mgrid[: PIXELS[0], : PIXELS[1]]
    places = np.stack([across / PIXELS[1], down / PIXELS[0], 0 * down], axis=2).astype(np.float32)
    photographs = {0: np.ones_like(places), 6: places}
    trials = trials_of(
        SIX, photographs, tmp_path / "trials", pixels_per_metre=PER_METRE, medium="x", depth=(0, 0), room=2e-3
    )
    for trial, stroke in zip(trials, SIX.strokes, strict=True):
        path = np.array(stroke.trajectory)
        x, y = trial.after[0, 0, :2] * (PIXELS[1], PIXELS[0])
        corner = np.round([x, y]) / PER_METRE
        assert np.add(trial.path, [*corner, 0]) == pytest.approx(path, abs=EXECUTED_PATH)
        size = np.array(trial.after.shape[1::-1]) / PER_METRE
        room = np.ptp(path[:, :2], axis=0) + 4e-3
        assert (size >= room - 1e-9).all()
        assert (size <= room + 2 / PER_METRE).all()


def test_a_stroke_far_from_the_corner_keeps_its_place_where_the_sheet_ends_within_a_pixel(tmp_path: Path) -> None:
    width, height, scale = 0.4, 0.0109, 1000.0  # 10.9 pixels high, and so 11
    stroke = SIX.strokes[0].model_copy(update={"trajectory": ((0.38, 0.005, 0.5), (0.39, 0.005, 0.5))})
    size = {"sheet": Sheet(width=width, height=height), "strokes": (stroke,)}
    wide = np.zeros((11, 400, 3), dtype=np.float32)
    wide[:, 375] = 1.0  # 375 to 376 mm from the left
    photographs = {0: np.zeros_like(wide), 1: wide}
    trials = trials_of(
        SIX.model_copy(update=size),
        photographs,
        tmp_path / "trials",
        pixels_per_metre=scale,
        medium="x",
        depth=(0, 0),
        room=8e-3,
    )
    (trial,) = trials
    (column,) = np.flatnonzero(trial.after[0, :, 0])
    assert trial.path[0, 0] - column / trials.pixels_per_metre == pytest.approx(0.38 - 0.375, abs=EXECUTED_PATH)


def test_a_trial_s_path_is_refined_as_the_machine_drew_it(tmp_path: Path) -> None:
    bow = SIX.strokes[0].model_copy(update={"trajectory": ((0.01, 0.01, 0.2), (0.03, 0.02, 0.2), (0.05, 0.01, 0.2))})
    painting = SIX.model_copy(update={"strokes": (bow,)})
    (drawn,) = (action.motion.path for action in routine(painting, EASEL, LIMITS) if isinstance(action, Draw))
    trials = trials_of(
        painting, numbered(0, 1), tmp_path / "trials", pixels_per_metre=PER_METRE, medium="x", depth=(0, 0), room=2e-3
    )
    (path,) = (trial.path for trial in trials)
    assert len(path) == len(drawn) > 3
    shift = path[0, :2] - drawn[0, :2] * (1, -1)
    assert path[:, :2] - shift == pytest.approx(drawn[:, :2] * (1, -1), abs=2 * EXECUTED_PATH)


def test_trials_without_a_photograph_of_the_end_are_refused(tmp_path: Path) -> None:
    for there, missing in ((0, 6), (6, 0)):
        with pytest.raises(
            InputError, match=f"there is no photograph of the sheet with {missing} strokes on it; take one"
        ):
            trials_of(
                SIX,
                numbered(there),
                tmp_path / "trials",
                pixels_per_metre=PER_METRE,
                medium="x",
                depth=(0, 0),
                room=1e-3,
            )
    (tmp_path / "trials").mkdir()
    (tmp_path / "trials" / "mine").touch()
    with pytest.raises(OutputError, match="is not empty"):
        trials_of(
            SIX, numbered(0, 6), tmp_path / "trials", pixels_per_metre=PER_METRE, medium="x", depth=(0, 0), room=1e-3
        )


# All of it on the simulated easel.

OFFSET = (0.6e-3, -0.4e-3)


def test_what_is_collected_on_the_easel_tells_where_strokes_land(tmp_path: Path) -> None:
    side, like = 0.16, nominal("fineliner")
    painting = practice(load_style("loops", Canvas(side, side, 1.0)), like, Sheet(width=side, height=side), 12)
    pen = Brush(name="pen", source="a test", alpha=0, beta=1.2e-3, plateau=0.95, depth=(0, 2e-3))
    ink = ModelSheet(Canvas(side, side, 6000), pen)
    robot = SimulatedEasel(ink, offset=OFFSET)
    tags = TagFrame(side, side)
    camera = SimulatedCamera(ink.image, ink.canvas, np.random.default_rng(0), tags=tags)
    eye = Eye.opened(camera, flat := Canvas(side, side, 2500), tags)
    write_painting(painting, tmp_path / "practice.json")
    with Journal.open(tmp_path / "practice.log.jsonl") as journal, robot:
        journal.revise(tmp_path / "practice.json")
        place = Workplace(robot, robot.easel(side, side), journal, lambda ask: None)
        taken = collect(painting, place, lambda: eye.look().image, tmp_path, each=False)
    trials = trials_of(
        painting,
        taken,
        tmp_path / "trials",
        pixels_per_metre=flat.pixels_per_metre,
        medium="pen",
        depth=(0, 2e-3),
        room=room_around(like),
    )
    brush = fit_brush(trials, trials.pixels_per_metre, "pen", source="a test", depth=trials.depth).brush
    path = painting.trajectories()[0]
    landed = (brush.mark(path) - path)[:, :2].mean(axis=0)
    assert landed == pytest.approx(OFFSET, abs=FOUND_OFFSET)
    assert brush.widest == pytest.approx(1.2e-3, abs=FOUND_WIDTH)
