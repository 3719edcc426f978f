"""Element by which a browser sends files, and the route that takes them."""

from collections.abc import Awaitable, Callable
from typing import final

from fastapi import APIRouter, Request
from nicegui import Client, events
from nicegui.element import Element
from nicegui.elements.upload_files import FileUpload, create_file_upload
from starlette.datastructures import UploadFile
from starlette.responses import Response

from maulstick.studio.workers.uploads import LARGEST

uploads = APIRouter()


@final
class FileChooser(Element):
    """Hidden element that sends each file that is chosen, dropped or pasted.

    `ui.upload` adds a route for each element, which FastAPI's caches hold after the page is closed, and the page by it.
    take: called with each file.  refuse: called with the names of files that the browser refuses.
    several: whether more than one may be chosen, dropped or pasted at once; else the first one counts.
    """

    def __init__(
        self,
        accept: str,
        take: Callable[[events.UploadEventArguments], Awaitable[None]],
        refuse: Callable[[list[str]], object],
        *,
        several: bool,
    ) -> None:
        super().__init__("q-uploader")
        self._take = take
        self.props(f'auto-upload accept="{accept}" aria-hidden=true').style("display: none")
        self._props["url"] = f"/page/{self.client.id}/upload/{self.id}"
        self._props["max-file-size"] = LARGEST
        self._props["multiple"] = several
        names = "(refused) => emit(refused.map((each) => each.file.name))"
        self.on("rejected", lambda event: refuse(event.args), js_handler=names)

    def take(self, file: FileUpload) -> None:
        """Take a file that came."""
        events.handle_event(self._take, events.UploadEventArguments(sender=self, client=self.client, file=file))


@uploads.post("/page/{client}/upload/{element}")
async def upload(client: str, element: int, request: Request) -> Response:
    """Let an element of an open page take files."""
    page = Client.instances.get(client)
    chooser = None if page is None else page.elements.get(element)
    if not isinstance(chooser, FileChooser):
        return Response(status_code=404)
    async with request.form() as form:
        files = [await create_file_upload(part) for part in form.values() if isinstance(part, UploadFile)]
    for file in files:
        file.name = file.name.replace("%22", '"')  # browsers send a quote so, and a percent sign as it is
        chooser.take(file)
    return Response(status_code=200)
