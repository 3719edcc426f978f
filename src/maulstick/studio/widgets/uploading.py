"""Files that people bring: a button to choose one, and a place for it that its name has no say in."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from nicegui import events, ui

from maulstick.errors import InputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.uploads import LARGEST, known_as

_MOST_OF_A_FEW = 2**20  # bytes


def upload_button(text: str, accept: str, take: Callable[[events.UploadEventArguments], Awaitable[None]]) -> ui.button:
    """A button that lets a person choose a file.

    accept: endings that the browser offers, as ".png,.jpg", which it does not enforce.  take: is called with the file.
    """
    chooser = ui.upload(auto_upload=True, max_file_size=LARGEST, on_upload=take, on_rejected=_refuse)
    chooser.props(f'accept="{accept}" aria-hidden=true').style("display: none")

    async def uploaded(_: object) -> None:
        chooser.reset()  # so that the same file can be chosen again

    chooser.on("uploaded", uploaded)
    button = ui.button(text, icon="upload_file").props("outline no-caps")
    button.on("click", js_handler=f"() => runMethod({chooser.id}, 'pickFiles', [])")
    return button


@asynccontextmanager
async def incoming(folder: Folder, file: events.UploadEventArguments) -> AsyncIterator[Path]:
    """The content of an uploaded file in a file that goes again afterwards."""
    path = folder.incoming()
    try:
        await file.file.save(path)
        with known_as(path, str(file.file.name)):
            yield path
    finally:
        await asyncio.to_thread(path.unlink, missing_ok=True)


async def small_content(file: events.UploadEventArguments, what: str) -> bytes:
    """The content of an uploaded file that is a `what`, of a few numbers. Raises InputError where it is too large."""
    if file.file.size() > _MOST_OF_A_FEW:
        raise InputError(f"that file is larger than {_MOST_OF_A_FEW >> 10} KiB, too large for a {what}; choose another")
    return await file.file.read()


def _refuse() -> None:
    raise InputError(f"that file is larger than {LARGEST >> 20} MiB, or of another kind; choose another")
