"""Process of a run, which has the machine, the journal and the camera.

It stops the machine, lifts the pen and ends by itself once the studio is gone, even if the studio was killed.
"""

import signal
import threading
from collections.abc import Collection
from itertools import count
from typing import TYPE_CHECKING

from maulstick.errors import InputError, MaulstickError
from maulstick.studio.wording import error_text
from maulstick.studio.workers.messages import Command, Done, Ended
from maulstick.studio.workers.process import Line, farewell

if TYPE_CHECKING:
    from maulstick.jobs.paint.request import PaintRequest
    from maulstick.jobs.paint.setup import PaintSetup
    from maulstick.studio.workers.page_operator import PageOperator


def rehearse_in_process(line: Line, request: "PaintRequest") -> None:
    """Check a run, and send its `Estimate`."""
    from maulstick.jobs.paint.session import rehearse

    line.say(rehearse(request))


def paint_in_process(line: Line, request: "PaintRequest", unfinished: bool | None) -> None:
    """Paint. unfinished: whether the stroke that was interrupted is on the paper, or None where nobody has said."""
    commands = _Commands()
    line.heard_by(commands.hear, lambda: farewell(lambda: commands.hear(Command.STOP)))
    from maulstick.jobs.paint import session
    from maulstick.studio.workers.page_operator import PageOperator
    from maulstick.studio.workers.plan_pictures import rehearsed_sheet

    def is_painted(number: int) -> bool:
        if unfinished is None:
            raise InputError(f"stroke {number} was under the brush when it ended; say whether it is on the paper")
        return unfinished

    questions = count(1)
    former = None if request.resume else rehearsed_sheet(request.painting)

    def operator_for(setup: "PaintSetup", painted: Collection[int]) -> PageOperator:
        operator = PageOperator(line, setup, len(painted), questions, former)
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1):
            signal.signal(number, operator.interrupt)
        commands.belong_to(operator)
        return operator

    try:
        session.paint(request, is_painted, operator_for)
    except (MaulstickError, KeyboardInterrupt) as error:
        if commands.operator is None:
            raise
        why = error_text(error) if isinstance(error, MaulstickError) and not commands.operator.stopped else ""
        line.say(Ended(why, commands.operator.robot.lifted))
    else:
        line.say(Ended(None, True))


class _Commands:
    """Receiver of the studio's commands, in a thread of its own; a stop is remembered until there is an operator."""

    def __init__(self) -> None:
        self.operator: PageOperator | None = None
        self._is_to_stop = False

    def belong_to(self, operator: "PageOperator") -> None:
        """Pass commands to this operator from now on, and a stop or a pause that came before, during another sheet."""
        if self.operator is not None:
            operator.pause.held = self.operator.pause.held
        self.operator = operator
        if self._is_to_stop:
            operator.stop()

    def hear(self, word: object) -> None:
        """Pass a message of the studio on."""
        if word is Command.STOP:
            self._is_to_stop = True
        if self.operator is None:
            return
        match word:
            case Command.STOP:
                _stop(self.operator)
            case Command.PAUSE:
                self.operator.pause.held = True
            case Command.GO_ON:
                self.operator.pause.held = False
            case Command.LOOK:
                self.operator.look_after_this_stroke()
            case Done(question=question):
                self.operator.confirm(question)


def _stop(operator: "PageOperator") -> None:
    operator.stop()
    if operator.resting:  # otherwise a signal would interrupt the lifting of the pen
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGUSR1)
