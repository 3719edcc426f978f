"""The process of a run, which holds the machine, the journal and the camera: what it hears and what it says.

It stops the machine, lifts the pen and ends by itself once the studio is gone, however that went.
"""

import os
import signal
import threading
import time
from collections.abc import Collection
from typing import TYPE_CHECKING

from maulstick.errors import InputError, MaulstickError
from maulstick.studio.wording import said
from maulstick.studio.workers.messages import Command, Done, Ended
from maulstick.studio.workers.process import Line

if TYPE_CHECKING:
    from maulstick.jobs.paint.session import PaintRequest
    from maulstick.jobs.paint.setup import PaintSetup
    from maulstick.studio.workers.page_operator import PageOperator

_LONGEST_FAREWELL = 20.0  # seconds for the pen to be lifted once nobody is there


def rehearse_in_process(line: Line, request: "PaintRequest") -> None:
    """Say the `Estimate` of a run."""
    from maulstick.jobs.paint.session import rehearse

    line.say(rehearse(request))


def paint_in_process(line: Line, request: "PaintRequest", unfinished: bool | None) -> None:
    """Paint. unfinished: whether the stroke that was under the brush is on the paper, where somebody has said so."""
    ear = _Ear()
    line.heard_by(ear.hear, ear.stay_alone)
    from maulstick.jobs.paint import session
    from maulstick.studio.workers.page_operator import PageOperator

    def is_painted(stroke: int) -> bool:
        if unfinished is None:
            raise InputError(f"stroke {stroke} was under the brush when it ended; say whether it is on the paper")
        return unfinished

    def operator_for(setup: "PaintSetup", painted: Collection[int]) -> PageOperator:
        operator = PageOperator(line, setup, len(painted))
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1):
            signal.signal(number, operator.interrupt)
        ear.belong_to(operator)
        return operator

    try:
        session.paint(request, is_painted, operator_for)
    except (MaulstickError, KeyboardInterrupt) as error:
        if ear.operator is None:
            raise
        why = said(error) if isinstance(error, MaulstickError) and not ear.operator.stopped else ""
        line.say(Ended(why, ear.operator.robot.lifted))
    else:
        line.say(Ended(None, True))


class _Ear:
    """What is heard, in its own thread, before there is a person whom it can be brought to, and then."""

    def __init__(self) -> None:
        self.operator: PageOperator | None = None
        self._is_to_stop = False

    def belong_to(self, operator: "PageOperator") -> None:
        """From now on bring it to them."""
        self.operator = operator
        if self._is_to_stop:
            operator.stop()

    def hear(self, word: object) -> None:
        """A wish."""
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

    def stay_alone(self) -> None:
        """Nobody is there any more."""
        self.hear(Command.STOP)
        time.sleep(_LONGEST_FAREWELL)
        os._exit(1)


def _stop(operator: "PageOperator") -> None:
    operator.stop()
    if operator.resting:  # else a signal would disturb what lifts the pen
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGUSR1)
