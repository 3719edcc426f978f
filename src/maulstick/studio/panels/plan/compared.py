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
        chosen = str(self._with.value or "")
        self._other.visible = bool(chosen) or self._has_picture
        self._split.visible = self._other.visible and self._pictures.visible
        self._split_label.set_text("That plan or this" if chosen else "Picture or plan")
        if self._other.visible:
            source = f"/picture/plans/{chosen}/preview.png" if chosen else f"/picture/plans/{self._plan.name}/{TARGET}"
            if self._other.props.get("src") != source:
                self._other.props["src"] = source

    def _look_closer(self) -> None:
        """Open what the card compares, as large as the window."""
        titles, chosen = self._studio.plans.titles(), str(self._with.value or "")
        other = Shown.target(self._plan) if self._has_picture else None
        if chosen:
            other = Shown.strokes(self._studio.plans.of(chosen), titles.get(chosen, chosen))
        CloserLook(self._studio.desk, self._plan, titles.get(self._plan.name, self._plan.name), other)

    @property
    def _has_picture(self) -> bool:
        return (self._plan.folder / TARGET).is_file()

    def _offered(self) -> dict[str, str]:
        """Return what it can be compared with: its picture, or nothing, as "", and the other plans by name."""
        plans, titles = self._studio.plans.plans, self._studio.plans.titles()
        others = (name for name, plan in plans.items() if plan.is_painting and plan is not self._plan)
        first = "The picture" if self._has_picture else "Nothing"
        return {"": first, **{name: titles.get(name, name) for name in others}}
