"""Settings of a plan kept under names, to be chosen again, and shared as files."""

from collections.abc import Callable

from nicegui import events, html, ui

from maulstick.errors import InputError
from maulstick.studio.state.presets import Preset, Presets
from maulstick.studio.state.settings import Choices
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import MOST_LETTERS, file_name
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.widgets.uploading import small_content, upload_button

_FIELDS = {
    "machine": "machine “{}”",
    "style": "hand “{}”",
    "brush": "brush or pen “{}” for that machine",
    "size": "sheet “{}”",
    "turned": "way to turn a sheet “{}”",
    "fit": "fit “{}”",
    "drawing": "way to draw “{}”",
    "unmixed": "tubes of paint",
}
"""Words for what a studio may not have, by the name of the field."""


class PresetChoice:
    """List of settings that were kept, and ways to keep and share those of the form.

    desk: part of the page onto which such a file can be dropped.
    now: returns the form's settings.  take: fills the form; returns the names of fields that it could not fill.
    """

    def __init__(
        self, studio: Studio, desk: ui.element, now: Callable[[], Choices], take: Callable[[Choices], list[str]]
    ) -> None:
        self._presets: Presets = studio.presets
        self._now, self._take = now, take
        with ui.expansion("Kept settings").classes("more sheet presets"):
            html.p("All that is chosen below but the picture and the words, to be used for other pictures.").classes(
                "hint"
            )
            self._list = html.ul().props('aria-label="Kept settings"')
            with ui.element().classes("line keep"):
                self._title = ui.input("Name for these settings").props(f"maxlength={MOST_LETTERS}")
                self._title.on("keydown.enter", self._keep)
                ui.button("Keep", icon="bookmark_add", on_click=self._keep).props("outline")
            with ui.element().classes("line"):
                ui.button("Save these settings as a file", icon="download", on_click=self._save).props("flat no-wrap")
                upload_button("Load settings from a file", ".json", self._load, beside=desk)
        shown_by(self._list, studio.presets.changed, self._show)

    def _show(self) -> None:
        titles = self._presets.titles()
        self._list.visible = bool(titles)
        self._list.clear()
        with self._list:
            for name, title in titles.items():
                self._row(name, title)

    def _row(self, name: str, title: str) -> None:
        with html.li():
            ui.button(title, on_click=lambda: self._choose(name)).props("flat no-caps").tooltip("Set the form so")
            away = ui.button(icon="delete", on_click=lambda: self._throw_away(name, title)).props("flat")
            away.props["aria-label"] = f"Throw the settings {title} away"

    def _choose(self, name: str) -> None:
        self._fill(self._presets.of(name))

    def _fill(self, preset: Preset) -> None:
        """Set the form as a preset says, and say what this studio does not have."""
        values = preset.settings.model_dump()
        gone = [_FIELDS[name].format(values[name]) for name in self._take(preset.settings)]
        self._title.value = preset.title
        if gone:
            ui.notify(f"This studio has no {' and no '.join(gone)}; all else is set.", type="warning", multi_line=True)
        else:
            ui.notify(f"The form is set as in {preset.title or 'that file'}.", type="positive")

    def _keep(self) -> None:
        title = str(self._title.value or "")
        if not title.strip():
            raise InputError("these settings have no name yet; write one, as in “Ink on A5”")
        replaced = self._presets.keep(title, self._now())
        more = "; what had that name is in the trash" if replaced else ""
        ui.notify(f"The settings are kept as {title.strip()}{more}.", type="positive")

    def _save(self) -> None:
        title = str(self._title.value or "").strip()
        preset = Preset.of(title, self._now())
        ui.download.content(preset.written(), file_name(preset.title or "Settings of a plan", ".json"))

    async def _load(self, event: events.UploadEventArguments) -> None:
        preset = Preset.read(await small_content(event, "file of settings"), str(event.file.name))
        if not self._list.is_deleted:
            self._fill(preset)

    def _throw_away(self, name: str, title: str) -> None:
        client, presets = ui.context.client, self._presets
        trashed = presets.throw_away(name)
        offer_undo(client, f"{title} is in the trash", lambda: presets.take_back(trashed))
