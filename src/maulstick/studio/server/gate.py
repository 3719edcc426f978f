"""Gate in front of the studio: checks who sends a request, from which page, and how much.

Every request passes here, those of the websocket included, before any of it is read.
"""

import asyncio
import re
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from secrets import compare_digest
from typing import final
from urllib.parse import parse_qs, quote, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from maulstick.studio.workers.uploads import LARGEST

OPEN = "/survey/"
"""Path of the survey's own pages, which need no token of the studio: their links are tokens themselves."""

_KEPT = 400 * 24 * 3600  # seconds of the cookie, as long as browsers allow: a bookmark works without the token
_LONGEST = 120.0  # seconds for an upload: 64 MiB then need 4.5 Mbit/s
_OWN_SITES = {"same-origin", "none"}  # none: typed, or a bookmark
_HOST = re.compile(r"(?:\[([0-9a-f:.]+)\]|([0-9a-z.-]+))(?::[0-9]{1,5})?", re.IGNORECASE)
_LENGTH = re.compile(r"[0-9]{1,18}")  # int() takes more: "+5", "1_000"
_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; object-src 'none'; base-uri 'self'; "
    "form-action 'self'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


@final
class Gate:
    """ASGI middleware.

    token: required of everybody, once in the link and then in a cookie: all users of a machine share its loopback.
    is_local: whether the studio answers to this machine's own names alone.
    """

    def __init__(self, app: ASGIApp, token: str, *, is_local: bool) -> None:
        self._app, self._token, self._is_local = app, token, is_local

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or refuse it and say why."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        if refusal is not None:
            await self._refuse(refusal, scope, receive, send)
            return
        if scope["type"] == "http":
            with suppress(ClientDisconnect):  # people close pages; there is nothing to report
                await self._app(scope, _Measured(receive).receive, _with_headers(send))
        else:
            await self._app(scope, receive, send)

    def _refusal(self, scope: Scope) -> Response | None:
        headers = Headers(scope=scope)
        hosts, socket = headers.getlist("host"), scope["type"] == "websocket"
        if len(hosts) != 1 or (self._is_local and not _is_loopback(hosts[0])):
            return _no(421, "The studio answers to this machine's own names alone; open the link that it printed.")
        origin = headers.get("origin")
        asks = scope.get("method") in ("GET", "HEAD")
        own = {f"{scheme}://{hosts[0].lower()}" for scheme in ("http", "https")}
        if (origin is None and socket) or (origin is not None and origin.lower() not in own):
            return _no(403, "Another site's page cannot use the studio; open the link that it printed.")
        navigates = asks and headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"
        if headers.get("sec-fetch-site", "none") not in _OWN_SITES and not navigates:
            return _no(403, "Another site's page cannot use the studio; open the link that it printed.")
        length = headers.get("content-length", "0")
        if not _LENGTH.fullmatch(length):
            return _no(400, "The length of what was sent is no number; send it again.")
        if int(length) > LARGEST:
            return _no(413, f"That is larger than {LARGEST >> 20} MiB; send something smaller.")
        return None if scope["path"].startswith(OPEN) else self._by_token(scope, headers)

    def _by_token(self, scope: Scope, headers: Headers) -> Response | None:
        cookie = f"maulstick-{scope['server'][1]}"  # a browser sends all studios of a machine the same ones
        query = parse_qs(scope["query_string"].decode("latin-1"))
        if scope["type"] == "http" and _same(query.pop("token", [""])[0], self._token):
            return _let_in(scope["path"], query, cookie, self._token)
        if _same(_cookie(headers, cookie), self._token):
            return None
        return _no(403, "The studio opens by the whole link that it printed, with its token; open that one.")

    async def _refuse(self, refusal: Response, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
            return
        await refusal(scope, receive, _with_headers(send))


class _Measured:
    """Receiver that limits size and time. Whoever sends more, or more slowly, is treated as disconnected."""

    def __init__(self, receive: Receive) -> None:
        self._receive, self._bytes, self._whole = receive, 0, False
        self._until = asyncio.get_running_loop().time() + _LONGEST

    async def receive(self) -> Message:
        """Receive the next message."""
        if self._whole:
            return await self._receive()
        left = self._until - asyncio.get_running_loop().time()
        try:
            message = await asyncio.wait_for(self._receive(), max(left, 0.0))
        except TimeoutError:
            return {"type": "http.disconnect"}
        self._bytes += len(message.get("body", b""))
        self._whole = not message.get("more_body", False)
        return message if self._bytes <= LARGEST else {"type": "http.disconnect"}


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sending


def _no(status: int, why: str) -> Response:
    return PlainTextResponse(f"{why}\n", status_code=status)


def _let_in(path: str, query: dict[str, list[str]], cookie: str, token: str) -> Response:
    """Set the cookie, and send the browser to the same address without the token.

    This is no redirect: a browser that came from another site follows one without sending a strict cookie.
    """
    rest = urlencode(query, doseq=True)
    where = "/" + quote(path.lstrip("/")) + (f"?{rest}" if rest else "")  # "//evil.example" is another site
    inside = PlainTextResponse(
        "The studio opens.\n", headers={"Refresh": f"0; url={where}", "Cache-Control": "no-store"}
    )
    inside.set_cookie(cookie, token, max_age=_KEPT, httponly=True, samesite="strict")
    return inside


def _is_loopback(host: str) -> bool:
    parts = _HOST.fullmatch(host)
    if parts is None:
        return False
    name = parts[1] or parts[2].lower()
    if name == "localhost":
        return True
    try:
        return ip_address(name).is_loopback
    except ValueError:
        return False


def _cookie(headers: Headers, name: str) -> str:
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(name)
    except CookieError:
        return ""
    return "" if morsel is None else morsel.value


def _same(given: str, token: str) -> bool:
    return compare_digest(given.encode(), token.encode())
