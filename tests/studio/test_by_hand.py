"""A machine that is set up on the page, without its page: real processes, plotters on pseudo-terminals."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from maulstick.drawing.options import DrawingOptions
from maulstick.errors import InputError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.robot.easel import read_easel
from maulstick.studio.state.by_hand import ByHand
from maulstick.studio.state.easels import Easels
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.by_hand import Deed, Jog, SetServo, Word
from maulstick.studio.workers.svg_work import read_svg
from tests.support.robot.fake_ebb import FakeEbb
from tests.support.robot.fake_grbl import WITH_SWITCHES, FakeGrbl
from tests.support.studio.drawings import BOAT
from tests.support.studio.plans_to_paint import put_plan

pytestmark = pytest.mark.usefixtures("data")

PATIENCE = 120.0  # seconds, for a machine that does much else


@asynccontextmanager
async def in_hand(root: Path, device: FakeGrbl | FakeEbb, painting: Path | None = None) -> AsyncIterator[ByHand]:
    """Take hold of a plotter, and let go of it at the end."""
    kind = "grbl" if isinstance(device, FakeGrbl) else "axidraw"
    with Folder.opened(root) as folder:
        hand = ByHand(Easels(folder))
        hand.begin(PaintOptions(robot=f"{kind}:{device.port}"), painting)
        try:
            await rest(hand)
            yield hand
        finally:
            await hand.close()


async def rest(hand: ByHand) -> None:
    """Wait until the machine has done all that it was told, or is out of hand."""
    async with asyncio.timeout(PATIENCE):
        while hand.state.phase in ("connecting", "moving", "stopping"):
            await asyncio.sleep(0.02)


async def do(hand: ByHand, *words: Word) -> None:
    """Say one word after another, each once the one before is done."""
    for word in words:
        hand.do(word)
        await rest(hand)


def run(test: Callable[[], Awaitable[None]]) -> None:
    asyncio.run(test())  # type: ignore[arg-type]


def test_a_machine_is_moved_around_its_sheet_draws_a_square_and_is_let_go(tmp_path: Path) -> None:
    painting = put_plan(tmp_path / "studio", "lines")

    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device, painting) as hand:
            assert hand.doing == f"Pen plotter with Grbl at {device.port} is moved by hand"
            assert hand.state.standing is not None
            assert hand.state.standing.has_sheet
            await do(hand, Jog(0, 0.01), Jog(1, 0.005))
            assert hand.state.standing.place[:2] == pytest.approx((0.01, 0.005))
            await do(hand, Deed.SQUARE, Deed.OUTLINE, Deed.LEAVE)
            assert (hand.is_on, hand.state.phase, hand.state.fault) == (False, "off", False)

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)
        down = {(round(x), round(y)) for x, y, z, _ in device.reached if z <= 0}
        up = {(round(x), round(y)) for x, y, z, _ in device.reached if z > 0}
    assert down >= {(10, 5), (30, 5), (30, 25), (10, 25)}
    assert up >= {(0, 0), (60, 0), (60, 40), (0, 40)}


def test_it_goes_around_the_sheet_that_a_drawing_is_read_for(tmp_path: Path) -> None:
    drawing = tmp_path / "studio" / "drawings" / "boat" / "drawing.svg"
    drawing.parent.mkdir(parents=True)
    drawing.write_text(BOAT)
    read_svg(drawing, "boat", DrawingOptions(size=(0.09, 0.06)))

    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device, drawing) as hand:
            await do(hand, Deed.OUTLINE)

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)
        corners = {(round(x), round(y)) for x, y, *_ in device.reached}
    assert corners >= {(0, 0), (90, 0), (90, 60), (0, 60)}


def test_what_cannot_be_done_is_said_and_the_next_word_works(tmp_path: Path) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            await do(hand, Jog(0, -0.01))
            assert hand.state.fault
            assert "the machine's x is -10 mm" in hand.state.sentence
            await do(hand, Deed.OUTLINE)
            assert "the sheet's size is not known" in hand.state.sentence
            await do(hand, Jog(0, 0.001))
            assert not hand.state.fault
            with pytest.raises(InputError, match="is in hand already; let it go first"):
                hand.begin(PaintOptions(robot=f"grbl:{device.port}"), None)

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)


@pytest.mark.parametrize(("first", "x"), [(Deed.FIND_HOME, 0.099), (Deed.UNLOCK, 0.05)])
def test_a_locked_machine_finds_home_or_is_unlocked_and_finds_home_whenever_it_is_asked(
    tmp_path: Path, first: Deed, x: float
) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            assert (hand.state.phase, hand.state.standing) == ("locked", None)
            assert hand.state.sentence.startswith("The machine is locked, as its place may be lost.")
            await do(hand, Jog(0, 0.01))
            assert hand.state.phase == "locked"
            await do(hand, first)
            assert hand.state.standing is not None
            assert hand.state.standing.finds_home
            assert hand.state.standing.place[0] == pytest.approx(x)
            await do(hand, Jog(0, -0.01), Deed.LOWER, Deed.FIND_HOME)
            assert hand.state.standing.place[0] == pytest.approx(0.099)
            assert not hand.state.fault
            await do(hand, Deed.LEAVE)

    with FakeGrbl(pace=1000.0, locked=True, **WITH_SWITCHES) as device:
        run(set_up)


@pytest.mark.parametrize(("last", "state"), [(Deed.UNLOCK, "Idle"), (Deed.LEAVE, "Alarm")])
def test_a_locked_machine_without_switches_says_so_and_can_be_unlocked_or_left(
    tmp_path: Path, last: Deed, state: str
) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            await do(hand, Deed.FIND_HOME)
            assert (hand.state.phase, hand.state.fault) == ("locked", True)
            assert "has no switches to find home by" in hand.state.sentence
            await do(hand, last)
            assert hand.is_on == (last is Deed.UNLOCK)

    with FakeGrbl(pace=1000.0, locked=True) as device:
        run(set_up)
        until = time.monotonic() + PATIENCE
        while device.state == "Hold:0" and time.monotonic() < until:  # a slow stop outlasts what closing waits for
            time.sleep(0.02)
        assert device.state == state


def test_a_stop_ends_a_search_for_home(tmp_path: Path) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            hand.do(Deed.FIND_HOME)
            async with asyncio.timeout(PATIENCE):
                while device.state != "Home":
                    await asyncio.sleep(0.02)
            hand.stop()
            await rest(hand)
            assert (hand.is_on, hand.state.sentence) == (False, "You stopped it.")

    with FakeGrbl(locked=True, homing=3600.0, **WITH_SWITCHES) as device:
        run(set_up)
        assert device.state == "Alarm"


def test_a_stop_lifts_the_pen_and_ends_it(tmp_path: Path) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            assert hand.stop() == "The machine stops and lifts its pen."
            await rest(hand)
            assert hand.stop() == "", "nothing is in hand"
            hand.begin(PaintOptions(robot=f"grbl:{device.port}"), None)
            await rest(hand)
            await do(hand, Deed.LOWER)
            assert hand.state.standing is not None
            assert not hand.state.standing.lifted
            hand.stop()
            await rest(hand)
            assert (hand.state.sentence, hand.state.fault) == ("You stopped it.", False)

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)
        assert device.place[2] == 5, (device.lines[-12:], device.reached[-4:])


@pytest.mark.parametrize("last", [Deed.STOP, Deed.LEAVE])
def test_a_tip_that_was_lowered_by_height_is_lifted_at_the_end(tmp_path: Path, last: Deed) -> None:
    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device) as hand:
            await do(hand, Jog(2, -0.006))
            assert hand.state.standing is not None
            assert not hand.state.standing.lifted
            if last is Deed.STOP:
                hand.stop()
            else:
                hand.do(last)
            await rest(hand)
            assert not hand.state.fault

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)
        assert device.place[2] == pytest.approx(5)


def test_a_stop_while_it_connects_is_not_forgotten(tmp_path: Path) -> None:
    async def set_up() -> None:
        with Folder.opened(tmp_path / "studio") as folder:
            hand = ByHand(Easels(folder))
            hand.begin(PaintOptions(robot=f"grbl:{device.port}"), None)
            hand.stop()
            hand.do(Jog(0, 0.01))
            await rest(hand)
            assert not hand.is_on

    with FakeGrbl(pace=1000.0) as device:
        run(set_up)
        assert device.place[0] == 0


def test_the_servo_is_set_and_kept_as_an_easel_and_motors_are_let_go(tmp_path: Path) -> None:
    painting = put_plan(tmp_path / "studio", "lines")

    async def set_up() -> None:
        async with in_hand(tmp_path / "studio", device, painting) as hand:
            assert hand.state.standing is not None
            before = hand.state.standing.pen
            assert before is not None
            await do(hand, SetServo(0.01))
            assert "the pen is up at" in hand.state.sentence
            assert hand.keep("Gallery wall") == "gallery-wall"
            kept = read_easel(tmp_path / "studio" / "easels" / "gallery-wall.json").pen
            assert kept == hand.state.standing.pen != before
            await do(hand, Jog(0, 0.01), Deed.LET_GO)
            assert hand.state.phase == "loose"
            hand.do(Jog(0, 0.01))  # of a page that was slow to show it
            assert hand.state.phase == "loose"
            await do(hand, Deed.TAKE_HOLD)
            assert hand.state.standing.place[0] == 0, "where it was pushed is its home"
            await do(hand, SetServo(-0.01), Deed.LEAVE)
            assert hand.state.sentence == "The pen's new numbers or place were not kept."

    with FakeEbb() as device:
        run(set_up)
        assert not device.down


def test_a_machine_that_is_not_there_is_told(tmp_path: Path) -> None:
    async def set_up() -> None:
        with Folder.opened(tmp_path / "studio") as folder:
            hand = ByHand(Easels(folder))
            with pytest.raises(InputError, match="choose a real machine"):
                hand.begin(PaintOptions(robot="sim"), None)
            hand.begin(PaintOptions(robot=f"grbl:{tmp_path}/nothing"), None)
            await rest(hand)
            assert hand.state.fault
            assert "nothing" in hand.state.sentence

    run(set_up)
