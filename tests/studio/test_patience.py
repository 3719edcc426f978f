"""Patience with connections: there is room for one more, however many wait."""

import asyncio
import socket
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


async def left_beside(waiting: int) -> tuple[list[bool], bytes]:
    """Return which of so many connections that send nothing are open once STOP is answered, and the answer."""
    with socket.create_server(("127.0.0.1", 0)) as at:
        config = uvicorn.Config(stopped, http=patience.TimelyProtocol, lifespan="off", log_level="error")
        server = uvicorn.Server(config)
        serving = asyncio.create_task(server.serve(sockets=[at]))
        lines = []
        for _ in range(waiting):
            lines.append(socket.create_connection(at.getsockname()))
            here = lines[-1].getsockname()
            while here not in {other.client for other in server.server_state.connections}:
                await asyncio.sleep(0.005)  # they come in this order
        reader, writer = await asyncio.open_connection(*at.getsockname())
        writer.write(STOP)
        answer = await reader.read()
        left = {other.client for other in server.server_state.connections}
        is_open = [line.getsockname() in left for line in lines]
        for line in (*lines, writer):
            line.close()
        server.should_exit = True
        await serving
    return is_open, answer


def test_those_that_wait_longest_make_room_for_whoever_comes_and_may_be_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patience, "LONGEST", 600.0)
    monkeypatch.setattr(patience, "room", lambda: ROOM)
    is_open, answer = asyncio.run(left_beside(ROOM + MORE))
    assert b"stopped" in answer
    assert is_open == [False] * (MORE + 1) + [True] * (ROOM - 1)


def test_there_is_room_for_some_connections() -> None:
    assert patience.room() > 0
