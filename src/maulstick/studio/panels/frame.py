"""Frame of the page: links to the panels, what is going on, and the button that stops the machine."""

import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from nicegui import PageArguments, html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.panels.bell import bell
from maulstick.studio.panels.tab_title import TabTitle
from maulstick.studio.panels.tablet import Door, tablet_button
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.wording import error_text

_PANELS = {
    "/": ("Draw", "draw", "maulstick.studio.panels.draw.draw"),
    "/styles": ("Styles", "brush", "maulstick.studio.panels.styles.styles"),
    "/plan": ("Plan", "auto_awesome_mosaic", "maulstick.studio.panels.plan.plan"),
    "/paints": ("Mix", "palette", "maulstick.studio.panels.paints.paints"),
    "/paint": ("Paint", "precision_manufacturing", "maulstick.studio.panels.paint.paint"),
    "/survey": ("Survey", "how_to_vote", "maulstick.studio.panels.survey.survey"),
}
"""Panels by path: name, icon, and module, whose `build` is called with the studio and the query of the link."""

_DIRECT = "/plan/{name}"
"""Path of the canvas on which a plan is directed, whose `build` is called with its name; it is part of Plan."""

_DIRECTING = "maulstick.studio.panels.direct.direct"
_TRASH = "/trash"
_PAGES = {**_PANELS, _TRASH: ("Trash", "delete_outline", "maulstick.studio.panels.trash.trash")}
"""Panels, and what is no step on the way to a painting."""

# Esc closes an open dialog or menu first; where none is open it stops the machine. The button always stops it.
# A request of its own works while the websocket is busy, and the websocket where no new connection can be had.
# What was pressed before, and waits for the websocket to be mended, would start a machine after it was stopped.
_STOP = """<script>
  let doubt, word;
  function stopMachine() {
    forgetWaiting();
    clearTimeout(doubt);
    doubt = setTimeout(() => { document.querySelector(".silent").hidden = false; }, 3000);
    const bySocket = () => emitEvent("stop");
    fetch("/stop", { method: "POST" })
      .then((answer) => (answer.ok ? answer.text().then(stopHeard) : bySocket()), bySocket);
  }
  function stopHeard(said) {
    clearTimeout(doubt);
    clearTimeout(word);
    document.querySelector(".silent").hidden = true;
    document.querySelector(".heard").textContent = said;
    word = setTimeout(() => { document.querySelector(".heard").textContent = ""; }, 6000);
  }
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !document.querySelector(".q-dialog, .q-menu")) stopMachine();
  }, { capture: true });
</script>"""

_STYLE = Path(__file__).with_name("studio.css")
_IN_ORDER = Path(__file__).with_name("in_order.js").read_text()


class _Panels(ui.sub_pages):
    """Panels by path; any other path is said to lead nowhere. lost: called then."""

    def __init__(self, panels: dict[str, Callable[[PageArguments], None]], lost: Callable[[], None]) -> None:
        self._lost = lost
        super().__init__(panels)

    def _render_404(self) -> None:
        self._lost()
        html.h1("There is no such page")
        html.p("Its address may be incomplete, or what it showed is gone.").classes("hint")
        ui.button("Go to the beginning", icon="arrow_back", on_click=lambda: ui.navigate.to("/")).props("outline")


def page(studio: Studio, door: Door) -> None:
    """Build the page. door: the way in for other machines."""
    ui.on_exception(_tell)
    ui.add_css(_STYLE)
    ui.add_head_html(f"<script>{_IN_ORDER}</script>")
    ui.colors(primary="#8c3d26", secondary="#5b6770", accent="#2f6690", negative="#b3261e", positive="#3c7a3f")
    with ui.header().classes("frame"):
        ui.label("Maulstick").classes("name")
        links = _links()
        _doing(studio)
        bell(studio)
        tablet_button(studio, door)
        _stop(studio)
    with ui.element().classes("panel"):
        title = TabTitle(studio)

        def mark(path: str) -> None:
            for other, link in links.items():
                link.props(remove="aria-current")
                if other == path:
                    link.props('aria-current="page"')
            title.turn_to(_PAGES[path][0] if path in _PAGES else "No such page")

        def direct(arguments: PageArguments) -> None:
            mark("/plan")
            import_module(_DIRECTING).build(studio, arguments.path_parameters["name"])

        panels = {path: _built(path, studio, mark) for path in _PAGES}
        _Panels({**panels, _DIRECT: direct}, lost=lambda: mark(""))


def _links() -> dict[str, ui.link]:
    links = {}
    with ui.element("nav").props('aria-label="Panels"').classes("panels"):
        for path, (name, icon, _) in _PAGES.items():
            with ui.link(target=path).classes("panel-link") as links[path]:
                ui.icon(icon).props("aria-hidden=true")
                ui.label(name)
    links[_TRASH].classes("aside")
    return links


def _built(path: str, studio: Studio, mark: Callable[[str], None]) -> Callable[[PageArguments], None]:
    def build(arguments: PageArguments) -> None:
        mark(path)
        _, _, module = _PAGES[path]
        import_module(module).build(studio, arguments.query_parameters)

    return build


def _doing(studio: Studio) -> None:
    """Show a line that says what is being planned and painted."""
    line = ui.label().classes("doing").props('role="status"')

    def say() -> None:
        doing = [each for each in (studio.plans.doing, studio.run.doing, studio.by_hand.doing) if each]
        line.set_text(" · ".join(doing))

    shown_by(line, studio.plans.changed, say)
    shown_by(line, studio.run.changed, say)
    shown_by(line, studio.by_hand.changed, say)


def _stop(studio: Studio) -> None:
    """Show the button, and what was stopped once it is pressed."""
    stop = html.button("STOP").classes("stop").props('type="button" title="Stop the machine and lift the pen (Esc)"')
    stop.on("click", js_handler="() => stopMachine()")
    html.p("Maulstick does not answer. If the machine moves, use its own emergency switch.").classes("silent").props(
        'role="alert" hidden'
    )
    html.p().classes("heard").props('role="status"')
    client = ui.context.client
    ui.on("stop", lambda: client.run_javascript(f"stopHeard({json.dumps(studio.stop())})"))
    ui.add_body_html(_STOP)


def _tell(error: Exception) -> None:
    """Show a person's mistake on the page until it is read; NiceGUI prints any other error in the terminal."""
    if isinstance(error, MaulstickError):
        first, _, rest = error_text(error).partition(" ")
        sentence = f"{first.capitalize() if first.isalpha() and first.islower() else first} {rest}"
    else:
        sentence = "Something in Maulstick is broken; the terminal says what."
    ui.notify(sentence, type="negative", position="top", timeout=0, close_button="OK")
