"""Card of a plan: its canvas while it is planned, and its painting afterwards."""

from collections.abc import Callable
from math import ceil

from nicegui import html, ui

from maulstick.errors import InputError
from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.storage.text import counted
from maulstick.studio.panels.plan.compared import ComparedPictures
from maulstick.studio.panels.plan.exporting import ExportDialog
from maulstick.studio.panels.plan.form import DRAWN
from maulstick.studio.panels.plan.loss_curve import LossCurve
from maulstick.studio.panels.plan.note import NoteLine
from maulstick.studio.panels.plan.weights import PlanWeights, Reweigh
from maulstick.studio.state.plan import Phase, Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import checked_title, file_name
from maulstick.studio.state.versions import changes_in
from maulstick.studio.state.weighing import weights_of
from maulstick.studio.widgets.brushes import brushes_in_words, is_pen
from maulstick.studio.widgets.renaming import ask_for_title
from maulstick.studio.widgets.sheet_sizes import in_words
from maulstick.studio.widgets.showing import focus, shown_by
from maulstick.studio.widgets.slider import Slider
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.wording import planned_for
from maulstick.studio.workers.planner import order_frame

_FILES = {"painting.json": "The plan", "painting.svg": "For a plotter (SVG)", "preview.png": "A picture"}
_PHASE_CLASSES = {Phase.WAITING: "waiting", Phase.PLANNING: "planning"}


