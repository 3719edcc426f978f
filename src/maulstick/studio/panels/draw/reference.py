"""Picture under or beside the sheet that a hand is drawn on, and its tool; nothing of it is recorded."""

from nicegui import background_tasks, events, html, ui

from maulstick.errors import MaulstickError
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.slider import Slider
from maulstick.studio.widgets.uploading import incoming, upload_button

_ENDINGS = ".jpg,.jpeg,.png,.heic,.heif,.webp,.tif,.tiff,.gif,.bmp"  # that the browser offers; the content decides
_NONE = ""
_UNDER, _BESIDE = "under", "beside"


class ReferenceTool:
    """Button with a menu that chooses the picture, its place, and how strongly it shows."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._reference = studio, studio.reference
        look = self._reference.look
        with (
            ui.button("Picture", icon="image").props("flat stack no-caps aria-haspopup=dialog") as button,
            ui.menu().props('role=dialog aria-label="A picture to look at" anchor="top right" self="top left"') as menu,
            html.div().classes("sheet reference-menu"),
        ):
            html.p("Look at a picture while you draw. Only your strokes are kept.").classes("hint")
            self._name = ui.select({}, label="Picture", on_change=self._choose)
            upload_button("Bring a picture", _ENDINGS, self._bring)
            self._place = ui.radio({_UNDER: "Under the sheet", _BESIDE: "Beside it"}, on_change=self._lay)
            self._fader = Slider("How strong", 1, 0.05, look.strength, self._fade, live=True)
        menu.on("show", lambda: self._fader.set(self._reference.look.strength), [])  # it is not there before
        shown_by(button, studio.gallery.changed, self._show)
        shown_by(button, self._reference.changed, self._show)

    def _show(self) -> None:
        look, titles = self._reference.look, self._studio.gallery.titles()
        self._name.set_options({_NONE: "No picture", **titles}, value=look.name if look.name in titles else _NONE)
        self._place.value = _UNDER if look.is_under else _BESIDE
        self._fader.element.visible = look.is_under
        if self._fader.value != look.strength:
            self._fader.set(look.strength)

    def _choose(self) -> None:
        self._reference.show(str(self._name.value or "") or None)

    def _lay(self) -> None:
        self._reference.place(under=self._place.value == _UNDER)

    def _fade(self) -> None:
        self._reference.fade(self._fader.value)

    async def _bring(self, event: events.UploadEventArguments) -> None:
        async with incoming(self._studio.folder, event) as file:
            name = await self._studio.gallery.keep(file, str(event.file.name))
        self._reference.show(name)


class ReferencePicture:
    """Picture as it lies in the table, which holds the sheet as well."""

    def __init__(self, studio: Studio, table: ui.element) -> None:
        self._studio, self._reference, self._table = studio, studio.reference, table
        with table, html.div().classes("reference") as self._root:
            self._picture = html.img(alt="")
        shown_by(self._root, self._reference.changed, self._show)
        shown_by(self._root, studio.drawing.renewed, self._fit)

    def _fit(self) -> None:
        width, height = self._studio.drawing.size
        self._table.style(f"--proportion: {width / height}")

    def _show(self) -> None:
        look = self._reference.look
        self._picture.style(f"opacity: {look.strength if look.is_under else 1}")
        self._table.classes(remove=f"{_UNDER} {_BESIDE}")
        self._root.visible = look.name is not None
        if look.name is None:
            return
        self._table.classes(add=_UNDER if look.is_under else _BESIDE)
        background_tasks.create(self._load(look.name), context=self._root)

    async def _load(self, name: str) -> None:
        try:
            path = await self._studio.gallery.screen(name)
        except MaulstickError:
            self._reference.show(None)
            raise
        titles = self._studio.gallery.titles()
        if name == self._reference.look.name and not self._root.is_deleted:
            self._picture.props["src"] = f"/picture/pictures/{name}/{path.name}"
            self._picture.props["alt"] = f"{titles.get(name, name)}, to look at"
