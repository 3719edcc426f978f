"""Pages for the participants of every survey in the studio's folder, and nothing else."""

from threading import Event

from starlette.concurrency import run_in_threadpool
from starlette.responses import PlainTextResponse
from starlette.routing import Mount, Router
from starlette.types import Receive, Scope, Send

from maulstick.errors import InputError
from maulstick.studio.state.studio import Studio
from maulstick.survey.app import participants

_NO_PAGE = "There is no such page. Please check the link that you were given: it must be whole.\n"


def survey_pages() -> Router:
    """Make the router of NAME/TOKEN; it answers every request below its path, so that nothing else does."""
    return Router([Mount("/{name}", _of_one)], redirect_slashes=False, default=_refuse)


async def _of_one(scope: Scope, receive: Receive, send: Send) -> None:
    studio: Studio = scope["app"].state.studio
    name = scope["path_params"]["name"]
    if scope["type"] != "http" or name not in studio.folder.names("surveys"):
        await _refuse(scope, receive, send)
        return
    try:
        progressed = Event()
        pages = await run_in_threadpool(participants, studio.folder.of("surveys", name), progressed.set)
    except InputError:
        await _refuse(scope, receive, send)
        return
    await pages(scope, receive, send)
    if progressed.is_set():
        studio.surveys.note_progress()


async def _refuse(scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008})
        return
    await PlainTextResponse(_NO_PAGE, status_code=404)(scope, receive, send)
