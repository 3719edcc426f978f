"""Routes that the page uses besides its websocket: pictures and files by name, and stopping the machine."""

import re
from pathlib import Path
from urllib.parse import quote

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, PlainTextResponse, Response

from maulstick.errors import InputError, MaulstickError
from maulstick.studio.state.gallery import SCREEN
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import file_name, title_of
from maulstick.studio.wording import error_text
from maulstick.studio.workers.plan_pictures import AGAIN, LARGE
from maulstick.studio.workers.planner import TARGET

routes = APIRouter()

_FRESH = {"Cache-Control": "no-cache"}
_SHOWN = {  # files that a page may show, by kind
    "plans": {"preview.png", "palette.png", "painting-painted.png", TARGET, LARGE},
    "drawings": {"preview.png", "drawing-painted.png"},
    "pictures": {"small.jpg", SCREEN},
    "hands": {"hand.png"},
}
_MOST_FRAMES = 100  # their file names have two digits
_DOWNLOADS = {"plans": {"painting.json", "painting.svg", "preview.png"}}


@routes.get("/picture/{kind}/{name}/{file}")
def picture(kind: str, name: str, file: str, request: Request) -> Response:
    """Send a picture of something in the studio's folder."""
    is_shown = file in _SHOWN.get(kind, ()) or (kind == "plans" and AGAIN.fullmatch(file))
    return _file(request, kind, name, file if is_shown else None)


@routes.get("/picture/plans/{name}/order/{number}.jpg")
def order(name: str, number: int, request: Request) -> Response:
    """Send a picture of the first strokes of a plan."""
    return _file(request, "plans", name, f"order/{number:02}.jpg" if 0 <= number < _MOST_FRAMES else None)


@routes.get("/file/{kind}/{name}/{file}")
def download(kind: str, name: str, file: str, request: Request) -> Response:
    """Send a file as a download, which no browser opens in place."""
    return _file(request, kind, name, file if file in _DOWNLOADS.get(kind, ()) else None, saves=True)


@routes.get("/thrown/{id}")
def thrown(id: str, request: Request) -> Response:
    """Send a picture of something in the trash."""
    studio: Studio = request.app.state.studio
    path = studio.trash.picture(id)
    if path is None or not _is_within(path, studio.folder.root / "trash"):
        return Response(status_code=404)
    return FileResponse(path, headers=_FRESH)


@routes.get("/live/{name}/{seen}")
async def live(name: str, seen: int, request: Request) -> Response:
    """Send the canvas of a plan that is being made. seen: a number that gives each picture an address of its own."""
    plan = request.app.state.studio.plans.plans.get(name)
    if plan is None or not plan.canvas:
        return Response(status_code=404)
    return Response(plan.canvas, media_type="image/jpeg", headers=_FRESH)


@routes.get("/strokes/{name}/{version}")
async def strokes(name: str, version: int, request: Request, since: int | None = None) -> Response:
    """Send the strokes of a plan after so many acts of a person that differ from those after `since` acts."""
    studio: Studio = request.app.state.studio
    try:
        marks = await studio.directing(name).marks(version, since)
    except MaulstickError as error:
        return PlainTextResponse(error_text(error), status_code=409)
    return Response(marks, media_type="application/octet-stream", headers=_FRESH)


@routes.get("/seen/{seen}.jpg")
async def seen(seen: int, request: Request) -> Response:
    """Send the last photograph of the sheet. seen: a number that gives each picture an address of its own."""
    photograph = request.app.state.studio.run.state.photograph
    if not photograph:
        return Response(status_code=404)
    return Response(photograph, media_type="image/jpeg", headers=_FRESH)


@routes.get("/sheet/{file}")
def style_sheet(file: str, request: Request) -> Response:
    """Send the sheet of a style; its name is a hash of what is on it, so that it never changes."""
    studio: Studio = request.app.state.studio
    path = studio.styles.sheets / file
    if not re.fullmatch(r"[0-9a-f]{32}\.png", file) or not _is_within(path, studio.folder.root):
        return Response(status_code=404)
    return FileResponse(path, headers={"Cache-Control": "private, max-age=31536000, immutable"})


@routes.post("/stop")
async def stop(request: Request) -> Response:
    """Stop the machine at once, and say what was stopped."""
    return PlainTextResponse(request.app.state.studio.stop())


def _file(request: Request, kind: str, name: str, file: str | None, *, saves: bool = False) -> Response:
    studio: Studio = request.app.state.studio
    try:
        path = studio.folder.of(kind, name) / (file or "")
    except InputError:
        return Response(status_code=404)
    if file is None or not _is_within(path, studio.folder.root / kind):
        return Response(status_code=404)
    return FileResponse(path, headers=_FRESH | (_saved(studio.folder.of(kind, name), file) if saves else {}))


def _saved(thing: Path, file: str) -> dict[str, str]:
    """Return the header by which a browser saves a file of a thing under its title (RFC 6266)."""
    titled = quote(file_name(title_of(thing), f"-{file}"), safe="")
    return {"Content-Disposition": f"attachment; filename=\"{thing.name}-{file}\"; filename*=UTF-8''{titled}"}


def _is_within(path: Path, folder: Path) -> bool:
    """Return whether there is a file at the path, and it lies in the folder: a symbolic link may lead anywhere."""
    return path.is_file() and path.resolve().is_relative_to(folder.resolve())
