"""Cards of all plans: large ones of what is planned, of the newest and of those opened, small ones of the rest."""

from collections.abc import Callable

from nicegui import app, html, ui

from maulstick.studio.panels.plan.card import PlanCard, outcome
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import label_of
from maulstick.studio.state.weighing import weights_of
from maulstick.studio.widgets.showing import focus, shown_by
from maulstick.studio.workers.planner import order_frame

_OPENED = "plans-opened"  # key of what a page remembers while it is open


class PlanCards:
    """Cards, the newest first; a card stays in place while others come and go.

    again: called with a plan that is to be planned again.
    """

    def __init__(self, studio: Studio, again: Callable[[Plan], object]) -> None:
        self._studio, self._again = studio, again
        self._opened: dict[str, bool] = app.storage.client.setdefault(_OPENED, {})  # by name; False: made small
        self._large: dict[str, PlanCard] = {}
        self._small: dict[str, _SmallCard] = {}
        self._nothing = html.p("Nothing is planned yet. Your plans will stand here side by side.").classes("hint")
        self._grid = ui.element().classes("plans")
        with self._grid:
            self._shelf = ui.element().classes("small-plans")
        shown_by(self._grid, studio.plans.changed, self._show)

    def _show(self) -> None:
        with self._grid:  # the card that was clicked may be gone
            self._refresh()

    def _refresh(self) -> None:
        plans, titles = self._studio.plans.plans, self._studio.plans.titles()
        self._nothing.visible = not plans
        newest = next(reversed(plans), "")
        for cards in (self._large, self._small):
            for name in [name for name in cards if cards[name].plan is not plans.get(name)]:
                cards.pop(name).delete()
        for name, plan in plans.items():
            if plan.is_busy:
                self._opened[name] = True  # and stays so once it is planned, before a person's eyes
            if self._opened.get(name, name == newest):
                self._show_large(plan)
            else:
                self._show_small(plan, titles.get(name, name))

    def _show_large(self, plan: Plan) -> None:
        if plan.name in self._small:
            self._small.pop(plan.name).delete()
        if plan.name not in self._large:
            self._large[plan.name] = PlanCard(self._studio, plan, self._again, self._fold, self._reweigh)
            self._large[plan.name].come_first()
        self._large[plan.name].show()

    def _show_small(self, plan: Plan, title: str) -> None:
        if plan.name in self._large:
            self._large.pop(plan.name).delete()
        if plan.name not in self._small:
            with self._shelf:
                self._small[plan.name] = _SmallCard(plan, self._open)
            self._small[plan.name].come_first()
        self._small[plan.name].show(title)

    def _open(self, plan: Plan) -> None:
        self._opened[plan.name] = True
        self._show()
        self._large[plan.name].focus()

    def _fold(self, plan: Plan) -> None:
        self._opened[plan.name] = False
        self._show()
        self._small[plan.name].focus()

    async def _reweigh(self, plan: Plan, weights: dict[str, float]) -> Plan:
        """Make a version in which other things matter, and let its sliders take over from those of the plan."""
        self._opened[plan.name] = True  # to be compared with
        before = weights_of(plan.request)
        version = await self._studio.version_of(plan.name, weights=weights)
        if (card := self._large.get(version.name)) is not None:  # or the person looks at another panel by now
            card.weights.open_at(next(name for name in weights if weights[name] != before[name]))
        return version


class _SmallCard:
    """Button with a thumbnail, the title and the outcome of a plan, which opens its card."""

    def __init__(self, plan: Plan, open_card: Callable[[Plan], None]) -> None:
        self.plan = plan
        self._card = html.button().classes("small-plan").props("type=button")
        self._card.on("click", lambda: open_card(plan))
        with self._card:
            self._picture = html.img(alt="").props("loading=lazy")
            self._title = ui.label().classes("title")
            self._outcome = ui.label().classes("hint figure")

    def delete(self) -> None:
        """Remove the card from the page."""
        self._card.delete()

    def come_first(self) -> None:
        """Move the card before all others."""
        self._card.move(target_index=0)

    def focus(self) -> None:
        """Give a new card the focus."""
        focus(self._card)

    def show(self, title: str) -> None:
        """Show the present state of the plan under this title."""
        plan, label = self.plan, label_of(self.plan.folder)
        self._picture.visible = plan.is_painting
        if plan.is_painting:
            frames = plan.frames  # the last of them shows all strokes, in a small file
            file = f"order/{order_frame(plan.folder, frames - 1).name}" if frames else "preview.png"
            self._picture.props["src"] = f"/picture/plans/{plan.name}/{file}?{plan.planned}"
        self._title.text = f"★ {title}" if label.starred else title
        self._outcome.text = label.note or outcome(plan) or plan.phase.value
        self._card.props["aria-label"] = f"Open {title}"
