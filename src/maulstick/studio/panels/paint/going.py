"""Progress of a machine: its sheet next to the plan, what it does and needs, and buttons to control it."""

from math import ceil
from pathlib import Path

from nicegui import background_tasks, html, ui

from maulstick.errors import MaulstickError
from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paintable import is_svg
from maulstick.storage.text import counted
from maulstick.studio.panels.paint.turns import TurnList
from maulstick.studio.state.run import State
from maulstick.studio.state.studio import Studio
from maulstick.studio.wording import machine_name
from maulstick.studio.workers.messages import PAINTING
from maulstick.studio.workers.plan_pictures import plan_picture, rehearsed_sheet
from maulstick.studio.workers.planned_paints import PlannedPaint


class Controls:
    """Controls while a machine paints: progress, the next paint, its request, and pause."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._run = studio, studio.run
        self._paints: tuple[str, tuple[PlannedPaint, ...]] = ("", ())
        self._question_number: int | None = None
        self.root = html.section().classes("sheet going")
        with self.root:
            with html.h2():
                self._title = ui.label()
            with ui.element().classes("question").props('role="alert"') as self._question:
                self._message = ui.label().classes("message")
                self._answer = ui.element()
            with ui.element().classes("question").props('role="alert"') as self._silent:
                ui.label("The machine does not answer. Use its own emergency switch.").classes("message")
                ui.button("Stop waiting for it", icon="close", on_click=self._run.give_up).props("size=lg outline")
            self._doing = ui.label().classes("now").props('role="status"')
            self._bar = ui.linear_progress(0, show_value=False, size="1rem").props("rounded aria-label='Painted'")
            self._metrics = ui.label().classes("figure")
            with ui.element().classes("line next") as self._next:
                self._swatch = html.span().classes("dab").props("aria-hidden=true")
                self._next_paint = ui.label()
            with ui.element().classes("line"):
                self._pause = ui.button("Pause", icon="pause", on_click=self._run.pause).props("outline")
                self._on = ui.button("Go on", icon="play_arrow", on_click=self._run.go_on)
                self._look = ui.button("Look and plan again", icon="photo_camera", on_click=self._run.replan_now)
                self._look.props("outline")

    def show(self) -> None:
        """Show the state of the run."""
        state, progress = self._run.state, self._run.state.progress
        if not state.is_on:
            self._show_answer(None)
            self._paints = ("", ())  # another drawing may have that name when the next one is painted
            return
        self._title.text = f"{self._run.title} · {machine_name(state.options.machine)}"
        self._question.visible, self._message.text = bool(state.question), f"Please {state.question}."
        self._show_answer(state.question_number if state.question else None)
        self._silent.visible = state.silent
        self._doing.text = _doing(state)
        self._bar.value = 0.0 if progress is None else progress.drawn / (progress.metres or 1.0)
        self._metrics.text = _metrics(state)
        paints = state.phase == "painting"
        self._pause.visible, self._on.visible = not state.held, state.held
        self._pause.enabled = self._on.enabled = paints
        self._look.visible = bool(state.options.look or state.options.replan)
        is_drawing = progress is not None and progress.doing == PAINTING
        self._look.enabled = paints and is_drawing and not state.will_look and not state.held
        self._show_next(None if progress is None else progress.next_paint)
        if self._paints[0] != state.plan:
            self._paints = (state.plan, ())
            background_tasks.create(self._learn_paints(state.plan), context=self.root)

    def _show_answer(self, question: int | None) -> None:
        """Make a new button for each request, so that a late click for an earlier one does not answer this one."""
        if question == self._question_number:
            return
        self._question_number = question
        self._answer.clear()
        if question is not None:
            with self._answer:
                done = ui.button("Done", icon="check", on_click=lambda: self._run.done(question))
                done.props("size=lg").classes("done")

    def _show_next(self, index: int | None) -> None:
        paint = next((paint for paint in self._paints[1] if paint.number - 1 == index), None)
        self._next.visible = paint is not None
        if paint is not None:
            self._swatch.style(f"background: {paint.hex}")
            well = "" if paint.well is None else ", in its well"
            self._next_paint.text = f"Next: {paint.display_name}{well}"

    async def _learn_paints(self, plan: str) -> None:
        try:
            self._paints = (plan, await self._studio.mixing.paints(plan))
        except MaulstickError:
            return  # it is painted all the same


class Sheets:
    """Pictures of the plan or drawing and of its sheet as last seen, and the outcome of a check or a run."""

    def __init__(self, studio: Studio) -> None:
        self._run, self._folder = studio.run, studio.folder
        self._outcome = ui.label().classes("outcome").props('role="status"')
        self._turns = TurnList()
        with ui.element().classes("pair") as self._pair:
            with html.figure():
                self._plan = html.img().props('alt="What is painted"').classes("picture")
                with html.figcaption():
                    self._caption = ui.label()
            with html.figure():
                self._sheet = html.img().props('alt="The sheet as it was last seen"').classes("picture")
                self._bare = ui.label().classes("bare picture")
                html.figcaption("The sheet")
        with ui.element().classes("notes") as self._notes:
            html.h2("Notes")
            self._list = html.ul()
        self._noted: tuple[str, ...] = ()
        self._past: State | None = None
        self._shown = ""

    def forget_outcome(self) -> None:
        """Hide the outcome: the form has changed since."""
        self._past = self._run.state
        self._show_outcome()

    def show(self, plan: str) -> None:
        """Show the plan or the drawing of that name, and the last picture of its sheet."""
        state, self._shown = self._run.state, plan
        self._show_outcome()
        self._pair.visible = bool(plan)
        if plan:
            painting = self._folder.painting(plan)
            self._caption.text = "The drawing" if is_svg(painting) else "The plan"
            self._show_at(self._plan, self._address(plan_picture(painting)))
            source = f"/seen/{state.seen}.jpg" if plan == state.plan and state.photograph else self._left_of(plan)
            self._sheet.visible, self._bare.visible = bool(source), not source
            if source:
                self._show_at(self._sheet, source)
            self._bare.text = _why_bare(state)
        if self._noted != state.notes:
            self._noted = state.notes
            self._list.clear()
            with self._list:
                for note in state.notes:
                    html.li(note)
        self._notes.visible = bool(state.notes)

    def _show_outcome(self) -> None:
        state = self._run.state
        is_told = state.plan == self._shown or self._run.title in state.sentence  # what it is of
        of = "" if is_told else f"{self._run.title}: "
        outcome = _outcome(state, self._run.title, of)
        self._outcome.text = "" if state is self._past and not self._run.is_busy else outcome
        self._outcome.visible = bool(self._outcome.text)
        is_checked = self._outcome.text and state.progress is None and not of
        self._turns.show(state.estimate if state.is_on or is_checked else None)
        self._outcome.classes(add="fault" if state.fault else "", remove="" if state.fault else "fault")

    def _left_of(self, plan: str) -> str:
        """Return the address of the picture of the sheet after an earlier run; "" where there is none, or one is on."""
        path = rehearsed_sheet(self._folder.painting(plan))
        return "" if self._run.state.is_on or not path.is_file() else self._address(path)

    def _address(self, path: Path) -> str:
        """Return the address of a picture, another one each time it was written."""
        shown = path.relative_to(self._folder.root).as_posix()
        return f"/picture/{shown}?{path.stat().st_mtime_ns if path.is_file() else ''}"

    def _show_at(self, picture: html.img, source: str) -> None:
        if picture.props.get("src") != source:
            picture.props["src"] = source
            picture.update()


def _doing(state: State) -> str:
    progress = state.progress
    if state.phase == "stopping":
        return "Stopping, and lifting the pen …"
    if state.phase == "starting":
        return "Getting ready …"
    if state.question:
        return "It waits for you."
    if progress is None:
        return "Connected."
    if state.held:
        return f"Paused at stroke {progress.stroke}."
    if progress.doing != PAINTING:
        return f"{progress.doing.capitalize()} …"
    of = "" if progress.strokes is None else f" of {progress.strokes}"
    return f"Stroke {progress.stroke}{of}{_sheet(state)}{'; then it looks' if state.will_look else ''}"


def _sheet(state: State) -> str:
    """Return which of several sheets is painted, "" where there is one."""
    sheets = state.options.sheets
    return (
        "" if sheets == 1 or state.estimate is None else f" on sheet {sheets - state.estimate.more_sheets} of {sheets}"
    )


def _metrics(state: State) -> str:
    if (progress := state.progress) is None:
        return "" if state.estimate is None else _summary(state.estimate)
    if progress.metres < 1:
        return f"{1e3 * progress.drawn:.0f} of {_length(progress.metres)} · {_left(progress.left)}"
    return f"{progress.drawn:.1f} m of {_length(progress.metres)} · {_left(progress.left)}"


def _length(metres: float) -> str:
    return f"{1e3 * metres:.0f} mm" if metres < 1 else f"{metres:.1f} m"


def _left(seconds: float) -> str:
    return f"about {ceil(seconds / 60)} min left" if seconds > 90 else f"{ceil(seconds)} s left"


def _outcome(state: State, title: str, of: str) -> str:
    """Return the outcome of a check or a run, after `of` where it has ended; "" where there is none."""
    if state.phase == "checking":
        return f"Checking whether {title} can be painted …"
    if state.phase != "ended":
        return ""
    if state.estimate is not None and state.estimate.strokes and state.progress is None and not state.fault:
        return f"{of}{state.sentence} {_summary(state.estimate)}"
    return of + (state.sentence[:1].upper() + state.sentence[1:] if state.fault else state.sentence)


def _summary(estimate: Estimate) -> str:
    paints, strokes = counted(estimate.paints, "paint"), counted(estimate.strokes, "stroke")
    time = f"about {max(1, ceil(estimate.seconds / 60))} min"
    more = estimate.more_sheets
    then = "" if not more else "; then another sheet" if more == 1 else f"; then {more} other sheets"
    return f"{strokes}, {_length(estimate.metres)}, {paints}, {time}{then}."


def _why_bare(state: State) -> str:
    if state.is_on and not (state.options.simulated or state.options.look or state.options.replan):
        return "Nobody looks: there is no camera"
    return "There is no picture of the sheet yet"
