"""Letting a machine paint, from Python."""

import threading
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, final

from PIL import Image as Pillow
from pydantic import ValidationError

from maulstick.api.usual_torch import in_usual_torch
from maulstick.api.warning import warn
from maulstick.drawing.options import DrawingOptions
from maulstick.errors import PYTHON, InputError, MaulstickError, option, validation_fault
from maulstick.jobs.paint import session
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.setup import PaintSetup
from maulstick.jobs.paint.status import status_of
from maulstick.kinds import check_names, checked
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.robot.execute import PaintProgress
from maulstick.robot.machines import check_spec
from maulstick.robot.robot import Robot, StoppedError
from maulstick.robot.routine import Prompt

_OF_OTHERS = {"robot", "look", "strokes_sha256"}  # a parameter of `paint`, a key of the terminal, a journal's own
_NAMES = PaintOptions.model_fields.keys() - _OF_OTHERS


@dataclass(frozen=True)
class PaintResult:
    """What became of a painting.

    strokes, painted: how many it has, and how many are on the sheet, those before `from_stroke` among them.
    photograph: the sheet as it is now, where the simulated easel has painted; None where nothing was left to paint.
    """

    strokes: int
    painted: int
    photograph: Pillow.Image | None


@checked
@in_usual_torch
def paint(
    painting: Painting | str | Path,
    robot: str | Robot = "sim",
    *,
    resume: bool = False,
    restart: bool = False,
    unfinished: bool | None = None,
    from_stroke: int | None = None,
    from_pen: int | None = None,
    progress: Callable[[PaintProgress], object] | None = None,
    ask: Callable[[str], object] | None = None,
    **options: Any,
) -> PaintResult:
    """Let a machine paint a painting, and return once it is done.

    painting: the path of a painting.json or an SVG, beside which a journal is kept, or for the simulated easel a
    `Painting`.
    robot: the spec of a machine, as in ``sim`` or ``grbl:/dev/ttyUSB0``, or a `Robot` of your own.
    resume: go on where the journal ends; unfinished: whether the stroke that was under the brush then is painted.
    restart: start again on a new sheet.  from_stroke: the first stroke, counted from 1.  from_pen: the first time that
    a pen is put in, counted from 1. Strokes before count as painted.
    progress: called before each stroke, visit to the tray and question, and at the end.  ask: called with what a person
    has to do, and returns once it is done; by default a question on the terminal.
    options: fields of `PaintOptions`, lengths in metres: easel, tray, speed, replan, camera, picture, view, tag,
    colours, pen, pause_at, refill_after, refill_at, copies; and drawing, the `DrawingOptions` by which an SVG is read,
    as in ``drawing={"hatch": "1mm"}``.

    Raises InputError before anything moves, where the painting does not fit the machine, or options do not go
    together, and on the way where there is no terminal to ask on; MachineError where the machine fails, StoppedError
    and KeyboardInterrupt where it was stopped, by Ctrl-C, a kill or a closed terminal; its pen is then lifted.

        >>> paint(painting, robot="sim").photograph.mode
        'RGB'
    """
    asked = _options(robot, options)
    if unfinished is not None and not resume:
        raise InputError("unfinished is about the stroke that an earlier run began; it goes with resume")
    with ExitStack() as stack:
        if isinstance(painting, Painting):
            if not asked.simulated:
                if isinstance(robot, str):
                    check_spec(robot)
                raise InputError("a machine keeps a journal beside the painting; save the painting, and give its path")
            if resume:
                raise InputError(
                    "what was begun is in the journal beside a painting's file; give the path of that file"
                )
            file = Path(stack.enter_context(TemporaryDirectory())) / "painting.json"
            write_painting(painting, file)
        else:
            file = Path(painting)
        own = robot if isinstance(robot, Robot) else None
        request = PaintRequest(file, asked, from_stroke, resume, restart, own, from_pen)
        photographs: list[Pillow.Image] = []

        def operator_for(setup: PaintSetup, painted: Collection[int]) -> Operator:
            return _Callbacks(setup.robot, progress, ask or _ask_on_the_terminal, photographs)

        def is_painted(number: int) -> bool:
            if unfinished is None:
                told = f"say whether it is on the paper with {option('unfinished')}"
                raise InputError(f"stroke {number} was under the brush when the run ended; {told}")
            return unfinished

        try:
            session.paint(request, is_painted, operator_for)
        except MaulstickError as error:
            if isinstance(painting, Painting):  # the caller knows of no file
                raise error.replaced(str(file), "the painting") from error
            raise
        status = status_of(file)
    assert status is not None  # the run has written a journal
    return PaintResult(status.strokes, status.painted, photographs[-1] if photographs else None)


def _options(robot: str | Robot, options: dict[str, Any]) -> PaintOptions:
    spec = f"own:{type(robot).__name__}" if isinstance(robot, Robot) else robot
    if of_svg := sorted({*options} & {*DrawingOptions.model_fields}):
        told = f'give it as drawing={{"{of_svg[0]}": {options[of_svg[0]]!r}}}'
        raise InputError(f"{of_svg[0]} is about how an SVG is read; {told}")
    check_names(options, _NAMES)
    if isinstance(drawing := options.get("drawing"), Mapping):
        check_names(drawing, DrawingOptions.model_fields)
    try:
        asked = PaintOptions.model_validate({"robot": spec, **options})
    except ValidationError as error:
        raise InputError(validation_fault(error)) from error
    asked.check()
    return asked


def _ask_on_the_terminal(message: str) -> None:
    try:
        input(f"{message}, and press Enter: ")
    except EOFError as error:
        raise InputError(f"nobody is there to {message}; run it in a terminal, or give ask") from error


@final
class _Callbacks(Operator):
    """An operator who is told and asked by functions. Ctrl-C, a kill and a closed terminal stop the machine."""

    def __init__(
        self,
        robot: Robot,
        progress: Callable[[PaintProgress], object] | None,
        ask: Callable[[str], object],
        photographs: list[Pillow.Image],
    ) -> None:
        super().__init__(robot)
        self._progress, self._ask, self._photographs = progress, ask, photographs

    def expect(self, estimate: Estimate) -> None:
        """As in `Operator`; the caller can ask `maulstick paint --dry-run`."""

    @contextmanager
    def on_duty(self) -> Iterator[None]:
        """As in `Operator`."""
        if self.stopped:
            raise StoppedError
        if threading.current_thread() is not threading.main_thread():  # only there can signals be heard
            yield
            return
        with self.stopped_by_signals():
            yield

    def watch(self, progress: PaintProgress) -> None:
        """As in `Operator`."""
        if self._progress is not None:
            self._progress(progress)

    def ask(self, action: Prompt) -> None:
        """As in `Operator`."""
        with self.interruptible():
            self._ask(action.told(PYTHON))

    def note(self, sentence: str) -> None:
        """As in `Operator`."""
        warn(sentence)

    def show(self, photograph: Path) -> None:
        """As in `Operator`."""

    def expect_plan(self, painting: Painting) -> None:
        """As in `Operator`."""

    def leave(self, photograph: Path) -> None:
        """As in `Operator`."""
        with Pillow.open(photograph) as image:
            self._photographs.append(image.convert("RGB"))

    def wants_a_look(self) -> bool:
        """As in `Operator`."""
        return False
