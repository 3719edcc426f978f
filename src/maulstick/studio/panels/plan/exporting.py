"""Dialog that saves a painting as a file for other machines, for the screen, or for print."""

from pathlib import Path

from nicegui import html, ui

from maulstick.errors import InputError
from maulstick.jobs.export import ExportOptions
from maulstick.robot.easel import Pen
from maulstick.studio.state.typed_numbers import whole_number
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.export_work import Taken, export_film, export_for_machine, export_picture

_PNG, _PDF, _PER_PEN = "png", "pdf", "per pen"
_FILMS = {"mp4": "MP4, a film of its strokes", "gif": "GIF, a small film for web pages"}
_GCODE = {"grbl": "G-code for Grbl and FluidNC", "marlin": "G-code for Marlin"}
_KINDS = {
    "svg": "SVG, for AxiDraw's own program",
    _PER_PEN: "SVGs, one for each pen",
    **_GCODE,
    "hpgl": "HPGL, for pen plotters of that time",
    _PNG: "PNG, a picture of any size",
    _PDF: "PDF, to print at its true size",
    **_FILMS,
}
_MOST_PX = 8000  # of a picture's height, which a browser still shows
_MOST_SECONDS = 20  # of a film, whose frames are all in memory: 400 hold a gigabyte


class ExportDialog:
    """Dialog, open at once, that asks what the file is for and saves it. name: of the file, without its end."""

    def __init__(self, desk: Desk, painting: Path, name: str) -> None:
        self._desk, self._painting, self._name = desk, painting, name
        with ui.dialog(value=True).props('aria-label="Save as"') as self._dialog, html.div().classes("sheet saves"):
            html.h2("Save as")
            self._kind = ui.select(_KINDS, label="What for", value="svg", on_change=self._fit).props("outlined")
            self._height = NumberField("Pixels high", value=2000, min=16, max=_MOST_PX).props("outlined")
            self._seconds = NumberField("Seconds", value=10, min=1, max=_MOST_SECONDS).props("outlined")
            self._servo = ui.checkbox("A servo lifts the pen", on_change=self._fit)
            with ui.element().classes("numbers") as self._positions:
                self._up = NumberField("Its number for up", value=30).props("outlined")
                self._down = NumberField("and for down", value=90).props("outlined")
            with ui.element().classes("line end"):
                ui.button("Leave it", on_click=self._dialog.close).props("flat")
                self._go = ui.button("Save", icon="download", on_click=self._save)
        self._dialog.on("hide", self._dialog.delete)
        self._fit()

    def _fit(self) -> None:
        self._height.visible = self._kind.value == _PNG
        self._seconds.visible = self._kind.value in _FILMS
        self._servo.visible = self._kind.value in _GCODE
        self._positions.visible = self._servo.visible and bool(self._servo.value)

    async def _save(self) -> None:
        self._go.props("loading")
        try:
            taken = await self._taken()
        finally:
            self._go.props(remove="loading")
        self._dialog.close()
        for note in taken.notes:
            ui.notify(note, type="warning", multi_line=True)
        ui.download.content(taken.content, taken.name)

    async def _taken(self) -> Taken:
        kind, painting, name = str(self._kind.value), self._painting, self._name
        if kind in (_PNG, _PDF):
            px = whole_number(self._height.value, "the height in pixels", 16, _MOST_PX) if kind == _PNG else None
            return await self._desk.do(export_picture, painting, name, px)
        if kind in _FILMS:
            seconds = whole_number(self._seconds.value, "the seconds of a film", 1, _MOST_SECONDS)
            return await self._desk.do(export_film, painting, name, kind, seconds)
        options = ExportOptions(
            format="gcode" if kind in _GCODE else "svg" if kind == _PER_PEN else kind,
            dialect=kind if kind in _GCODE else None,
            servo=self._pen if self._positions.visible else None,
            per_pen=kind == _PER_PEN,
        )
        return await self._desk.do(export_for_machine, painting, name, options)

    @property
    def _pen(self) -> Pen:
        up, down = self._up.value, self._down.value
        if up is None or down is None:
            raise InputError("the servo's numbers for up and down are missing; write both")
        if up == down:
            raise InputError("the servo's numbers for up and down are the same; write two that differ")
        return Pen(up=up, down=down)
