"""Uploaded files: a button to choose one, and a temporary place for it that does not depend on its name."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path

from nicegui import events, html, ui

from maulstick.errors import InputError
from maulstick.storage.folders import MAKE_ROOM, as_output_error
from maulstick.studio.state.folder import Folder
from maulstick.studio.widgets.file_chooser import FileChooser
from maulstick.studio.widgets.webcam import camera_button
from maulstick.studio.workers.uploads import LARGEST, known_as

_LARGEST_SMALL = 2**20  # bytes: of a file of a few numbers, read into memory whole


_ALLOW_DROP = """(event) => {
  if (event.dataTransfer.types.includes("Files")) event.preventDefault();
}"""
_TAKE_DROP = """(event) => {
  if (event.defaultPrevented || !event.dataTransfer.files.length) return;
  event.preventDefault();
  runMethod(CHOOSER, "addFiles", [event.dataTransfer.files]);
}"""
_TAKE_OWN_DROP = """(event) => {
  const files = [...event.dataTransfer.files];
  const isOwn = (file) => "ENDINGS".split(",").some((ending) => file.name.toLowerCase().endsWith(ending));
  if (!files.length || !files.every(isOwn)) return;
  event.preventDefault();
  runMethod(CHOOSER, "addFiles", [event.dataTransfer.files]);
}"""
_TAKE_PASTE = """
const paste = (event) => {
  if (!document.body.contains(getHtmlElement(CHOOSER))) return removeEventListener("paste", paste);
  const isText = event.target.closest?.(":read-write"); // which Excel copies with a picture of it
  if (isText || document.querySelector(".q-dialog")) return;
  if (event.clipboardData.files.length) runMethod(CHOOSER, "addFiles", [event.clipboardData.files]);
};
addEventListener("paste", paste);
"""


class _Reading:
    """Words beside a button, which cannot be pressed meanwhile, while a file is sent or read.

    A file may have been read before the page says that it begins to send it: that takes another way.
    """

    def __init__(self, button: ui.button) -> None:
        self._button, self._is_sent, self._read = button, False, 0
        with html.span().classes("reading hint").props('role="status"') as self._words:
            ui.spinner().props("aria-hidden=true")
            ui.label("Reading it …")
        self._show()

    def send(self, is_sent: bool) -> None:
        """Take in whether the page sends files."""
        self._is_sent = is_sent
        self._show()

    @contextmanager
    def another(self) -> Iterator[None]:
        """Let one more file be read while the context lasts."""
        self._read += 1
        self._show()
        try:
            yield
        finally:
            self._read -= 1
            self._show()

    def _show(self) -> None:
        if not self._words.is_deleted:
            self._words.visible = self._is_sent or self._read > 0
            self._button.enabled = not self._words.visible


def upload_button(
    text: str,
    accept: str,
    take: Callable[[events.UploadEventArguments], Awaitable[None]],
    onto: ui.element | None = None,
    beside: ui.element | None = None,
    camera: bool = False,
    several: bool = False,
) -> ui.button:
    """Make a button that lets a person choose a file, and says beside it that the file is being read.

    accept: endings that the browser offers, as ".png,.jpg", but does not enforce.  take: called with the file.
    onto: part of the page onto which a file can be dropped as well, or pasted while the page has it.
    beside: part of the page onto which another button, made later, lets all kinds of files be dropped; those with these
    endings come here.
    camera: whether a photograph may be taken instead.  several: whether more than one file may be brought at once.
    """

    async def taken(file: events.UploadEventArguments) -> None:
        with reading.another():
            await take(file)

    chooser = FileChooser(accept, taken, _refuse, several=several)
    chooser.on("failed", _miss, [])
    button = ui.button(text, icon="upload_file").props("outline no-caps")
    reading = _Reading(button)
    chooser.on("start", lambda: reading.send(True), [])
    # In the browser, for a line that breaks takes the websocket with it, and no file can be chosen twice before.
    reset = f"() => {{ runMethod({chooser.id}, 'reset', []); emit(); }}"
    chooser.on("finish", lambda: reading.send(False), js_handler=reset)
    button.on("click", js_handler=f"() => runMethod({chooser.id}, 'pickFiles', [])")
    if beside is not None:
        beside.on("drop", js_handler=_TAKE_OWN_DROP.replace("ENDINGS", accept).replace("CHOOSER", str(chooser.id)))
    if onto is not None:
        onto.on("dragover", js_handler=_ALLOW_DROP)
        onto.on("drop", js_handler=_TAKE_DROP.replace("CHOOSER", str(chooser.id)))
        ui.run_javascript(_TAKE_PASTE.replace("CHOOSER", str(chooser.id)))
    if camera:
        camera_button(chooser)
    return button


@asynccontextmanager
async def incoming(folder: Folder, file: events.UploadEventArguments) -> AsyncIterator[Path]:
    """Write an uploaded file to a temporary path, which is removed afterwards.

    Raises OutputError where there is no room for it.
    """
    path = folder.incoming()
    try:
        with as_output_error(folder.root, MAKE_ROOM):
            await file.file.save(path)
        with known_as(path, str(file.file.name)):
            yield path
    finally:
        await asyncio.to_thread(path.unlink, missing_ok=True)


async def small_content(file: events.UploadEventArguments, what: str) -> bytes:
    """Read a small uploaded file. what: its name in errors. Raises InputError where it is too large."""
    if file.file.size() > _LARGEST_SMALL:
        raise InputError(f"that file is larger than {_LARGEST_SMALL >> 10} KiB, too large for a {what}; choose another")
    return await file.file.read()


def _miss() -> None:
    raise InputError("that file did not arrive; bring it again, after loading the page where that is of no help")


def _refuse(names: list[str]) -> None:
    raise InputError(f"larger than {LARGEST >> 20} MiB, or of another kind: {', '.join(names)}; choose another file")
