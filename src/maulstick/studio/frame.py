"""The frame of the page: where one goes, what is going on, and the button that stops the machine."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from nicegui import PageArguments, ui

from maulstick.errors import MaulstickError
from maulstick.studio.studio import Studio

_PANELS = {
    "/": ("Draw", "draw", "maulstick.studio.panels.draw"),
    "/styles": ("Styles", "brush", "maulstick.studio.panels.styles"),
    "/plan": ("Plan", "auto_awesome_mosaic", "maulstick.studio.panels.plan"),
    "/paints": ("Paints", "palette", "maulstick.studio.panels.paints"),
    "/paint": ("Paint", "precision_manufacturing", "maulstick.studio.panels.paint"),
    "/survey": ("Survey", "how_to_vote", "maulstick.studio.panels.survey"),
}
"""By path: a panel's name, its icon, and its module, whose `build` is called with the studio and what a link asks."""

_STYLE = Path(__file__).with_name("studio.css")


def page(studio: Studio) -> None:
    """Build the page for whoever has opened it."""
    ui.on_exception(_tell)
    ui.add_css(_STYLE)
    ui.colors(primary="#8c3d26", secondary="#5b6770", accent="#2f6690", negative="#b3261e", positive="#3c7a3f")
    with ui.header().classes("frame"):
        ui.label("Maulstick").classes("name")
        links = _links()
        _doing(studio)
        _stop()
    with ui.element("main").classes("panel"):
        ui.sub_pages({path: _built(path, studio, links) for path in _PANELS})


def _links() -> dict[str, ui.link]:
    links = {}
    with ui.element("nav").props('aria-label="Panels"').classes("panels"):
        for path, (name, icon, _) in _PANELS.items():
            with ui.link(target=path).classes("panel-link") as links[path]:
                ui.icon(icon).props("aria-hidden=true")
                ui.label(name)
    return links


def _built(path: str, studio: Studio, links: dict[str, ui.link]) -> Callable[[PageArguments], None]:
    def build(asked: PageArguments) -> None:
        for other, link in links.items():
            link.props(remove="aria-current")
            if other == path:
                link.props('aria-current="page"')
        import_module(_PANELS[path][2]).build(studio, asked.query_parameters)

    return build


def _doing(studio: Studio) -> None:
    """A line that says what is being planned and painted."""
    line = ui.label().classes("doing").props('role="status"')

    def say() -> None:
        doing = [each for each in (studio.plans.doing, studio.run.doing) if each]
        line.set_text(" · ".join(doing))

    studio.plans.changed.subscribe(say)
    studio.run.changed.subscribe(say)
    say()


def _stop() -> None:
    """Asked for beside the socket, so that it works while the page waits for anything else."""
    stop = ui.element("button").classes("stop").props('type="button" title="Stop the machine and lift the pen (Esc)"')
    with stop:
        ui.label("STOP")
    stop.on("click", js_handler="() => fetch('/stop', {method: 'POST'})")
    ui.add_body_html(
        "<script>addEventListener('keydown', (event) => "
        "{ if (event.key === 'Escape') fetch('/stop', {method: 'POST'}); }, {capture: true});</script>"
    )


def _tell(error: Exception) -> None:
    """A person's mistake is a sentence on the page; what is broken is in the terminal, where NiceGUI says it."""
    if isinstance(error, MaulstickError):
        ui.notify(str(error), type="negative", multi_line=True, timeout=12000, close_button="OK")
        return
    ui.notify("Something in Maulstick is broken; the terminal says what.", type="negative", close_button="OK")
