"""What the page asks for beside its socket about the run: the sheet as it was last seen."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from maulstick.studio.studio import Studio

run_asked = APIRouter()


@run_asked.get("/sheet/{seen}.jpg")
async def sheet(seen: int, request: Request) -> Response:
    """The sheet as it was last seen; seen: makes each another address."""
    studio: Studio = request.app.state.studio
    if not studio.run.state.photograph:
        return Response(status_code=404)
    return Response(studio.run.state.photograph, media_type="image/jpeg", headers={"Cache-Control": "no-cache"})
