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
from maulstick.studio.workers.messages import Done, Ended, Wish
from maulstick.studio.workers.process import Line

if TYPE_CHECKING:
    from maulstick.jobs.paint.session import Errand
    from maulstick.jobs.paint.setup import Scene
    from maulstick.studio.workers.page_operator import Beside

_LONGEST_FAREWELL = 20.0  # seconds for the pen to be lifted once nobody is there


def rehearse_in_process(line: Line, errand: "Errand") -> None:
    """Say the `Outlook` of a run."""
    from maulstick.jobs.paint.session import rehearse

    line.say(rehearse(errand))


def paint_in_process(line: Line, errand: "Errand", unfinished: bool | None) -> None:
    """Paint. unfinished: whether the stroke that was under the brush is on the paper, where somebody has said so."""
    ear = _Ear()
    line.heard_by(ear.hear, ear.stay_alone)
    from maulstick.jobs.paint import session
    from maulstick.studio.workers.page_operator import Beside

    def is_painted(stroke: int) -> bool:
        if unfinished is None:
            raise InputError(f"stroke {stroke} was under the brush when it ended; say whether it is on the paper")
        return unfinished

    def person_beside(scene: "Scene", painted: Collection[int]) -> Beside:
        person = Beside(line, scene, len(painted))
        for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1):
            signal.signal(number, person.interrupt)
        ear.belong_to(person)
        return person

    try:
        session.paint(errand, is_painted, person_beside)
    except (MaulstickError, KeyboardInterrupt) as error:
        if ear.person is None:
            raise
        line.say(Ended("" if ear.person.stopped else str(error), ear.person.robot.lifted))
    else:
        line.say(Ended(None, True))


class _Ear:
    """What is heard, in its own thread, before there is a person whom it can be brought to, and then."""

    def __init__(self) -> None:
        self.person: Beside | None = None
        self._is_to_stop = False

    def belong_to(self, person: "Beside") -> None:
        """From now on bring it to them."""
        self.person = person
        if self._is_to_stop:
            person.stop()

    def hear(self, word: object) -> None:
        """A wish."""
        if word is Wish.STOP:
            self._is_to_stop = True
        if self.person is None:
            return
        match word:
            case Wish.STOP:
                _stop(self.person)
            case Wish.PAUSE:
                self.person.pause.held = True
            case Wish.GO_ON:
                self.person.pause.held = False
            case Wish.LOOK:
                self.person.look_after_this_stroke()
            case Done(question=question):
                self.person.confirm(question)

    def stay_alone(self) -> None:
        """Nobody is there any more."""
        self.hear(Wish.STOP)
        time.sleep(_LONGEST_FAREWELL)
        os._exit(1)


def _stop(person: "Beside") -> None:
    person.stop()
    if person.resting:  # else a signal would disturb what lifts the pen
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGUSR1)
