"""Choice of the picture to be painted: one of those that were brought, or none."""

from collections.abc import Awaitable, Callable
from pathlib import Path

from nicegui import events, html, ui

from maulstick.errors import InputError
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import title_of
from maulstick.studio.widgets.renaming import ask_for_title
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.widgets.uploading import incoming, upload_button

_ENDINGS = ".jpg,.jpeg,.png,.heic,.heif,.webp,.tif,.tiff,.gif,.bmp"

_SCROLL = """setTimeout(() => {
  const group = document.getElementById("GROUP"), chosen = group.querySelector(":checked")?.parentNode;
  if (chosen) group.scrollTop = chosen.offsetTop - group.offsetTop;
})"""  # not scrollIntoView, which would scroll the page, too


class PictureChoice:
    """Thumbnails to choose from, and buttons to bring another picture.

    onto: part of the page onto which one can be dropped.  chosen: called after another was chosen.
    """

    def __init__(self, studio: Studio, onto: ui.element, chosen: Callable[[], object]) -> None:
        self._studio, self._on_chosen = studio, chosen
        names = studio.gallery.names()
        self._chosen = names[0] if names else None
        self._group = html.fieldset().classes("pictures").props('aria-label="Picture"')
        with ui.element().classes("line of-picture"):
            self._rename = ui.button("Rename", icon="edit", on_click=self._ask_for_title).props("flat")
            self._rename.props('aria-label="Rename the picture"')
            self._away = ui.button("Throw away", icon="delete", on_click=self._throw_away).props("flat")
            self._away.props('aria-label="Throw the picture away"')
        with ui.element().classes("line"):
            self._another = upload_button(
                "Bring a picture", _ENDINGS, self._bring, onto=onto, camera=True, several=True
            )
            self._portrait = ui.button("Try an example picture", on_click=self._use_portrait).props("flat no-caps")
        shown_by(self._group, studio.gallery.changed, self._show)

    @property
    def name(self) -> str | None:
        """Name of the chosen picture, or None."""
        return self._chosen

    @property
    def path(self) -> Path | None:
        """File of the chosen picture, or None."""
        return None if self._chosen is None else self._studio.gallery.path(self._chosen)

    @property
    def is_awaited(self) -> bool:
        """Whether a picture is on its way, which is chosen once it is here."""
        return not (self._another.enabled and self._portrait.enabled)

    def choose(self, path: Path | None) -> None:
        """Choose the picture of that file, or none. Raises InputError where it is not here any more."""
        gallery = self._studio.gallery
        names = {gallery.path(name): name for name in gallery.names()}
        self._chosen = None if path is None else names.get(path)
        self._show()
        ui.run_javascript(_SCROLL.replace("GROUP", self._group.html_id))
        self._on_chosen()
        if path is not None and self._chosen is None:
            raise InputError(
                "the picture of that plan is not here any more; put it back from the Trash, or choose another"
            )

    def _show(self) -> None:
        names, titles = self._studio.gallery.names(), self._studio.gallery.titles()
        if is_gone := self._chosen is not None and self._chosen not in names:
            self._chosen = names[0] if names else None
        self._group.clear()
        with self._group:
            for name in names:
                self._offer(name, titles.get(name, name))
            if names:
                self._offer(None, "No picture")
        self._rename.visible = self._away.visible = self._chosen in names
        self._group.visible = bool(names)
        self._portrait.visible = "portrait" not in names
        if is_gone:
            self._on_chosen()

    def _offer(self, name: str | None, title: str) -> None:
        def choose() -> None:
            self._chosen = name
            self._rename.visible = self._away.visible = name is not None
            self._on_chosen()

        with html.label(title=title).classes("thumb"):
            button = html.input_(type="radio", name=f"picture-{self._group.id}").on("change", choose)
            button.props["^checked"] = name == self._chosen or None
            if name is None:
                html.span(title)
            else:
                html.img(src=f"/picture/pictures/{name}/small.jpg", alt=title).props("loading=lazy")

    async def _bring(self, event: events.UploadEventArguments) -> None:
        async with incoming(self._studio.folder, event) as file:
            await self._take(self._studio.gallery.keep(file, str(event.file.name)))

    def _ask_for_title(self) -> None:
        gallery, name = self._studio.gallery, self._chosen
        if name is not None:
            ask_for_title(title_of(gallery.path(name).parent), lambda typed: gallery.retitle(name, typed))

    def _throw_away(self) -> None:
        gallery, name, client = self._studio.gallery, self._chosen, ui.context.client
        if name is not None:
            title = title_of(gallery.path(name).parent)
            trashed = self._studio.throw_picture_away(name)
            offer_undo(client, f"{title} is in the trash", lambda: gallery.take_back(trashed))

    async def _use_portrait(self) -> None:
        self._portrait.props("loading").disable()
        try:
            await self._take(self._studio.gallery.keep_portrait())
        finally:
            self._portrait.props(remove="loading").enable()

    async def _take(self, kept: Awaitable[str]) -> None:
        self._chosen = await kept
        self._show()
        self._on_chosen()
