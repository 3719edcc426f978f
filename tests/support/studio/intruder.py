"""Client that sends arbitrary requests and messages to the studio."""

import json
import re
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from websockets.sync.client import ClientConnection, connect

from tests.support.studio.processes import PATIENCE


class Intruder:
    """Client on this machine. carries: headers of all its requests."""

    def __init__(self, port: int, *carries: str) -> None:
        self.port = port
        self.here = f"127.0.0.1:{port}"
        self.carries = carries

    def ask(
        self, path: str, *headers: str, method: str = "GET", body: bytes = b"", host: str | None = None
    ) -> "Answer":
        """Ask for a path as it stands, and read to the end of the answer."""
        lines = [
            f"{method} {path} HTTP/1.1",
            f"Host: {host or self.here}",
            "Connection: close",
            *self.carries,
            *headers,
        ]
        if body and not any(line.lower().startswith(("content-length", "transfer-encoding")) for line in headers):
            lines.append(f"Content-Length: {len(body)}")
        return self.say("\r\n".join([*lines, "", ""]).encode("latin-1") + body)

    def say(self, content: bytes) -> "Answer":
        """Say anything at all, and read to the end of the answer."""
        with socket.create_connection(("127.0.0.1", self.port), PATIENCE) as line:
            parts = []
            with suppress(ConnectionError):  # it may be refused before its end
                line.sendall(content)
            with suppress(ConnectionError):
                while part := line.recv(2**16):
                    parts.append(part)
        return Answer(b"".join(parts))

    def upload(self, path: str, content: bytes, name: str = "a.png", parts: int = 1) -> "Answer":
        """Upload a file, as a form of the page does."""
        one = (
            f'--x\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n\r\n'.encode()
            + content
            + b"\r\n"
        )
        return self.ask(
            path, "Content-Type: multipart/form-data; boundary=x", method="POST", body=one * parts + b"--x--\r\n"
        )

    @contextmanager
    def socket(self, origin: str | None = None, query: str = "") -> Iterator[ClientConnection]:
        """Open the page's websocket. origin: the header that is sent, by default the studio's own address."""
        address = f"ws://{self.here}/_nicegui_ws/socket.io/?EIO=4&transport=websocket{query}"
        carries = [tuple(line.split(": ", 1)) for line in self.carries]
        came_from = f"http://{self.here}" if origin is None else origin or None
        with connect(address, origin=came_from, additional_headers=carries, max_size=None) as line:  # type: ignore[arg-type]
            line.recv(PATIENCE)
            yield line

    @contextmanager
    def tab(self, path: str) -> Iterator["Tab"]:
        """A page as a browser opens it, and what it says over its socket."""
        html = self.ask(path).body.decode()
        client = re.search(r"'client_id': '([^']+)'", html)
        assert client is not None, html
        query = f"&client_id={client[1]}&next_message_id=0&implicit_handshake=true&document_id=d&tab_id=t"
        with self.socket(query=query) as line:
            line.send("40")
            assert line.recv(PATIENCE).startswith("40")  # type: ignore[arg-type]
            yield Tab(line, html, client[1])


class Answer:
    """Answer to a request. status: 0 where there was none."""

    def __init__(self, content: bytes) -> None:
        head, _, self.body = content.partition(b"\r\n\r\n")
        lines = head.decode("latin-1").split("\r\n")
        self.status = int(lines[0].split()[1]) if head else 0
        self.headers = {name.lower(): value for name, value in (line.split(": ", 1) for line in lines[1:])}


class Tab:
    """Open page with its websocket. client: id of the page in the studio."""

    def __init__(self, line: ClientConnection, html: str, client: str) -> None:
        self.line, self.html, self.client = line, html, client

    @property
    def listeners(self) -> dict[str, list[tuple[int, str]]]:
        """Ids of elements and of their handlers, by kind of event."""
        found: dict[str, list[tuple[int, str]]] = {}
        for id, element in self.elements.items():
            for event in element.get("events", []):
                found.setdefault(event["type"], []).append((int(id), event["listener_id"]))
        return found

    @property
    def elements(self) -> dict[str, Any]:
        """What the page was sent of each element, by id."""
        told = re.search(r"createApp\(parseElements\(String\.raw`(.*?)`\)", self.html, re.DOTALL)
        assert told is not None
        text = told[1]
        for written, meant in (("&lt;", "<"), ("&gt;", ">"), ("&#96;", "`"), ("&#36;", "$"), ("&amp;", "&")):
            text = text.replace(written, meant)
        elements: dict[str, Any] = json.loads(text)
        return elements

    def tell(self, id: object, listener: object, *arguments: object, client: object = None) -> None:
        """Say that something happened to an element."""
        told = [json.dumps(argument) for argument in arguments]
        event = {"id": id, "client_id": client or self.client, "listener_id": listener, "args": told}
        self.line.send("42" + json.dumps(["event", event]))

    def say(self, message: str) -> None:
        """Say anything at all."""
        self.line.send(message)

    @property
    def answers(self) -> bool:
        """Whether the studio still does what this tab says, in its turn."""
        (going, *_) = self.listeners["sub_pages_open"]
        self.tell(*going, "/nowhere")
        return self.heard("There is no such page")

    def heard(self, text: str) -> bool:
        """Whether the studio soon says something in which that stands."""
        try:
            while True:
                word = self.line.recv(PATIENCE)
                if text in (word if isinstance(word, str) else word.decode()):
                    return True
                if word == "2":
                    self.line.send("3")
        except TimeoutError:
            return False
