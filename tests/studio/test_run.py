"""The machine of the studio without its page: real processes, the simulated easel, and a Grbl on a pseudo-terminal."""

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from maulstick.errors import InputError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.session import rehearse
from maulstick.painting.painting_file import read_painting
from maulstick.painting.picture import read_picture
from maulstick.robot.easel import Easel, Pen, read_easel, write_easel
from maulstick.robot.journal import Journal, journal_of
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.state.plan import Phase
from maulstick.studio.state.plans import Plans
from maulstick.studio.state.run import Run, State
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.messages import Done
from maulstick.studio.workers.plan_pictures import plan_picture
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.robot.trays import TRAY_JSON
from tests.support.studio.plans_to_paint import STROKES, put_plan, put_plan_of_a_picture
from tests.support.studio.work import never_stop

pytestmark = pytest.mark.usefixtures("data")

PATIENCE = 120.0  # seconds, for a machine that does much else
SIM, SLOW = PaintOptions(robot="sim"), PaintOptions(robot="sim:real")
PEN = Pen(up=200, down=700, seconds=0.05)  # quicker than a real servo, so that tests are


@pytest.fixture
def easel(tmp_path: Path) -> Path:
    """Write an easel file of a plotter with a servo and a sheet 40 mm high; return its path."""
    path = tmp_path / "easel.json"
    write_easel(Easel(corner=(0, 0.04, 0), right=(1, 0, 0), down=(0, -1, 0), pen=PEN), path)
    return path


@asynccontextmanager
async def opened(root: Path) -> AsyncIterator[Run]:
    """Open a studio without a page, and stop its machine at the end."""
    with Folder.opened(root) as folder:
        desk = Desk()
        run = Run(folder, desk, Mixing(folder, desk), Plans(folder))
        try:
            yield run
        finally:
            await run.close()
            desk.close()


async def until(run: Run, condition: Callable[[], bool]) -> None:
    """Wait until the condition holds, while the run is on."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            assert run.is_busy, run.state.sentence
            await asyncio.sleep(0.02)


async def outcome(run: Run) -> str:
    """Wait for the end of a run; return its sentence."""
    async with asyncio.timeout(PATIENCE):
        while run.is_busy:
            await asyncio.sleep(0.02)
    return run.state.sentence


async def confirm_where_it_stands(run: Run) -> None:
    """Answer the request of a plotter that goes on, which may have lost count of its steps."""
    await until(run, lambda: bool(run.state.question))
    assert run.state.question.startswith("see that the pen stands ")
    run.done(run.state.question_number)


async def put_in(run: Run, pen: str) -> None:
    """Answer the request for a pen, which begins so."""
    await until(run, lambda: run.state.question.startswith(f"put in the {pen}"))
    run.done(run.state.question_number)


def stroke(run: Run) -> int:
    """Return the number of the present stroke, 0 before the first."""
    return 0 if run.state.progress is None else run.state.progress.stroke


def events(painting: Path, event: str) -> list[int]:
    """Return the strokes of all entries of that event in the painting's journal."""
    lines = [json.loads(row) for row in journal_of(painting).read_text().splitlines()]
    return [entry["stroke"] for entry in lines if entry["event"] == event]


