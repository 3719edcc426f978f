"""The sheets of the styles, which the page asks for beside its socket."""

import re

from fastapi import APIRouter, Request
from starlette.responses import FileResponse, Response

from maulstick.studio.studio import Studio

styles_asked = APIRouter()


@styles_asked.get("/sheet/{file}")
def sheet(file: str, request: Request) -> Response:
    """A sheet that was drawn; its name says what is on it, so that it never changes."""
    studio: Studio = request.app.state.studio
    path = studio.styles.sheets / file
    if not re.fullmatch(r"[0-9a-f]{32}\.png", file) or not path.is_file():
        return Response(status_code=404)
    return FileResponse(path, headers={"Cache-Control": "private, max-age=31536000, immutable"})