class PlanCard:
    """Card on the page that follows one plan.

    again: called with the plan where it is to be planned again.  fold: where its card is to be small.
    reweigh: where other things are to matter once it is finished.
    """

    def __init__(
        self,
        studio: Studio,
        plan: Plan,
        again: Callable[[Plan], object],
        fold: Callable[[Plan], object],
        reweigh: Reweigh,
    ) -> None:
        self.plan, self._studio, self._again = plan, studio, again
        self._card = html.article().classes("sheet plan")
        with self._card:
            with ui.element().classes("line head"):
                with html.h2():
                    self._title = ui.label()
                self._phase = ui.label().classes("phase").props('role="status"')
                self._fold = ui.button(icon="unfold_less", on_click=lambda: fold(plan)).props("flat round dense")
                self._fold.tooltip("Make this card small")
            self._note = NoteLine(studio, plan)
            self._pictures = ComparedPictures(studio, plan)
            self._until = Slider("Stroke by stroke", 1, 1, 1, self._show_order, live=True)
            self._bar = ui.linear_progress(0, show_value=False).props('instant-feedback aria-label="How far it is"')
            if plan.request.options.text:
                ui.label(_words(plan.request)).classes("hint words")
            ui.label(_summary(plan.request, studio.styles.title(plan.request.options.style))).classes("hint")
            self._changes = ui.label().classes("hint changes")
            self._figures = ui.label().classes("hint figure")
            self._notes = html.ul().classes("hint notes").props('aria-label="Notes"')
            self._curve = LossCurve()
            self.weights = PlanWeights(studio, plan, reweigh)
            with ui.element().classes("line"):
                self._buttons()
        self._frames = 0
        self._noted: tuple[str, ...] = ()
        self._told_weights: dict[str, float] | None = None
        shown_by(self._card, plan.stepped, self.show)

    def delete(self) -> None:
        """Remove the card from the page."""
        self._card.delete()

    def come_first(self) -> None:
        """Move the card before all others."""
        self._card.move(target_index=0)

    def focus(self) -> None:
        """Give the focus to the first button of a new card, which moves it into sight."""
        focus(self._fold)

    def show(self) -> None:
        """Show the present state of the plan."""
        plan = self.plan
        finished = plan.is_painting and not plan.is_busy
        self._show_title()
        self._note.show()
        self._fold.visible = not plan.is_busy
        self._phase.set_text(plan.phase.value)
        self._card.classes(remove="planning waiting", add=_PHASE_CLASSES.get(plan.phase))
        self._bar.set_value(plan.done)
        self._bar.visible = plan.is_busy
        self._figures.set_text(outcome(plan))
        self._show_changes()
        self._show_notes()
        self._curve.show(plan.curve)
        self.weights.visible = finished or plan.can_be_weighed
        self.weights.follow()
        if finished and self._frames != plan.frames:
            self._frames = plan.frames
            self._until.set(self._frames - 1, most=self._frames - 1)
        self._until.element.visible = finished and self._frames > 1
        self._show_canvas(finished)
        self._stop.set_text("Do not plan it" if plan.phase is Phase.WAITING else "Stop and keep")
        self._on.set_text("Try again" if plan.phase is Phase.FAILED else "Go on")
        self._stop.visible = plan.phase in (Phase.WAITING, Phase.PLANNING)
        self._on.visible = plan.phase in (Phase.STOPPED, Phase.FAILED)
        self._mix.visible = self._files.visible = self._direct.visible = finished
        self._away.visible = not plan.is_busy

    def _buttons(self) -> None:
        plan, plans = self.plan, self._studio.plans
        self._stop = ui.button("Stop and keep", icon="back_hand", on_click=lambda: plans.stop(plan))
        self._on = ui.button("Go on", icon="play_arrow", on_click=lambda: plans.go_on(plan)).props("outline")
        self._mix = _paint_button(plan)
        to_canvas = f"/plan/{plan.name}"
        self._direct = ui.button("Direct it", icon="gesture", on_click=lambda: ui.navigate.to(to_canvas))
        self._direct.props("outline").tooltip("Choose strokes on a large canvas: lock, take out, move or add some")
        self._files = ui.dropdown_button("Files", icon="download", auto_close=True).props("outline")
        with self._files:
            for file, label in _FILES.items():
                ui.item(label).props(f'href="/file/plans/{plan.name}/{file}" download=""')
            ui.item("Save as …", on_click=self._save_as)
        self._more = ui.button("Plan again like this", icon="replay", on_click=lambda: self._again(plan))
        self._more.props("outline").tooltip("Fill the form with the picture and the settings of this plan")
        self._rename = ui.button(icon="edit", on_click=self._ask_for_title).props("flat").tooltip("Rename")
        self._away = ui.button(icon="delete", on_click=self._throw_away).props("flat").tooltip("Throw away")

    def _show_changes(self) -> None:
        """Show what differs from the plan that this is a version of, once more where the weights have changed."""
        weights = weights_of(self.plan.request)
        if weights != self._told_weights:
            self._told_weights = weights
            self._changes.set_text(changes_in(self.plan.folder, weights))
            self._changes.visible = bool(self._changes.text)

    def _show_title(self) -> None:
        title = self._studio.plans.titles().get(self.plan.name, self.plan.name)
        if title == self._title.text:
            return
        self._title.set_text(title)
        for element, name, text in (
            (self._card, "aria-label", f"Plan {title}"),
            (self._pictures.canvas, "alt", f"The strokes of {title}"),
            (self._fold, "aria-label", f"Make the card of {title} small"),
            (self._rename, "aria-label", f"Rename {title}"),
            (self._away, "aria-label", f"Throw {title} away"),
        ):
            element.props[name] = text

    def _ask_for_title(self) -> None:
        plans = self._studio.plans
        ask_for_title(self.plan.title, lambda typed: plans.relabel(self.plan, title=checked_title(typed)))

    def _save_as(self) -> None:
        with self._card:
            ExportDialog(self._studio.desk, self.plan.folder / "painting.json", file_name(self.plan.title, ""))

    def _show_notes(self) -> None:
        self._notes.visible = bool(self.plan.notes)
        if self._noted != self.plan.notes:
            self._noted = self.plan.notes
            self._notes.clear()
            with self._notes:
                for note in self._noted:
                    html.li(note)

    def _show_canvas(self, finished: bool) -> None:
        plan = self.plan
        if finished:
            self._show_order()
        else:
            self._pictures.show(f"/live/{plan.name}/{plan.seen}" if plan.canvas else "")

    def _show_order(self) -> None:
        """Show the first strokes, as many as the slider says."""
        until, plan = int(self._until.value), self.plan
        if plan.is_busy:
            return
        whole = until >= self._frames - 1
        file = "preview.png" if whole else f"order/{order_frame(plan.folder, until).name}"
        self._pictures.show(f"/picture/plans/{plan.name}/{file}?{plan.planned}")

    def _throw_away(self) -> None:
        plans, title, client = self._studio.plans, self._title.text, ui.context.client
        if self._studio.run.state.is_on and self._studio.run.state.plan == self.plan.name:
            raise InputError(f"{title} is being painted; stop the machine first")
        trashed = plans.throw_away(self.plan)
        offer_undo(client, f"{title} is in the trash", lambda: plans.take_back(trashed))


