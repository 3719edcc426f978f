"""Plans that stand still until the studio speaks to them, so that a test acts in time however slow the machine is."""

from collections.abc import Callable
from pathlib import Path
from threading import Semaphore

from maulstick.jobs.plan.request import PlanRequest, state_files
from maulstick.studio.workers import planner
from maulstick.studio.workers.planner import Leave, Step, Stop
from maulstick.studio.workers.process import Line


class _HeldLine:
    """Line on which a step from each of these shares of the plan on is said, and then nothing until a word came."""

    def __init__(self, line: Line, shares: tuple[float, ...]) -> None:
        self._line, self._shares = line, [*shares]
        self._words = Semaphore(0)

    def say(self, word: object) -> None:
        self._line.say(word)
        if isinstance(word, Step) and self._shares and word.done >= self._shares[0]:
            del self._shares[0]
            self._words.acquire()

    def heard_by(self, hear: Callable[[object], None], alone: Callable[[], None]) -> None:
        def heard(word: object) -> None:
            hear(word)
            if isinstance(word, Stop | Leave):
                self._shares.clear()
            self._words.release()

        def left() -> None:
            alone()
            self._shares.clear()
            self._words.release()

        self._line.heard_by(heard, left)


def held_plan(shares: tuple[float, ...], line: Line, request: PlanRequest, folder: Path) -> None:
    """Plan as the studio does, but say every step, and stand still at these shares unless an earlier plan goes on."""
    planner._STEP_PERIOD = 0.0  # of this process alone
    goes_on = bool(state_files(folder))
    planner.plan(_HeldLine(line, () if goes_on else shares), request, folder)  # type: ignore[arg-type]
