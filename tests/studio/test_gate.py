"""Gate alone, in front of an application that reports the path and the size of each request."""

import asyncio
from collections.abc import Iterable
from typing import Any
from unittest.mock import patch

import pytest
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from maulstick.studio.server.gate import Gate

HERE = "127.0.0.1:8337"
TOKEN = "jlxwTrRXUbR3S5_4gs5V7k"
CARRIES_THE_TOKEN = ("Cookie", f"maulstick-8337={TOKEN}")


async def inside(scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.accept"})
        return
    body = await Request(scope, receive).body()
    await PlainTextResponse(f"{scope['path']} {len(body)}")(scope, receive, send)


def answer(
    path: str = "/",
    *headers: tuple[str, str],
    method: str = "GET",
    is_local: bool = True,
    carries_the_token: bool = True,
    socket: bool = False,
    hosts: Iterable[str] = (HERE,),
    query: str = "",
    body: Iterable[bytes] = (b"",),
) -> list[Message]:
    """Send a request whose body comes in parts, with no end after the last one, and return the response."""
    parts, sent = list(body), list[Message]()

    async def receive() -> Message:
        if socket:
            return {"type": "websocket.connect"}
        if not parts:
            await asyncio.Event().wait()
        return {"type": "http.request", "body": parts.pop(0), "more_body": bool(parts) or method == "SLOW"}

    async def send(message: Message) -> None:
        sent.append(message)

    named = [*(("host", host) for host in hosts), *headers, *([CARRIES_THE_TOKEN] if carries_the_token else [])]
    scope = {
        "type": "websocket" if socket else "http",
        "method": method,
        "path": path,
        "query_string": query.encode(),
        "server": ("127.0.0.1", 8337),
        "headers": [(name.lower().encode(), value.encode("latin-1")) for name, value in named],
    }
    asyncio.run(Gate(inside, TOKEN, is_local=is_local)(scope, receive, send))
    return sent


def status(sent: list[Message]) -> int:
    return int(sent[0]["status"])


def headers_of(sent: list[Message]) -> dict[str, str]:
    return {name.decode(): value.decode() for name, value in sent[0]["headers"]}


def text_of(sent: list[Message]) -> str:
    return b"".join(message.get("body", b"") for message in sent[1:]).decode()


@pytest.mark.parametrize("host", [HERE, "localhost", "LocalHost:8337", "[::1]:8337", "127.8.8.8:1"])
def test_this_machines_own_names_are_let_in(host: str) -> None:
    assert status(answer(hosts=[host])) == 200


@pytest.mark.parametrize(
    "hosts",
    [
        [],
        [""],
        ["evil.example"],
        ["evil.example:8337"],
        ["localhost.evil.example"],
        ["127.0.0.1.evil.example"],
        ["127.0.0.1:80@evil.example"],
        ["evil.example@127.0.0.1"],
        ["127.0.0.1:evil"],
        ["127.0.0.1/evil"],
        ["0.0.0.0:8337"],
        ["192.168.1.20:8337"],
        ["["],
        ["[::1"],
        ["[evil.example]"],
        ["١٢٧.0.0.1".encode().decode("latin-1")],
        [HERE, "evil.example"],
        ["evil.example", HERE],
    ],
)
def test_a_name_that_anybody_could_have_given_this_machine_is_refused(hosts: list[str]) -> None:
    refused = answer(hosts=hosts)
    assert status(refused) == 421
    assert text_of(refused).startswith("The studio answers to this machine's own names alone")


FOREIGN = [
    "null",
    "",
    "http://evil.example",
    "http://127.0.0.1",
    "http://127.0.0.1:8338",
    "http://localhost:8337",
    "http://127.0.0.1:8337@evil.example",
    "http://evil.example/127.0.0.1:8337",
    "ftp://127.0.0.1:8337",
    "http://[",
]


@pytest.mark.parametrize("origin", FOREIGN)
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_page_of_another_origin_can_ask_for_nothing(origin: str, method: str) -> None:
    refused = answer("/stop", ("Origin", origin), method=method)
    assert status(refused) == 403
    assert text_of(refused).startswith("Another site's page cannot use the studio")


@pytest.mark.parametrize("headers", [(), *((("Origin", origin),) for origin in FOREIGN)])
def test_a_socket_opens_for_a_page_of_the_studio_alone(headers: tuple[tuple[str, str], ...]) -> None:
    assert answer("/_nicegui_ws/socket.io/", *headers, socket=True) == [{"type": "websocket.close", "code": 1008}]
    assert answer("/", ("Origin", f"http://{HERE}"), socket=True) == [{"type": "websocket.accept"}]


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
@pytest.mark.parametrize(
    ("method", "mode", "what"),
    [
        ("GET", "no-cors", "image"),
        ("GET", "no-cors", "script"),
        ("GET", "cors", "empty"),
        ("GET", "navigate", "iframe"),
        ("POST", "navigate", "document"),
        ("POST", "no-cors", "empty"),
    ],
)
def test_what_another_site_embeds_or_fetches_is_refused(site: str, method: str, mode: str, what: str) -> None:
    fetched = ("Sec-Fetch-Site", site), ("Sec-Fetch-Mode", mode), ("Sec-Fetch-Dest", what)
    assert status(answer("/picture", *fetched, method=method)) == 403


def test_a_link_on_another_site_leads_in() -> None:
    followed = ("Sec-Fetch-Site", "cross-site"), ("Sec-Fetch-Mode", "navigate"), ("Sec-Fetch-Dest", "document")
    assert status(answer("/", *followed)) == 200


@pytest.mark.parametrize("length", ["", "abc", "-5", "+5", "1_000", "0x10", "5, 5", "5.0", " 5", "9" * 5000, "\xb2"])
def test_a_length_that_is_no_number_is_refused(length: str) -> None:
    assert status(answer("/", ("Content-Length", length), method="POST")) == 400


def test_what_says_that_it_is_too_large_is_refused_before_any_of_it_comes() -> None:
    with patch("maulstick.studio.server.gate.LARGEST", 2**20):
        refused = answer("/", ("Content-Length", str(2**20 + 1)), method="POST", body=[])
        assert status(answer("/", ("Content-Length", str(2**20)), method="POST")) == 200
    assert (status(refused), text_of(refused)) == (413, "That is larger than 1 MiB; send something smaller.\n")


def test_what_does_not_say_that_it_is_too_large_is_read_no_further() -> None:
    with patch("maulstick.studio.server.gate.LARGEST", 25):
        assert text_of(answer(method="POST", body=[b"1234567890"] * 2)) == "/ 20"
        assert answer(method="POST", body=[b"1234567890"] * 1000) == []


def test_what_comes_too_slowly_is_given_up() -> None:
    with patch("maulstick.studio.server.gate._LONGEST", 0.05):
        assert answer(method="SLOW", body=[b"1"]) == []


@pytest.mark.parametrize(
    "asked", [{}, {"hosts": ["evil.example"]}, {"carries_the_token": False}, {"query": f"token={TOKEN}"}]
)
def test_every_answer_forbids_framing_and_sniffing(asked: dict[str, Any]) -> None:
    headers = headers_of(answer(**asked))
    assert headers["x-frame-options"] == "DENY"
    assert headers["x-content-type-options"] == "nosniff"
    assert "frame-ancestors 'none'" in headers["content-security-policy"]
    assert headers["cross-origin-resource-policy"] == "same-origin"


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/plan",
        "/stop",
        "/picture/plans/a/preview.png",
        "/_nicegui/x",
        "/_nicegui_ws/socket.io/",
        "/surveys",
        "/survey",
    ],
)
@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize("is_local", [True, False])
def test_nothing_but_the_survey_is_had_without_the_token(path: str, method: str, is_local: bool) -> None:
    refused = answer(path, carries_the_token=False, is_local=is_local, method=method)
    assert status(refused) == 403
    assert text_of(refused).startswith("The studio opens by the whole link")
    assert status(answer("/survey/a/b", carries_the_token=False, is_local=is_local, method=method)) == 200
    assert status(answer(path, is_local=is_local, method=method)) == 200


