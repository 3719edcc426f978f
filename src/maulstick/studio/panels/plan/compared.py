"""Pictures of a plan one over the other: its strokes, and what they are compared with, parted by a slider."""

from nicegui import html, ui

from maulstick.studio.panels.plan.closer import CloserLook, Shown
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.studio import Studio
from maulstick.studio.workers.planner import TARGET

_SPLIT = """(event) => {
  const pictures = event.target.closest(".plan").querySelector(".compare");
  pictures.style.setProperty("--split", event.target.value + "%");
}"""


class ComparedPictures:
    """Strokes of a plan, and over them the picture that it is of, or another plan."""

    def __init__(self, studio: Studio, plan: Plan) -> None:
        self._studio, self._plan = studio, plan
        with ui.element().classes("compare") as self._pictures:
            self.canvas = html.img()
            self._other = html.img(alt="").classes("target")
        with html.label().classes("weight") as self._split:
            self._split_label = ui.label("Picture or plan")
            html.input_(type="range", min=0, max=100).on("input", js_handler=_SPLIT).props["^value"] = 100
        with ui.element().classes("line") as self._choice:
            self._with = ui.select({}, label="Compared with", on_change=self._show_other).classes("compared-with")
            self._closer = ui.button("Look closer", icon="zoom_in", on_click=self._look_closer).props("flat")

    def show(self, source: str) -> None:
        """Show the strokes by the address of their picture, "" where there are none yet."""
        if self.canvas.props.get("src") != source and source:
            self.canvas.props["src"] = source
        self._pictures.visible = bool(source)
        offered = self._offered()
        if self._with.options != offered:
            self._with.set_options(offered, value=self._with.value if self._with.value in offered else "")
        self._with.visible = bool(source) and len(offered) > 1
        self._closer.visible = bool(source) and not self._plan.is_busy
        self._choice.visible = self._with.visible or self._closer.visible
        self._show_other()

    def _show_other(self) -> None:
        other = self._compared
        self._other.visible = other is not None
        self._split.visible = self._other.visible and self._pictures.visible
        self._split_label.set_text("That plan or this" if self._with.value else "Picture or plan")
        if other is not None and self._other.props.get("src") != other.source:
            self._other.props["src"] = other.source

    def _look_closer(self) -> None:
        """Open what the card compares, as large as the window."""
        title = self._studio.plans.titles().get(self._plan.name, self._plan.name)
        CloserLook(self._studio.desk, self._plan, title, self._compared)

    @property
    def _compared(self) -> Shown | None:
        """What the strokes are compared with: another plan, the picture, or nothing."""
        if chosen := str(self._with.value or ""):
            return Shown.strokes(self._studio.plans.of(chosen), self._studio.plans.titles().get(chosen, chosen))
        return Shown.target(self._plan) if self._has_picture else None

    @property
    def _has_picture(self) -> bool:
        return (self._plan.folder / TARGET).is_file()

    def _offered(self) -> dict[str, str]:
        """Return what it can be compared with: its picture, or nothing, as "", and the other plans by name."""
        plans, titles = self._studio.plans.plans, self._studio.plans.titles()
        others = (name for name, plan in plans.items() if plan.is_painting and plan is not self._plan)
        first = "The picture" if self._has_picture else "Nothing"
        return {"": first, **{name: titles.get(name, name) for name in others}}
