"""Pages for the participants of every survey in the studio's folder, and nothing else."""

from pathlib import Path
from threading import Event

from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, Response
from starlette.routing import Mount, Router
from starlette.types import Receive, Scope, Send

from maulstick.errors import MaulstickError
from maulstick.studio.state.studio import Studio
from maulstick.survey.answers import Answers
from maulstick.survey.app import participants
from maulstick.survey.pages import ICON, STYLE, apology

_NO_PAGE = "There is no such page. Please check the link that you were given: it must be whole."
_LOOKS = {"/survey.css": (STYLE, "text/css"), "/icon.svg": (ICON, "image/svg+xml")}


def survey_pages() -> Router:
    """Make the router of NAME/TOKEN; it answers every request below its path, so that nothing else does.

    Whoever has no token of a participant cannot find out which surveys there are: all names are answered alike.
    """
    return Router([Mount("/{name}", _of_one)], redirect_slashes=False, default=_refuse)


async def _of_one(scope: Scope, receive: Receive, send: Send) -> None:
    name, path = scope["path_params"]["name"], scope["path"].removeprefix(scope["root_path"])
    if scope["type"] == "http" and path in _LOOKS:
        look, kind = _LOOKS[path]
        await Response(look, media_type=kind)(scope, receive, send)
        return
    studio: Studio = scope["app"].state.studio
    if scope["type"] != "http" or name not in studio.folder.names("surveys"):
        await _refuse(scope, receive, send)
        return
    try:
        progressed, folder = Event(), studio.folder.of("surveys", name)
        if not await run_in_threadpool(_knows, folder, path.split("/")[1]):
            await _refuse(scope, receive, send)
            return
        pages = await run_in_threadpool(participants, folder, progressed.set)
    except MaulstickError:
        await _refuse(scope, receive, send)
        return
    await pages(scope, receive, send)
    if progressed.is_set():
        studio.surveys.note_progress()


def _knows(folder: Path, token: str) -> bool:
    return Answers(folder).participant(token) is not None


async def _refuse(scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008})
        return
    page = apology(_NO_PAGE, scope["root_path"])
    await HTMLResponse(page, status_code=404, headers={"Cache-Control": "no-store"})(scope, receive, send)