def test_a_plan_that_is_being_planned_again_is_not_painted_meanwhile(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            run._plans.of("lines").phase = Phase.PLANNING
            with pytest.raises(InputError, match="lines is being planned; wait until it has finished, or stop it"):
                await run.begin("lines", SIM)
            assert not run.is_busy
            run._plans.of("lines").phase = Phase.STOPPED
            await run.begin("lines", SIM)
            assert await outcome(run) == "lines is painted."

    asyncio.run(paint())
    assert events(painting, "begin") == events(painting, "end")


def test_it_is_checked_and_painted_to_the_end_and_every_stroke_is_in_the_journal(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            run.check("lines", SIM)
            assert await outcome(run) == "It fits."
            assert run.state.estimate is not None
            assert (run.state.estimate.strokes, round(run.state.estimate.metres, 3)) == (STROKES, 0.9)
            assert not journal_of(painting).exists()
            assert await run.status("lines") is None
            seen: list[float] = []
            run.changed.subscribe(lambda: seen.append(0.0 if run.state.progress is None else run.state.progress.drawn))
            await run.begin("lines", SIM)
            assert run.doing == "starting lines"
            assert await outcome(run) == "lines is painted."
            assert (run.doing, run.state.fault) == ("", False)
            assert seen == sorted(seen)
            assert seen[-1] == pytest.approx(0.9)
            assert run.state.photograph.startswith(b"\xff\xd8")
            status = await run.status("lines")
            assert status is not None
            assert status.is_over

    asyncio.run(paint())
    assert events(painting, "begin") == events(painting, "end")
    assert sorted(events(painting, "end")) == list(range(STROKES))


def test_it_pauses_after_a_stroke_stops_at_once_with_the_pen_lifted_and_goes_on_with_the_rest(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", SLOW)
            await until(run, lambda: stroke(run) == 2)
            run.pause()
            held = -1
            while held != (held := len(events(painting, "begin"))):
                await asyncio.sleep(1)
            assert events(painting, "end") == events(painting, "begin")
            assert held < STROKES
            assert run.doing.startswith("paused lines")
            run.go_on()
            await until(run, lambda: len(events(painting, "begin")) == held + 2)
            run.stop()
            assert run.state.phase == "stopping"
            assert await outcome(run) == "You stopped it. The pen is lifted."
            status = await run.status("lines")
            assert status is not None
            assert (status.strokes, status.options.machine) == (STROKES, "sim:real")
            assert status.painted == len(events(painting, "end")) < STROKES
            assert status.unfinished == events(painting, "begin")[-1]
            await run.resume("lines", SIM, None)
            assert "say whether it is on the paper" in await outcome(run)
            await run.begin("lines", SIM)
            assert "says that this painting was begun; “Go on where it stopped”, or “Start again" in await outcome(run)
            run.check("lines", PaintOptions(robot="grbl:/dev/ttyUSB0"), resume=True)
            assert (await outcome(run)).startswith(
                "this painting was begun on Simulated easel, at an arm's pace, and what"
            )
            await run.resume("lines", SIM, True)
            assert await outcome(run) == "lines is painted."
            run.stop()  # which can be done at any time
            assert run.state.sentence == "lines is painted."

    asyncio.run(paint())
    assert sorted(events(painting, "end")) == list(range(STROKES))


def test_what_is_stopped_while_its_paints_are_looked_up_does_not_begin(tmp_path: Path) -> None:
    put_plan(tmp_path, "six", SIX)

    async def paint() -> None:
        async with opened(tmp_path) as run:
            beginning = asyncio.create_task(run.begin("six", PaintOptions(robot="grbl:/dev/null/none")))
            await asyncio.sleep(0)  # until it waits for the desk
            assert run.stop() == "Nothing moves: there was nothing to stop."
            with pytest.raises(InputError, match="six was stopped before it began"):
                await beginning
            assert not run.is_busy

    asyncio.run(paint())


def test_one_machine_paints_at_a_time_and_only_what_is_planned_and_mixed(tmp_path: Path) -> None:
    put_plan(tmp_path, "lines")
    put_plan(tmp_path, "six", SIX, mixed=False)

    async def paint() -> None:
        async with opened(tmp_path) as run:
            with pytest.raises(
                InputError, match=r"paint 1 \(red\) and 1 more of six must be mixed first; tick what is mixed"
            ):
                await run.begin("six", PaintOptions(robot="axidraw"))
            with pytest.raises(InputError, match="none is not finished; let it be planned"):
                await run.begin("none", SIM)
            with pytest.raises(InputError, match="is no name"):
                await run.begin("../lines", SIM)
            both = await asyncio.gather(run.begin("lines", SLOW), run.begin("lines", SLOW), return_exceptions=True)
            assert [str(each) for each in both if each] == [
                "a machine is busy with lines; wait until it has finished, or stop it"
            ]
            with pytest.raises(InputError, match="busy with lines"):
                run.check("lines", SIM)

    asyncio.run(paint())  # closing the studio while the machine is being made ready stops it, too
    assert not journal_of(tmp_path / "plans" / "lines" / "painting.json").exists()


def test_what_does_not_fit_the_machine_is_said_and_nothing_moves(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "fast", painting_of([line(1, speed=0.4)]))

    async def paint() -> None:
        async with opened(tmp_path) as run:
            run.check("fast", SLOW)
            sentence = await outcome(run)
            assert "the machine's fastest is 250" in sentence
            assert sentence.endswith("; slow all strokes down: write 250 under “Speed, sheet, camera and copies”")
            assert run.state.fault
            await run.begin("fast", PaintOptions(robot="grbl:/dev/null/none"))
            assert (await outcome(run)).startswith("cannot open the port /dev/null/none")

    asyncio.run(paint())
    assert not journal_of(painting).exists()


def test_a_plotter_waits_for_its_pens_and_is_driven_by_nobody_else(tmp_path: Path, easel: Path) -> None:
    painting = put_plan(tmp_path, "six", SIX)
    other = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            options = PaintOptions(robot=f"grbl:{device.port}", easel=easel)
            await run.begin("six", options)
            await until(run, lambda: bool(run.state.question))
            assert run.state.question == "put in the marker with paint 1 (red); it draws for less than 1 min"
            assert run.doing == "painting six: waits for you"
            assert events(painting, "begin") == []
            link = tmp_path / "plotter"
            link.symlink_to(device.port)
            for port in (device.port, link):
                with pytest.raises(InputError, match=r"another maulstick drives grbl:.*; wait until it"):
                    await asyncio.to_thread(
                        rehearse, PaintRequest(other, PaintOptions(robot=f"grbl:{port}", easel=easel))
                    )
            first = run.state.question_number
            run.done(first)
            await until(run, lambda: bool(run.state.question))
            run.done(first)  # in another tab, late
            assert run._process is not None
            run._process.tell(Done(first))  # as if that had been under way
            await asyncio.sleep(0.5)
            assert run.state.question == "put in the marker with paint 2 (blue); it draws for less than 1 min"
            assert len(events(painting, "end")) == 3
            run.stop()
            assert await outcome(run) == "You stopped it. The pen is lifted."
            await run.resume("six", PaintOptions(), None)
            await confirm_where_it_stands(run)
            await until(run, lambda: bool(run.state.question))
            run.done(run.state.question_number)
            assert await outcome(run) == "six is painted."

    with FakeGrbl() as device:
        asyncio.run(paint())
        assert device.servo == PEN.up
    assert sorted(events(painting, "end")) == list(range(10, 16))


def test_a_plotter_is_stopped_in_the_middle_of_a_stroke(tmp_path: Path, easel: Path) -> None:
    painting = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", PaintOptions(robot=f"grbl:{device.port}", easel=easel))
            await put_in(run, "marker")
            await until(run, lambda: device.servo == PEN.down and len(events(painting, "begin")) == 2)
            run.stop()
            run.stop()  # as somebody does who is frightened
            assert await outcome(run) == "You stopped it. The pen is lifted."
            assert device.holds >= 1
            assert device.servo == PEN.up

    with FakeGrbl(pace=1.0) as device:
        asyncio.run(paint())
    assert len(events(painting, "end")) < 3


def test_the_machines_own_button_pauses_it_and_the_page_shows_it(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", PaintOptions(robot=f"axidraw:{device.port}"))
            await put_in(run, "marker")
            await until(run, lambda: stroke(run) >= 2)
            device.button = True
            await until(run, lambda: run.doing.startswith("paused lines"))
            assert events(painting, "end") == events(painting, "begin")
            device.button = True
            await until(run, lambda: not run.state.held)
            run.stop()
            assert await outcome(run) == "You stopped it. The pen is lifted."

    with FakeEbb(pace=4) as device:
        asyncio.run(paint())


def is_gone(process: int) -> bool:
    """Return whether the process of that id has ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def test_when_the_studio_is_killed_the_plotter_stops_with_its_pen_lifted_and_the_rest_is_painted_later(
    tmp_path: Path, easel: Path
) -> None:
    painting = put_plan(tmp_path, "lines")
    with FakeGrbl(pace=1.0) as device:
        machine = f"grbl:{device.port}"
        command: list[str | Path] = [
            sys.executable,
            "-m",
            "tests.support.studio.mortal_studio",
            tmp_path,
            "lines",
            machine,
            easel,
        ]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as studio:
            assert studio.stdout is not None
            painter = int(studio.stdout.readline())
            studio.send_signal(signal.SIGKILL)
        deadline = time.monotonic() + PATIENCE
        while not is_gone(painter):
            assert time.monotonic() < deadline
            time.sleep(0.05)
        assert device.servo == PEN.up
        painted = len(events(painting, "end"))
        assert 0 < painted < STROKES
        with Journal.open(journal_of(painting)) as journal:
            assert journal.unfinished in (None, events(painting, "begin")[-1])

        async def go_on() -> None:
            async with opened(tmp_path) as run:
                status = await run.status("lines")
                assert status is not None
                assert status.painted == painted
                await run.resume("lines", PaintOptions(), None if status.unfinished is None else False)
                await confirm_where_it_stands(run)
                await put_in(run, "marker")
                assert await outcome(run) == "lines is painted."

        device.pace = 200.0
        asyncio.run(go_on())
    assert sorted(events(painting, "end")) == list(range(STROKES))
    assert len(events(painting, "begin")) <= STROKES + 1


def test_when_somebody_asks_it_looks_and_plans_what_is_left_again(tmp_path: Path) -> None:
    painting = put_plan_of_a_picture(tmp_path, "disc")
    picture = tmp_path / "pictures" / "disc" / "picture.png"
    states: list[State] = []

    def is_planning(state: State) -> bool:
        return state.progress is not None and state.progress.strokes is None

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("disc", PaintOptions(robot="sim:real", speed=10.0, look=True, replan=0, picture=picture))
            await until(run, lambda: stroke(run) >= 2)
            run.changed.subscribe(lambda: states.append(run.state))
            run.replan_now()
            assert run.state.will_look
            await until(run, lambda: any(is_planning(state) for state in states) and not is_planning(run.state))
            run.stop()
            assert await outcome(run) == "You stopped it. The pen is lifted."

    asyncio.run(paint())
    assert not next(state for state in states if is_planning(state)).will_look
    progress = states[-1].progress
    assert progress is not None
    assert progress.strokes == len(read_painting(painting.with_name("painting.r1.json")).strokes)
    again = plan_picture(painting)
    assert again != painting.with_name("preview.png")
    assert read_picture(again).shape[1] == 1280
    revisions = [json.loads(row) for row in journal_of(painting).read_text().splitlines()]
    assert [entry["file"] for entry in revisions if entry["event"] == "revision"] == [
        "painting.json",
        "painting.r1.json",
    ]


def test_what_does_not_answer_a_stop_is_told_and_can_be_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_plan(tmp_path, "lines")
    monkeypatch.setattr("maulstick.studio.state.run.paint_in_process", never_stop)
    monkeypatch.setattr("maulstick.studio.state.run.LONGEST_STOP", 0.01)

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", SIM)
            await until(run, lambda: run.state.phase == "painting")
            run.give_up()  # which is for what was stopped before
            assert run.is_busy
            run.stop()
            await until(run, lambda: run.state.silent)
            assert run.state.phase == "stopping"
            run.give_up()
            assert (run.state.sentence, run.state.fault) == (
                "It was ended without an answer. Look at the machine: its pen may still be down.",
                True,
            )
            assert not run.state.silent
            await run.begin("lines", SIM)  # nothing of the old one is left

    asyncio.run(paint())


def test_whoever_goes_on_without_a_tray_or_with_another_one_is_not_given_the_old_one(tmp_path: Path) -> None:
    painting = put_plan(tmp_path, "lines")
    before = PaintOptions(robot="sim", tray=tmp_path / "old.json", speed=0.01).as_json(painting.parent, home=tmp_path)
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
        journal.write_options(before)
    assert rehearse(PaintRequest(painting, PaintOptions(robot="sim", tray=None), resume=True)).strokes == STROKES
    for options, tray in ((PaintOptions(), "old.json"), (PaintOptions(tray=tmp_path / "new.json"), "new.json")):
        with pytest.raises(InputError, match=tray):
            rehearse(PaintRequest(painting, options, resume=True))
    after = PaintOptions(robot="sim", tray=None).after(before, painting.parent)
    assert (after.tray, after.speed) == (None, 0.01)


def test_a_painting_that_was_begun_goes_on_in_a_studio_that_was_moved(tmp_path: Path, easel: Path) -> None:
    here, there = tmp_path / "studio", tmp_path / "elsewhere" / "Ateliê"
    painting = put_plan(here, "six", SIX)
    (here / "easels").mkdir()
    write_easel(read_easel(easel).model_copy(update={"deepest": 0.001}), here / "easels" / "mine.json")
    (here / "tray.json").write_text(json.dumps(TRAY_JSON))

    async def begin() -> None:
        async with opened(here) as run:
            options = PaintOptions(robot="sim:real", easel=run.easels.path("mine"), tray=here / "tray.json")
            await run.begin("six", options)
            await until(run, lambda: stroke(run) == 2)
            run.stop()
            await outcome(run)

    async def go_on() -> None:
        async with opened(there) as run:
            status = await run.status("six")
            assert status is not None
            assert status.options.easel == run.easels.path("mine")
            assert status.options.tray == there / "tray.json"
            await run.resume("six", PaintOptions(robot="sim"), is_painted=False)
            assert await outcome(run) == "six is painted."

    asyncio.run(begin())
    told = [file for file in here.rglob("*") if file.is_file() and str(here).encode() in file.read_bytes()]
    assert told == [], "they name the folder, which may be moved"
    there.parent.mkdir()
    here.rename(there)
    asyncio.run(go_on())
    assert journal_of(there / "plans" / "six" / painting.name).is_file()


def test_a_painter_that_is_killed_is_known_to_be_gone(tmp_path: Path) -> None:
    put_plan(tmp_path, "lines")

    async def paint() -> None:
        async with opened(tmp_path) as run:
            await run.begin("lines", SLOW)
            await until(run, lambda: stroke(run) == 2)
            assert run._process is not None
            os.kill(run._process._process.pid or 0, signal.SIGKILL)
            assert "Look at the machine: its pen may still be down." in await outcome(run)
            assert run.state.fault
            status = await run.status("lines")
            assert status is not None
            assert status.painted >= 1

    asyncio.run(paint())
