"""Panel where paints are mixed: the paints of a plan, their recipes, and which are mixed already."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from nicegui import background_tasks, events, html, ui

from maulstick.colour.mixing import Recipe
from maulstick.colour.srgb import light_of
from maulstick.errors import MaulstickError
from maulstick.painting.painting import hex_colour
from maulstick.storage.text import counted
from maulstick.studio.panels.paints.tray import build_tray
from maulstick.studio.panels.paints.tubes import build_tubes
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.wording import error_text
from maulstick.studio.workers.planned_paints import PlannedPaint

_STYLE = Path(__file__).with_name("paints.css")


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: the paints of `plan` are shown first."""
    ui.add_css(_STYLE)
    html.h1("Mix the paints")
    html.p(
        "Mix each colour, compare it with the swatch here, and tick it. A real machine begins once all are ticked."
    ).classes("hint")
    with ui.element().classes("desk"):
        with ui.element().classes("wide"):
            _Paints(studio, query.get("plan", ""))
        with ui.element().classes("side"):
            build_tubes(studio)
            build_tray(studio)


class _Paints:
    """Paints of the chosen plan, one card per paint; a card stays in place while others are ticked."""

    def __init__(self, studio: Studio, plan: str) -> None:
        self._studio = studio
        self._shown: tuple[object, ...] = ()
        self._ticks: list[tuple[str, ui.checkbox]] = []
        self._root = ui.element().classes("wanted")
        with self._root:
            with ui.element().classes("line"):
                self._plan = ui.select({}, label="The painting", on_change=self._show).props("outlined")
                self._all = ui.button("All are mixed", icon="done_all", on_click=self._tick_all).props("outline")
                self._count = ui.label().classes("count").props('role="status"')
                self._paint = ui.button("Paint it now", icon="precision_manufacturing", on_click=self._go_and_paint)
            self._bar = ui.linear_progress(show_value=False).props('aria-label="How many paints are mixed" rounded')
            self._nothing = ui.label().classes("hint").props('role="status"')
            with ui.element().classes("line") as self._first:
                ui.button("Plan a painting", icon="auto_awesome_mosaic", on_click=lambda: ui.navigate.to("/plan"))
            self._cards = ui.element().classes("cards")
        self._plan.set_options(studio.mixing.plans(), value=plan if plan in studio.mixing.plans() else None)
        shown_by(self._root, studio.plans.changed, self._offer)
        shown_by(self._root, studio.mixing.changed, self._show)

    def _offer(self) -> None:
        """List the plans that there are."""
        plans = self._studio.mixing.plans()
        value = self._plan.value if self._plan.value in plans else next(iter(plans), None)
        self._plan.set_options(plans, value=value)
        self._show()

    def _show(self) -> None:
        background_tasks.create(self._follow(), context=self._root)

    async def _follow(self) -> None:
        plan = self._plan.value
        if plan is None:
            self._show_nothing("No painting is planned yet. Once one is, its paints will stand here.")
            return
        if not self._shown:
            self._show_nothing("Looking at the paints …")
        try:
            paints = await self._studio.mixing.paints(plan)
            recipes = await self._studio.mixing.advice(plan)
            mixed, missing = self._studio.mixing.mixed(plan), await self._studio.mixing.missing(plan)
        except MaulstickError as error:
            if plan == self._plan.value:
                self._show_nothing(error_text(error))
            return
        if plan != self._plan.value or self._root.is_deleted:
            return
        self._show_cards(plan, paints, recipes)
        for label, tick in self._ticks:
            tick.value = label in mixed
        self._count_them(paints, len(set(missing)))

    def _show_nothing(self, why: str) -> None:
        self._shown = ()
        self._ticks.clear()
        self._cards.clear()
        self._nothing.text = why
        self._nothing.visible = True
        self._all.visible = self._bar.visible = self._paint.visible = False
        self._first.visible = self._plan.value is None
        self._plan.visible = self._plan.value is not None
        self._count.text = ""

    def _show_cards(self, plan: str, paints: tuple[PlannedPaint, ...], recipes: tuple[Recipe, ...]) -> None:
        to_show = (plan, paints, recipes, self._studio.mixing.has_tray, self._studio.mixing.has_own_tubes)
        if to_show == self._shown:
            return
        self._show_nothing("")
        self._shown, self._nothing.visible = to_show, False
        with self._cards:
            for paint, recipe in zip(paints, recipes, strict=True):
                tick = _card(self._studio, plan, paint, recipe)
                if tick is not None:
                    self._ticks.append((paint.label, tick))

    def _count_them(self, paints: tuple[PlannedPaint, ...], missing: int) -> None:
        used = len({paint.label for paint in paints if paint.strokes})
        ready = "Everything is ready to paint."
        if any(paint.is_pen for paint in paints):
            ready = f"Nothing is to be mixed: the machine asks for {'this one' if used == 1 else 'each'}."
        self._count.text = ready if not missing else f"{used - missing} of {used} are mixed."
        self._bar.visible = bool(self._ticks)
        self._bar.value = (used - missing) / max(used, 1)
        self._all.visible = missing > 0
        self._paint.visible = not missing

    def _go_and_paint(self) -> None:
        ui.navigate.to(f"/paint?plan={self._plan.value}")

    async def _tick_all(self) -> None:
        await self._studio.mixing.tick_all(self._plan.value)


