"""Panel where a machine paints: its options, the start, and the progress."""

from collections.abc import Callable, Mapping
from pathlib import Path

from nicegui import background_tasks, events, html, ui

from maulstick.errors import InputError, MaulstickError
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.status import PaintStatus
from maulstick.jobs.paintable import is_svg
from maulstick.storage.text import counted
from maulstick.studio.panels.paint.by_hand import ByHandForm
from maulstick.studio.panels.paint.corners import CornersForm
from maulstick.studio.panels.paint.drawings import Drawings
from maulstick.studio.panels.paint.form import SHORT_MENU, USUAL_MACHINE, OptionsForm
from maulstick.studio.panels.paint.going import Controls, Sheets
from maulstick.studio.panels.paint.reading import ReadingForm
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.uploading import incoming, upload_button
from maulstick.studio.wording import DETAILS_LABEL, RESTART_LABEL, error_text, machine_name
from maulstick.studio.workers.planned_paints import PlannedPaint

_STYLE = Path(__file__).with_name("paint.css")
_REHEARSED = " So far on the simulated easel: nothing of it is on paper."


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: `plan` is chosen first."""
    ui.add_css(_STYLE)
    html.h1("Let a machine paint")
    html.p(
        "Choose a plan or a drawing, and a machine; check, and start. STOP or the Esc key lifts the pen at once."
    ).classes("hint")
    with ui.element().classes("desk paint") as desk:
        with ui.element().classes("side"):
            setting = _Setting(studio, query.get("plan", ""), desk)
            controls = Controls(studio)
        with ui.element().classes("wide"):
            sheets = Sheets(studio)
            drawings = Drawings(studio, setting.choose)

    def show() -> None:
        state = studio.run.state
        setting.root.visible, controls.root.visible = not state.is_on, state.is_on
        setting.show()
        controls.show()
        plan = state.plan if state.is_on else setting.plan
        sheets.show(plan)
        drawings.show(plan)

    setting.on_choice, setting.on_touch = show, sheets.forget_outcome
    shown_by(setting.root, studio.run.changed, show)
    shown_by(setting.root, studio.svgs.changed, show)
    shown_by(setting.root, studio.plans.changed, show)


class _Setting:
    """Choice of the plan or the drawing and of the machine, and the buttons that start it.

    desk: part of the page onto which a drawing can be dropped.
    on_choice: called after another plan was chosen.  on_touch: called after a person has changed anything.
    """

    def __init__(self, studio: Studio, plan: str, desk: ui.element) -> None:
        self._touches = 0  # number of changes that a person made in the form
        self._studio, self._run = studio, studio.run
        self._status: PaintStatus | None = None
        self._missing = 0  # number of paints that are not mixed yet
        self._unfilled, self._touches_before = True, 0  # touches before the plan was chosen
        self._was_busy = True
        self.on_choice: Callable[[], None] = lambda: None
        self.on_touch: Callable[[], None] = lambda: None
        self.root = html.section().classes("sheet")
        with self.root:
            html.h2("What to paint, and with what")
            self._plan = ui.select({}, label="Plan or drawing", on_change=self._choose).props(SHORT_MENU)
            self._plan.on("update:model-value", lambda: self.on_touch(), args=[])
            self._none = html.p("There is nothing to paint yet: plan a painting, or bring a drawing.").classes("hint")
            with ui.element().classes("line"):
                upload_button("Bring an SVG", ".svg,.svgz", self._bring, onto=desk, several=True)
                html.span("or drop it here").classes("hint")
            self._reading = ReadingForm(studio, self._touch)
            first = ui.element().classes("fields")
            self._begun = ui.label().classes("begun").props('role="status"')
            with html.fieldset().classes("unfinished") as self._question:
                with html.legend():
                    self._legend = ui.label()
                self._answer = ui.radio({True: "Yes, it is", False: "No, paint it again"})
                self._answer.props('aria-label="Is that stroke on the paper?"')
            with ui.element().classes("line"):
                self._check = ui.button("Check", icon="rule", on_click=self._rehearse).props("outline")
                self._start = ui.button("Start painting", icon="play_arrow", on_click=self._begin)
                self._resume = ui.button("Go on where it stopped", icon="play_arrow", on_click=self._go_on)
                self._restart = ui.button(RESTART_LABEL, icon="note_add", on_click=self._ask_for_a_new_sheet)
                self._restart.props("outline")
            self._mix = ui.link("", "/paints").classes("hint")
            later = ui.expansion(DETAILS_LABEL).classes("more")
            self._new_sheet = ui.dialog().props('aria-label="A new sheet"')
            with self._new_sheet, html.div().classes("sheet new-sheet"):
                html.h2("Start again on a new sheet?")
                html.p("The sheet so far counts as thrown away.")
                with ui.element().classes("line end"):
                    ui.button("Leave it", on_click=self._new_sheet.close).props("flat autofocus")
                    ui.button("Take a new sheet", icon="note_add", on_click=self._begin_anew)
        self._form = OptionsForm(studio, first, later, touched=self._touch)
        with later:
            self._corners = CornersForm(studio, lambda: self._form.usb_camera, lambda: self.plan, self._touch)
        with self.root:
            ByHandForm(studio, lambda: self._filled_in()[1], lambda: self.plan, self._form.take_easel)
        self._plan.set_options(self._run.plans(), value=plan if plan in self._run.plans() else None)
        shown_by(self.root, studio.plans.changed, self._offer)
        shown_by(self.root, studio.svgs.changed, self._offer)
        shown_by(self.root, studio.by_hand.changed, self._show_buttons)
        shown_by(self.root, studio.mixing.changed, self._follow)
        shown_by(self.root, studio.mixing.changed, self._form.fit)
        background_tasks.create(self._form.offer_ports(), context=self.root)

    def choose(self, name: str) -> None:
        """Choose the plan or the drawing of that name."""
        self._plan.set_options(self._run.plans(), value=name)
        self.on_touch()

    async def _bring(self, event: events.UploadEventArguments) -> None:
        async with incoming(self._studio.folder, event) as file:
            name = await self._studio.svgs.keep(file, str(event.file.name))
        if not self.root.is_deleted:
            self.choose(name)

    def _touch(self) -> None:
        self._touches += 1
        self._show_buttons()
        self.on_touch()

    @property
    def plan(self) -> str:
        """Name of the chosen plan or drawing, or ""."""
        return str(self._plan.value or "")

    def show(self) -> None:
        """Show the state of the run."""
        busy = self._run.is_busy
        if self._was_busy and not busy:
            self._follow()
        self._was_busy = busy
        self._show_buttons()

    def _offer(self) -> None:
        plans = self._run.plans()
        fallback = self._run.state.plan if self._run.state.plan in plans else next(iter(plans), None)
        self._plan.set_options(plans, value=self._plan.value if self._plan.value in plans else fallback)
        self._show_buttons()

    def _choose(self) -> None:
        self._status, self._unfilled, self._touches_before = None, True, self._touches
        self._begun.text = self._mix.text = ""  # they are about what was chosen before
        self._reading.show(self.plan)
        self._form.leave_plan()
        self._follow()
        self.on_choice()

    def _follow(self) -> None:
        background_tasks.create(self._look_up(self.plan), context=self.root)

    async def _look_up(self, plan: str) -> None:
        """Find out how much of the plan is painted, and which paints are not mixed yet."""
        if not plan:
            return
        status, fault, missing, paints = None, "", list[PlannedPaint](), 0
        before = self._touches_before if self._unfilled else self._touches
        try:
            missing = await self._studio.mixing.missing(plan)
            planned = () if self._is_drawing else await self._studio.mixing.paints(plan)
            paints = sum(not paint.is_pen for paint in planned)
            status = await self._run.status(plan)
        except MaulstickError as error:
            fault = error_text(error)
        if plan != self.plan or self.root.is_deleted:
            return
        is_other = status is not None and (self._status is None or status.options != self._status.options)
        if status != self._status:
            self._answer.value = None  # the answer was about another stroke
        self._status = status
        if status is not None and is_other and self._touches == before:  # nobody has chosen anything meanwhile
            self._form.fill(status.options)
        elif status is None and self._unfilled:
            machine = self._machine_for(plan) if self._touches == before else None
            self._form.begin(machine, paints > 0)  # pens are not dipped, and a drawing is for pens
        self._unfilled = self._unfilled and bool(fault)
        self._begun.text = fault or _begun_text(status)
        self._missing = len(missing)
        self._mix.props["href"] = f"/paints?plan={plan}"
        self._show_buttons()

    def _machine_for(self, plan: str) -> str | None:
        """Return the machine that a plan is for; None where it is for none, and a person has chosen one here."""
        planned = self._studio.plans.plans.get(plan)
        machine = self._studio.settings.choices.machine if planned is None else planned.request.options.robot
        return machine or (None if self._touches else USUAL_MACHINE)

    def _show_buttons(self) -> None:
        self._mix.text = "" if self._form.is_simulated else _to_be_mixed(self._missing)
        status, there = self._begun_here, bool(self.plan)
        self._corners.show()
        goes_on = status is not None and not status.is_over
        self._none.visible, self._plan.visible = not there, there
        self._check.visible = there
        self._start.visible = there and status is None
        self._restart.visible = there and status is not None
        self._resume.visible = there and goes_on
        self._question.visible = goes_on and status is not None and status.unfinished is not None
        if status is not None and status.unfinished is not None:
            self._legend.text = f"Stroke {status.painted + 1} was under the brush when it ended. Is it on the paper?"
        self._begun.visible = bool(self._begun.text)
        self._mix.visible = bool(self._mix.text)
        for button in (self._check, self._start, self._restart, self._resume):
            button.enabled = not (self._run.is_busy or self._studio.by_hand.is_on)

    @property
    def _begun_here(self) -> PaintStatus | None:
        """Status of what the chosen machine could go on with: a rehearsal is nothing that a real one goes on with."""
        status = self._status
        return None if status is not None and status.options.simulated and not self._form.is_simulated else status

    @property
    def _is_drawing(self) -> bool:
        return bool(self.plan) and is_svg(self._studio.folder.painting(self.plan))

    def _filled_in(self) -> tuple[str, PaintOptions]:
        known = self._studio.plans.plans.get(self.plan)
        options = self._form.options(None if known is None else known.picture)
        if self._is_drawing:
            options = options.model_copy(update={"drawing": self._reading.options})
        before = None if self._status is None else self._status.options
        return self.plan, self._corners.applied(options, before)

    def _rehearse(self) -> None:
        status = self._begun_here
        over = status is not None and status.is_over
        self._run.check(*self._filled_in(), resume=status is not None and not over, restart=over)

    async def _begin(self) -> None:
        await self._run.begin(*self._filled_in())

    def _ask_for_a_new_sheet(self) -> None:
        self._filled_in()  # first, so that its errors come before the question
        self._new_sheet.open()

    async def _begin_anew(self) -> None:
        self._new_sheet.close()
        await self._run.begin(*self._filled_in(), restart=True)

    async def _go_on(self) -> None:
        answer = self._answer.value
        if self._question.visible and answer is None:
            raise InputError("say first whether the stroke is on the paper: look at the sheet")
        await self._run.resume(*self._filled_in(), answer if self._question.visible else None)


def _begun_text(status: PaintStatus | None) -> str:
    if status is None:
        return ""
    if status.is_over:
        return f"All {counted(status.strokes, 'stroke')} are painted.{_REHEARSED if status.options.simulated else ''}"
    sheets = status.options.sheets
    sheet = f" on sheet {status.sheet} of {sheets}" if sheets > 1 else ""
    done = f"{status.painted:,} of {counted(status.strokes, 'stroke')}"
    so_far = f" Machine so far: {machine_name(status.options.machine)}."
    return f"It was begun: {done} are painted{sheet}.{_REHEARSED if status.options.simulated else so_far}"


def _to_be_mixed(missing: int) -> str:
    return f"Mix {counted(missing, 'paint')} first" if missing else ""