def _paint_button(plan: Plan) -> ui.button:
    """Make the button that leads on, to the paints where there are some to be mixed."""
    options = plan.request.options
    if options.ink is not None or options.mixed_paints == 1:  # the machine asks for each ink, or the only paint
        to_paint = f"/paint?plan={plan.name}"
        return ui.button("Paint it", icon="precision_manufacturing", on_click=lambda: ui.navigate.to(to_paint))
    return ui.button("Mix and paint", icon="palette", on_click=lambda: ui.navigate.to(f"/paints?plan={plan.name}"))


def _words(request: PlanRequest) -> str:
    """Return what a plan was asked for in words, and whether a picture counts beside them."""
    return f"“{request.options.text}”" + ("" if request.picture is None else ", beside the picture")


def _summary(request: PlanRequest, style: str) -> str:
    """Return the main options of a plan in one line, and others where they are not the usual ones.

    style: title of its hand.
    """
    options, usual = request.options, PlanOptions()
    mixed = options.mixed_paints
    hand = f"{style} at {options.hand_size:g} times its size" if options.hand_size != 1 else style
    strokes = "as many strokes as it needs" if options.strokes == AUTO else counted(options.strokes, "stroke")
    if options.inks:
        colours = "one ink" if len(options.inks) == 1 else f"{len(options.inks)} inks"
    elif mixed is None:
        colours = "the paints of your tubes"
    else:
        colours = _only(options.brush) if mixed == 1 else f"{mixed} paints"
    parts = [hand, brushes_in_words(options.brush), strokes, colours, in_words(options.size)]
    if options.drawing != usual.drawing:
        parts.append(DRAWN[options.drawing].lower())
    if options.arrange != usual.arrange:
        parts.append(f"{options.arrange:.0%} as the hand arranges")
    if request.tries > 1:
        parts.append(f"the best of {request.tries} tries")
    if options.robot is not None:
        parts.append(f"for {planned_for(options.robot)}")
    return ", ".join(parts)


def _only(brush: str) -> str:
    """Return what the only colour of a plan is: a pen's is in the pen."""
    return "1 pen" if is_pen(brush) else "1 paint"


def outcome(plan: Plan) -> str:
    """Return how far the plan is, why it failed, or the metrics of its painting."""
    if plan.phase is Phase.FAILED:
        return plan.why
    if plan.is_busy:
        left = "" if plan.left is None or plan.phase is not Phase.PLANNING else f", about {_time(plan.left)} left"
        of = f", try {plan.attempt} of {plan.request.tries}" if plan.request.tries > 1 else ""
        return f"{plan.done:.0%}{of}{left}" if plan.curve else "looking at it …" if plan.phase is Phase.PLANNING else ""
    return ", ".join(plan.metrics)


def _time(seconds: float) -> str:
    return f"{ceil(seconds)} s" if seconds < 90 else f"{ceil(seconds / 60)} min"