def test_a_studio_for_others_answers_to_any_name() -> None:
    assert status(answer(hosts=["192.168.1.20:8337"], is_local=False)) == 200


@pytest.mark.parametrize("wrong", ["", TOKEN[:-1], TOKEN + "a", TOKEN.upper(), "a" * 60_000, "%C3%BC%FF%00", "ü"])
def test_a_wrong_token_opens_nothing(wrong: str) -> None:
    assert status(answer(carries_the_token=False, query=f"token={wrong}")) == 403
    carries = "Cookie", f"maulstick-8337={wrong.encode().decode('latin-1')}"
    assert status(answer("/", carries, carries_the_token=False)) == 403
    assert status(answer("/", ("Cookie", "maulstick-8337;;=;\x01"), carries_the_token=False)) == 403


def test_a_socket_is_not_opened_by_a_token_in_its_address() -> None:
    ours = ("Origin", f"http://{HERE}")
    refused = [{"type": "websocket.close", "code": 1008}]
    assert answer("/_nicegui_ws/", ours, carries_the_token=False, socket=True, query=f"token={TOKEN}") == refused
    assert answer("/_nicegui_ws/", ours, socket=True) == [{"type": "websocket.accept"}]


@pytest.mark.parametrize("carries", [False, True])
def test_the_token_goes_out_of_the_address_into_a_cookie_that_scripts_and_other_sites_do_not_see(carries: bool) -> None:
    got = headers_of(answer("/styles", carries_the_token=carries, query=f"style=a+b%26c&token={TOKEN}"))
    assert got["refresh"] == "0; url=/styles?style=a+b%26c"
    cookie = got.pop("set-cookie").split("; ")
    assert cookie[0] == f"maulstick-8337={TOKEN}"
    assert {"HttpOnly", "SameSite=strict"} < set(cookie)
    assert TOKEN not in str(got)


def test_the_cookie_outlives_the_browser_so_that_a_bookmark_works() -> None:
    cookie = headers_of(answer(carries_the_token=False, query=f"token={TOKEN}"))["set-cookie"]
    assert "Max-Age=34560000" in cookie


@pytest.mark.parametrize("path", ["//evil.example/", "///evil.example", "/\\evil.example", "//evil.example;url=//evil"])
def test_the_token_leads_to_no_other_site(path: str) -> None:
    where = headers_of(answer(path, query=f"token={TOKEN}"))["refresh"].removeprefix("0; url=")
    assert where.startswith("/")
    assert not where.startswith("//")
    assert "\\" not in where
    assert ";" not in where
