"""Operator at the studio's page, in the process that drives the machine."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.jobs.paint.turns import in_minutes
from maulstick.painting.painting import Painting
from maulstick.painting.picture import encode_jpeg, read_picture
from maulstick.robot.execute import PaintProgress
from maulstick.robot.robot import StoppedError
from maulstick.robot.routine import Draw, Prompt, TrayVisit
from maulstick.storage.arrays import Image
from maulstick.studio.wording import prompt_text
from maulstick.studio.workers.messages import PAINTING, PLANNING, Held, Note, OperatorRequest, Photograph, RunProgress
from maulstick.studio.workers.plan_pictures import keep_plan_picture
from maulstick.studio.workers.planned_paints import asked_in_words
from maulstick.studio.workers.process import Line

_GLANCE = 0.05  # seconds between two checks for an answer or a stop
_SHOW = 0.25  # seconds between two messages about progress
_PHOTOGRAPH = 1.0  # seconds between two pictures of a simulated sheet
_LONGEST_PX = 1280  # longest side of a picture that is sent to the page
_TRAY_VISITS = {"rinse": "rinsing the brush", "wipe": "wiping the brush", "dip": "taking up paint"}
_MOVING = {PAINTING, *_TRAY_VISITS.values()}


@dataclass(frozen=True)
class _Moment:
    progress: RunProgress
    since: float


@final
class PageOperator(Operator):
    """Operator who sees and answers on the page, over the line to the studio.

    painted: number of strokes that are painted already.  questions: numbers of requests, each of which comes once.
    former: file of a picture of an earlier run's sheet, removed once the machine is there, or None.
    """

    def __init__(
        self, line: Line, setup: PaintSetup, painted: int, questions: Iterator[int], former: Path | None
    ) -> None:
        super().__init__(setup.robot)
        self._former = former
        self._line, self._setup = line, setup
        self._questions, self._question, self._done = questions, 0, threading.Event()
        self._stroke = painted
        self._strokes: int | None = len(setup.plan.strokes)
        self._wants_a_look = False
        self._drawn = 0.0  # metres, before the last look
        self._moment: _Moment | None = None
        self._photograph: Path | None = None  # by which the rest was last planned again
        self._sheet: Image | None = None  # that is not shown yet
        self._photograph_due = 0.0

    def expect(self, estimate: Estimate) -> None:
        """As in `Operator`; the machine is there."""
        if self._former is not None:
            self._former.unlink(missing_ok=True)
        self._line.say(estimate)

    @contextmanager
    def on_duty(self) -> Iterator[None]:
        """As in `Operator`."""
        if self.stopped:  # while the machine was connecting, which clears the robot's own stop
            raise StoppedError
        over = threading.Event()
        showing = threading.Thread(target=self._keep_showing, args=(over,), daemon=True)
        showing.start()
        try:
            yield
        finally:
            over.set()
            showing.join()

    def watch(self, progress: PaintProgress) -> None:
        """As in `Operator`."""
        paint = None if progress.action is None else progress.action.paint
        match progress.action:
            case Draw():
                self._stroke += 1
                doing = PAINTING
            case TrayVisit(what=what):
                doing = _TRAY_VISITS[what]
            case Prompt():
                doing = "waiting for you"
            case None:
                doing = "finishing" if self._setup.replanning is None else "looking at the sheet"
        drawn, metres = self._drawn + progress.drawn, self._drawn + progress.metres
        if progress.action is None:
            self._drawn = drawn
        self._moment = _Moment(
            RunProgress(doing, self._stroke, self._strokes, drawn, metres, progress.left, paint, progress.next_paint),
            time.monotonic(),
        )
        if self._setup.simulation is not None and time.monotonic() > self._photograph_due:
            self._sheet = self._setup.simulation.robot.sheet.image()
            self._photograph_due = time.monotonic() + _PHOTOGRAPH

    def ask(self, action: Prompt) -> None:
        """As in `Operator`."""
        self._question = next(self._questions)
        self._done.clear()  # in this order, or an answer to an earlier question could answer this one
        paint = self._setup.plan.paints[action.paint]
        message = asked_in_words(prompt_text(action), paint, action.paint)
        if action.seconds is not None:
            message += f"; it draws for {in_minutes(action.seconds)}"
        self._line.say(OperatorRequest(self._question, message))
        while not (self._done.wait(_GLANCE) or self.stopped):
            pass
        self._line.say(OperatorRequest(self._question, None))

    def note(self, sentence: str) -> None:
        """As in `Operator`."""
        self._line.say(Note(sentence))

    def tell_of_button(self, held: bool) -> None:
        """As in `Operator`; the page's own buttons show it."""
        self._line.say(Held(held))

    def show(self, photograph: Path) -> None:
        """As in `Operator`; planning comes next."""
        self.leave(photograph)
        self._photograph = photograph
        self._strokes = None  # it may leave some out
        if (moment := self._moment) is not None:
            planning = replace(moment.progress, doing=PLANNING, strokes=None)
            self._moment = _Moment(planning, time.monotonic())

    def expect_plan(self, painting: Painting) -> None:
        """As in `Operator`."""
        if self._photograph is not None:
            keep_plan_picture(painting, self._photograph)
        self._strokes = len(painting.strokes)

    def leave(self, photograph: Path) -> None:
        """As in `Operator`."""
        self._line.say(Photograph(encode_jpeg(read_picture(photograph, longest_px=_LONGEST_PX))))

    def wants_a_look(self) -> bool:
        """As in `Operator`."""
        wanted, self._wants_a_look = self._wants_a_look, False
        return wanted

    def confirm(self, question: int) -> None:
        """Note that the request of that number is done; one of an earlier number is ignored."""
        if question == self._question:
            self._done.set()

    def look_after_this_stroke(self) -> None:
        """Note that the camera is wanted after this stroke."""
        self._wants_a_look = True

    def _keep_showing(self, over: threading.Event) -> None:
        while not over.wait(_SHOW):
            self._say_where_it_is()
            if (sheet := self._sheet) is not None:
                self._sheet = None
                self._line.say(Photograph(encode_jpeg(sheet, _LONGEST_PX)))
        self._say_where_it_is()

    def _say_where_it_is(self) -> None:
        if (moment := self._moment) is None:
            return
        moves = moment.progress.doing in _MOVING and not self.pause.held
        passed = time.monotonic() - moment.since if moves else 0.0
        self._line.say(replace(moment.progress, left=max(moment.progress.left - passed, 0.0)))
