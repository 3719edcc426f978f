"""Patience with connections: there is room for one more, however many wait."""

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

import pytest
import uvicorn

from maulstick.studio.server import patience

ROOM, MORE = 20, 7
STOP = b"POST /stop HTTP/1.1\r\nHost: here\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


async def stopped(scope: Any, receive: Any, send: Any) -> None:
    """Answer any request, as an application of ASGI."""
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"stopped"})


@asynccontextmanager
async def serving() -> AsyncIterator[tuple[Any, Callable[[], set[Any]]]]:
    """Serve, and yield the address and a function that returns the addresses of all connections."""
    with socket.create_server(("127.0.0.1", 0)) as at:
        config = uvicorn.Config(stopped, http=patience.TimelyProtocol, lifespan="off", log_level="error")
        server = uvicorn.Server(config)
        serving = asyncio.create_task(server.serve(sockets=[at]))
        yield at.getsockname(), lambda: {other.client for other in server.server_state.connections}
        server.should_exit = True
        await serving


async def left_beside(waiting: int) -> tuple[list[bool], bytes]:
    """Return which of so many connections that send nothing are open once STOP is answered, and the answer."""
    async with serving() as (address, connected):
        lines = []
        for _ in range(waiting):
            lines.append(socket.create_connection(address))
            while lines[-1].getsockname() not in connected():
                await asyncio.sleep(0.005)  # they come in this order
        reader, writer = await asyncio.open_connection(*address)
        writer.write(STOP)
        try:
            answer = await reader.read()
        except ConnectionResetError:
            answer = b""
        is_open = [line.getsockname() in connected() for line in lines]
        for line in (*lines, writer):
            line.close()
    return is_open, answer


def test_those_that_wait_longest_make_room_for_whoever_comes_and_may_be_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "LONGEST", 600.0)
    monkeypatch.setattr(patience, "room", lambda: ROOM)
    is_open, answer = asyncio.run(left_beside(ROOM + MORE))
    assert b"stopped" in answer
    assert is_open == [False] * (MORE + 1) + [True] * (ROOM - 1)


def test_no_address_has_more_connections_than_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "LONGEST", 600.0)
    monkeypatch.setattr(patience, "MOST", ROOM)
    assert b"stopped" in asyncio.run(left_beside(ROOM - 1))[1]
    assert asyncio.run(left_beside(ROOM)) == ([True] * ROOM, b"")


def test_there_is_room_for_some_connections() -> None:
    assert patience.room() > 0
