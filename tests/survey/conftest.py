"""Fixtures: surveys of small pictures, each of a colour of its own, and a server that answers over a socket."""

import http.client
import io
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlencode

import numpy as np
import pytest
import uvicorn
from PIL import Image
from starlette.types import ASGIApp, Receive, Scope, Send

from maulstick.survey.app import participants
from maulstick.survey.questionnaire import Match, Opinions, Pair, Survey, SurveyHand, build
from maulstick.survey.serve import listening

NAMES = ("Ada", "Bo", "Cy")
SYSTEMS = ("Curves", "Splines")


def sources(folder: Path, motifs: int = 2) -> tuple[Match, Opinions]:
    """Make three hands with so many motifs, and two pairs, of pictures that are made in `folder`."""
    folder.mkdir()
    made = 0

    def picture() -> Path:
        nonlocal made
        made += 1
        path = folder / f"{made}.png"
        Image.new("RGB", (12, 8), (made, 255 - made, 7 * made % 256)).save(path)
        return path

    hands = tuple(
        SurveyHand(name=name, by_hand=picture(), by_machine=tuple(picture() for _ in range(motifs))) for name in NAMES
    )
    pairs = tuple(Pair(reference=picture(), looks=(picture(), picture())) for _ in range(2))
    return Match(hands=hands, asked=2), Opinions(systems=SYSTEMS, pairs=pairs)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Folder of a survey of two questions about three hands, and five about one of two pairs."""
    build(tmp_path / "survey", "Whose strokes?", *sources(tmp_path / "sources"))
    return tmp_path / "survey"


def named(hands: int = 5, motifs: int = 3, pairs: int = 4, asked: int = 2) -> Survey:
    """Make a survey without its pictures."""
    return Survey(
        title="T",
        match=Match(
            hands=tuple(
                SurveyHand(
                    name=f"hand {i}",
                    by_hand=Path(f"h{i}.png"),
                    by_machine=tuple(Path(f"h{i}-m{row}.png") for row in range(motifs)),
                )
                for i in range(hands)
            ),
            asked=asked,
        ),
        opinions=Opinions(
            systems=("old", "new"),
            pairs=tuple(
                Pair(reference=Path(f"p{i}.png"), looks=(Path(f"p{i}-old.png"), Path(f"p{i}-new.png")))
                for i in range(pairs)
            ),
            asked=asked,
        ),
    )


class Answered(NamedTuple):
    status: int
    headers: http.client.HTTPMessage
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()

    @property
    def pixels(self) -> np.ndarray:
        assert self.headers["Content-Type"] == "image/png"
        with Image.open(io.BytesIO(self.body)) as image:
            return np.array(image)


class Server:
    """Server of an application that can be replaced; http.client, unlike browsers, sends paths unchanged."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.app: ASGIApp

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        await self.app(scope, receive, send)

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def ask(self, method: str, path: str, body: str | bytes | None = None, **headers: str) -> Answered:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        try:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            return Answered(answer.status, answer.headers, answer.read())
        finally:
            connection.close()

    def get(self, path: str) -> Answered:
        return self.ask("GET", path)

    def post(self, path: str, **fields: str | int) -> Answered:
        return self.ask("POST", path, urlencode(fields), Origin=self.address)


@pytest.fixture(scope="session")
def running() -> Iterator[Server]:
    """Server for all tests, in a thread of this process: ending one takes longer than most tests."""
    with listening("127.0.0.1", 0) as at:
        answering = Server(at.getsockname()[1])
        server = uvicorn.Server(uvicorn.Config(answering, log_level="error", lifespan="off"))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [at]})
        thread.start()
        try:
            yield answering
        finally:
            server.should_exit = True
            thread.join(30)


@pytest.fixture
def server(running: Server, folder: Path) -> Server:
    """Server of the participants' pages of `folder`."""
    running.app = participants(folder, lambda: None)
    return running
