"""Compression of what browsers load, done once for files that never change."""

from typing import final

from starlette.datastructures import Headers
from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_UNCHANGING = "/_nicegui/"
"""Beginning of the paths of files that never change: NiceGUI's version or a hash of the content is in each."""

_MOST = 256  # files that are kept; a studio has some forty


@final
class KeptGZip:
    """ASGI middleware: gzip, whose answers for files that never change are kept."""

    def __init__(self, app: ASGIApp) -> None:
        self._packed = GZipMiddleware(app, compresslevel=6)
        self._kept: dict[str, list[Message]] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer with what was kept, or compress the answer."""
        if scope["type"] != "http" or not _may_be_kept(scope):
            await self._packed(scope, receive, send)
        elif scope["path"] in self._kept:
            for message in self._kept[scope["path"]]:
                await send(_copy(message))
        else:
            messages: list[Message] = []

            async def note(message: Message) -> None:
                messages.append(_copy(message))
                await send(message)

            await self._packed(scope, receive, note)
            if len(self._kept) < _MOST and _never_changes(messages):
                self._kept[scope["path"]] = messages


def _copy(message: Message) -> Message:
    """Return a message with headers of its own, to which others may add."""
    return {**message, "headers": [*message["headers"]]} if "headers" in message else {**message}


def _may_be_kept(scope: Scope) -> bool:
    """Return whether a plain request asks for a compressed file as a whole."""
    headers = Headers(scope=scope)
    is_whole = not {"range", "if-none-match", "if-modified-since"} & set(headers.keys())
    return (
        scope["method"] == "GET"
        and scope["path"].startswith(_UNCHANGING)
        and not scope.get("query_string")
        and "gzip" in headers.get("accept-encoding", "")
        and is_whole
    )


def _never_changes(messages: list[Message]) -> bool:
    headers = Headers(raw=messages[0]["headers"])
    return bool(messages[0]["status"] == 200 and headers.get("content-encoding") == "gzip")