def _card(studio: Studio, plan: str, paint: PlannedPaint, recipe: Recipe) -> ui.checkbox | None:
    """Build the card of a paint; return its tick, None where the machine asks for it."""
    with html.article().classes("sheet paint").props(f'aria-label="Paint {paint.number}"'):
        swatch = html.div().classes("swatch").style(f"background: {paint.hex}")
        with swatch.props(f'role="img" aria-label="The colour {paint.hex}"'):
            html.span(str(paint.number)).classes("number")
        html.h2(paint.display_name[0].upper() + paint.display_name[1:])
        html.p(f"{paint.hex} · {_usage(paint)}").classes("figure hint")
        html.p(_place(studio, paint)).classes("hint")
        if paint.is_pen:
            return None
        if paint.is_named and not studio.mixing.has_own_tubes:
            html.p("As it is in its tube.")
        else:
            _recipe(studio, paint, recipe)

        async def tick(event: events.ValueChangeEventArguments[bool | None]) -> None:
            if event.value != (paint.label in studio.mixing.mixed(plan)):  # a person did it, not `_Paints`
                await studio.mixing.tick(plan, paint.label, bool(event.value))

        return ui.checkbox("This one is mixed", on_change=tick).props("size=lg").classes("tick")


def _recipe(studio: Studio, paint: PlannedPaint, recipe: Recipe) -> None:
    tubes = {tube.name: hex_colour(tube.colour) for tube in studio.mixing.tubes()}
    with html.ul().classes("recipe"):
        for name, parts in recipe.parts:
            with html.li():
                html.span().classes("dab").style(f"background: {tubes.get(name, 'transparent')}")
                alone = len(recipe.parts) == 1
                ui.label(f"{name} alone" if alone else f"{counted(parts, 'part')} {name}")
    given = hex_colour(recipe.colour)
    with ui.element().classes("beside").props(f'role="img" aria-label="Wanted {paint.hex}, this gives {given}"'):
        for text, colour in (("wanted", paint.hex), ("this gives", given)):
            with html.div().style(f"background: {colour}; color: {legible_on(colour)}"):
                ui.label(text)
    with ui.label(_verdict(recipe)):
        ui.tooltip(f"CIEDE2000 {recipe.error:.1f}")


def _verdict(recipe: Recipe) -> str:
    match recipe.verdict:
        case "out of reach":
            return "Your tubes cannot reach it; the difference will be seen"
        case "the same to the eye":
            return "The same to the eye"
        case nearness:
            return f"{nearness.capitalize()} what is wanted"


def _usage(paint: PlannedPaint) -> str:
    if not paint.strokes:
        return "No stroke uses it; it need not be mixed."
    again = "" if paint.times == 1 else f", taken up {paint.times} times"
    return f"{paint.metres:.1f} m in {counted(paint.strokes, 'stroke')} · comes {_ordinal(paint.place)}{again}"


def _place(studio: Studio, paint: PlannedPaint) -> str:
    if paint.well is None:
        if studio.mixing.has_tray:
            return "The tray has no well for it yet; add one to the tray's file."
        return "Goes into the pen holder when the machine asks for it."
    x, y = (1000 * length for length in paint.well)
    across, down = ("right" if x >= 0 else "left"), ("below" if y >= 0 else "above")
    return f"Its well is {abs(x):.0f} mm {across} of the sheet's upper left corner and {abs(y):.0f} mm {down} it."


def _ordinal(number: int) -> str:
    ending = "th" if number % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
    return "first" if number == 1 else f"{number}{ending}"


def legible_on(colour: str) -> str:
    """Return black or white, whichever has the higher contrast on the colour, ``#rrggbb``: at least 4.58 (WCAG 2.2)."""
    red, green, blue = light_of(np.array([int(colour[place : place + 2], 16) for place in (1, 3, 5)]) / 255)
    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return "#000" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "#fff"
