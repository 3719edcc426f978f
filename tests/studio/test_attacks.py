"""Attacks on a running studio: after each it answers as before, and has sent nothing but pages."""

import re
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from itertools import cycle
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from maulstick.studio.server.gate import LARGEST
from maulstick.studio.server.patience import LONGEST
from maulstick.studio.state.folder import KINDS
from tests.studio.conftest import RunningStudio
from tests.support.studio.intruder import Intruder

PATIENCE = 60.0  # seconds until a socket that is to be closed must be
HASH = 32 * "a"
SECRET = "nobody outside the folder may read this"
BEGINNING = b'--x\r\nContent-Disposition: form-data; name="file"; filename="a.png"\r\n\r\n'
ODD = [
    None,
    -1,
    1e308,
    10**30,
    "x",
    "\0",
    [],
    [1],
    {},
    {"value": -99},
    {"id": [], "points": {}},
    {"id": 1, "points": [[]]},
]
PANELS = ["/", "/styles", "/plan", "/paints", "/paint", "/survey"]


def _running(root: Path, *words: str) -> Iterator[RunningStudio]:
    running = RunningStudio(root, *words)
    try:
        yield running
    finally:
        running.close()


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningStudio]:
    yield from _running(tmp_path_factory.mktemp("here"))


@pytest.fixture(scope="module")
def abroad(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningStudio]:
    yield from _running(tmp_path_factory.mktemp("abroad"), "--host", "0.0.0.0")


@pytest.fixture
def intruder(running: RunningStudio) -> Iterator[Intruder]:
    """Intruder in a browser on this machine that has the cookie; the studio must still answer afterwards."""
    intruder = Intruder(running.port, "Cookie: {}={}".format(*running.cookie))
    yield intruder
    assert intruder.ask("/").status == 200


@pytest.fixture(params=["abroad", "running"])
def strange(request: pytest.FixtureRequest) -> RunningStudio:
    """Studio for the network, and one for this machine alone, which has other users."""
    studio: RunningStudio = request.getfixturevalue(request.param)
    return studio


@pytest.fixture
def stranger(strange: RunningStudio) -> Intruder:
    """Intruder in the same network, or another user of this machine, without a token."""
    return Intruder(strange.port)


def test_another_sites_page_can_neither_see_nor_stop_anything(intruder: Intruder) -> None:
    for header in ("Origin: http://evil.example", "Origin: null", "Sec-Fetch-Site: cross-site"):
        assert intruder.ask("/stop", header, method="POST").status == 403
        assert intruder.ask("/picture/plans/a/preview.png", header).status == 403
        polling = "/_nicegui_ws/socket.io/?EIO=4&transport=polling"
        for method, body in (("GET", b""), ("POST", b"40")):
            assert intruder.ask(polling, header, method=method, body=body).status == 403
    assert intruder.ask("/", host="evil.example").status == 421
    assert intruder.ask("/", f"Host: {intruder.here}", host="evil.example").status == 421
    assert intruder.ask("/stop", f"Origin: http://{intruder.here}", method="POST").status == 200


@pytest.mark.parametrize("origin", ["", "null", "http://evil.example", "http://localhost:1"])
def test_another_sites_page_gets_no_socket(intruder: Intruder, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused, intruder.socket(origin):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/nothing",
        "/picture/plans/a/preview.png",
        "/picture/plans/a/order/x.jpg",
        "/live/a/1",
        "/favicon.ico",
        "/_nicegui/nothing",
        "/_nicegui_ws/socket.io/",
        "/survey/",
        "/survey/a/b",
        "/stop",
    ],
)
def test_every_answer_keeps_frames_and_guesses_out(intruder: Intruder, path: str) -> None:
    headers = intruder.ask(path).headers
    assert headers["x-frame-options"] == "DENY"
    assert headers["x-content-type-options"] == "nosniff"
    assert "frame-ancestors 'none'" in headers["content-security-policy"]


def test_what_a_page_loads_keeps_frames_and_guesses_out(intruder: Intruder) -> None:
    loaded = re.findall(r'"(/_nicegui/[^"]+\.(?:js|css))"', intruder.ask("/").body.decode())
    assert len(loaded) > 3
    for path in loaded:
        answer = intruder.ask(path)
        assert (answer.status, answer.headers.get("x-frame-options")) == (200, "DENY"), path


@pytest.mark.parametrize(
    "path",
    [
        "/picture/plans/../../{}",
        "/picture/plans/%2e%2e/%2e%2e/{}",
        "/picture/plans/..%2f..%2f{}/preview.png",
        "/picture/plans/..%5c..%5c{}/preview.png",
        "/picture/plans/%252e%252e%252f{}/preview.png",
        "/picture/plans/link/preview.png",
        "/picture/plans/folder/preview.png",
        "/file/plans/link/preview.png",
        "/picture/plans/link/order/00.jpg",
        "/picture/plans/link/order/-1.jpg",
        "/picture/plans/link/order/1e9.jpg",
        "/picture/plans/link/order/" + "9" * 250 + ".jpg",
        "/picture/plans/link/order/" + "9" * 5000 + ".jpg",
        "/picture/plans/link/request.json",
        "/picture/plans/link/%00/preview.png",
        "/picture/plans/link%00/preview.png",
        "/picture/plans/link%0a/preview.png",
        "/picture/plans/" + "a" * 5000 + "/preview.png",
        "/picture/trash/link/preview.png",
        "/picture/%2e%2e/{}/preview.png",
        "/picture/con/nul/aux",
        "/sheet/..%2f..%2f{}",
        f"/sheet/{HASH}.png",
        "/live/..%2f..%2f{}/1",
        "/survey/..%2f..%2f{}/x",
    ],
)
def test_no_path_leads_out_of_what_is_shown(
    intruder: Intruder, running: RunningStudio, tmp_path: Path, path: str
) -> None:
    outside = tmp_path / "preview.png"
    outside.write_text(SECRET)
    plan = running.folder / "plans" / "link"
    (plan / "order").mkdir(parents=True, exist_ok=True)
    sheet = running.folder / ".cache" / "sheets" / f"{HASH}.png"
    sheet.parent.mkdir(parents=True, exist_ok=True)
    own = (plan / "preview.png", plan / "order" / "00.jpg", plan / "request.json", plan.with_name("folder"))
    for link in (*own, sheet):
        link.unlink(missing_ok=True)
        link.symlink_to(tmp_path if link.name == "folder" else outside)
    answer = intruder.ask(path.format(str(outside).lstrip("/")))
    assert answer.status in (404, 422)
    assert SECRET.encode() not in answer.body


def test_what_is_in_the_folder_itself_is_shown(intruder: Intruder, running: RunningStudio) -> None:
    plan = running.folder / "plans" / "cat"
    plan.mkdir()
    (plan / "preview.png").write_bytes(b"picture")
    assert intruder.ask("/picture/plans/cat/preview.png").body == b"picture"


@pytest.mark.parametrize("length", ["abc", "1_000", "+5", "-5", "", "0x10", "5, 6", str(LARGEST + 1), "9" * 30])
def test_a_false_length_is_refused_at_once(intruder: Intruder, length: str) -> None:
    path = "/page/a/upload/1"
    assert intruder.ask(path, f"Content-Length: {length}", method="POST", body=b"12345").status in (400, 413)


def test_a_body_that_ends_before_its_length_is_given_up_without_a_word(intruder: Intruder) -> None:
    head = f"POST /stop HTTP/1.1\r\nHost: {intruder.here}\r\nContent-Length: 1000000\r\n\r\n".encode()
    with intruder.tab("/plan") as tab:
        form = head.replace(b"/stop", f"/page/{tab.client}/upload/{_chooser(tab.html)}".encode())
        form = form.replace(b"\r\n\r\n", b"\r\nContent-Type: multipart/form-data; boundary=x\r\n\r\n")
        for what in (head, form):
            with socket.create_connection(("127.0.0.1", intruder.port)) as line:
                line.sendall(what + b"--x\r\n")


def test_a_body_in_parts_without_end_is_cut_off(intruder: Intruder) -> None:
    part = b"10000\r\n" + bytes(2**16) + b"\r\n"
    with intruder.tab("/plan") as tab:
        answer = intruder.ask(
            f"/page/{tab.client}/upload/{_chooser(tab.html)}",
            "Content-Type: multipart/form-data; boundary=x",
            "Transfer-Encoding: chunked",
            method="POST",
            body=b"%x\r\n%b\r\n" % (len(BEGINNING), BEGINNING) + part * (LARGEST // 2**16 + 8),
        )
    assert answer.status != 200


def test_an_upload_of_ten_thousand_parts_is_refused(intruder: Intruder) -> None:
    with intruder.tab("/plan") as tab:
        path = f"/page/{tab.client}/upload/{_chooser(tab.html)}"
        assert intruder.upload(path, b"x", parts=10_000).status == 400


@pytest.mark.parametrize(
    "name", ["../../evil.png", "/etc/evil.png", "..\\evil.png", "<img src=x onerror=alert(1)>.png"]
)
def test_an_upload_that_is_no_picture_is_told_and_leaves_nothing(
    intruder: Intruder, running: RunningStudio, name: str
) -> None:
    before = sorted(running.folder.parent.rglob("*"))
    with intruder.tab("/plan") as tab:
        path = f"/page/{tab.client}/upload/{_chooser(tab.html)}"
        assert intruder.upload(path, b"<svg onload=alert(1)>", name).status == 200
        assert tab.heard("is not a picture that can be read; save it as one of")
    assert sorted(running.folder.parent.rglob("*")) == before


def test_an_upload_that_holds_no_settings_is_told_and_leaves_nothing(
    intruder: Intruder, running: RunningStudio
) -> None:
    before = sorted(running.folder.parent.rglob("*"))
    with intruder.tab("/plan") as tab:
        first = re.findall(r"/page/[^/]+/upload/(\d+)", tab.html)[0]
        path = f"/page/{tab.client}/upload/{first}"
        assert intruder.upload(path, b"[" * 100_000, "../../evil.json").status == 200
        assert tab.heard("holds no settings of a plan")
    assert sorted(running.folder.parent.rglob("*")) == before


@pytest.mark.parametrize(
    "message",
    [
        "42",
        "42[]",
        '42["event",null]',
        '42["event",{"client_id":[]}]',
        '42["handshake",5]',
        '42["nothing",{}]',
        '451-["event",{"_placeholder":true,"num":0}]',
        "9",
        "",
        "4" * 5_000_000,
        '42["event",' + "[" * 100_000,
    ],
    ids=lambda message: message[:20],
)
def test_nonsense_on_the_socket_harms_nobody(intruder: Intruder, message: str) -> None:
    with intruder.tab("/") as other, intruder.socket() as line:
        line.send("40")
        with suppress(ConnectionClosed):
            line.send(message)
        assert other.answers


def test_what_no_browser_says_changes_nothing(intruder: Intruder, running: RunningStudio) -> None:
    before = {kind: sorted((running.folder / kind).rglob("*")) for kind in (*KINDS, "trash")}
    for panel in PANELS:
        with intruder.tab(panel) as tab:
            for kind, listeners in tab.listeners.items():
                if kind.startswith(("click", "sub_pages", "blur")):  # these do what they say
                    continue
                for id, listener in listeners:
                    for value in ODD:
                        tab.tell(id, listener, value)
            tab.tell(10**9, "x", 1)
            tab.tell(4, [], 1)
            tab.tell(4, "x", 1, client="another")
            assert tab.answers
            assert intruder.ask(panel).status == 200
    assert {kind: sorted((running.folder / kind).rglob("*")) for kind in before} == before


def test_two_hundred_sockets_that_never_read_do_not_keep_the_studio_from_answering(intruder: Intruder) -> None:
    with ExitStack() as open_sockets:
        for _ in range(100):
            open_sockets.enter_context(socket.create_connection(("127.0.0.1", intruder.port)))
        with intruder.tab("/") as tab:
            for _ in range(100):
                line = open_sockets.enter_context(socket.create_connection(("127.0.0.1", intruder.port)))
                query = f"EIO=4&transport=websocket&client_id={tab.client}&implicit_handshake=true"
                line.sendall(
                    f"GET /_nicegui_ws/socket.io/?{query} HTTP/1.1\r\nHost: {intruder.here}\r\n"
                    f"Origin: http://{intruder.here}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n".encode()
                )
            assert intruder.ask("/").status == 200
            assert intruder.ask("/stop", method="POST").status == 200


def test_a_request_whose_head_never_ends_is_given_up_and_stop_is_heard_meanwhile(intruder: Intruder) -> None:
    heads = (b"", b"POST /stop HT", b"GET / HTTP/1.1\r\nHost: a\r\nX-Slow: ")
    with ExitStack() as open_sockets:
        lines = [open_sockets.enter_context(socket.create_connection(("127.0.0.1", intruder.port))) for _ in range(150)]
        for line, head in zip(lines, cycle(heads), strict=False):
            line.sendall(head)
        assert intruder.ask("/stop", method="POST").status == 200
        for line in lines:
            line.settimeout(PATIENCE)
            assert line.recv(1) == b"", "closed, and nothing was said"


def test_a_page_stays_open_however_long_nothing_happens(intruder: Intruder) -> None:
    with intruder.tab("/") as tab:
        time.sleep(LONGEST + 2)
        tab.tell(4, "x", 1)
        assert tab.answers


def test_without_the_token_nothing_is_had_but_the_survey(stranger: Intruder) -> None:
    paths = [*PANELS, "/stop", "/picture/plans/a/preview.png", "/favicon.ico", "/_nicegui/x", "/survey", "//survey/x"]
    for path in [
        *paths,
        "/_nicegui_ws/socket.io/?EIO=4&transport=polling",
        "/survey%2f../plan",
        "/?token=",
        "/?token=a",
    ]:
        for method in ("GET", "POST", "OPTIONS"):
            answer = stranger.ask(path, method=method)
            expected = 404 if path.startswith("/survey%2f") else 403
            assert (answer.status, b"_nicegui" in answer.body) == (expected, False), path
    assert stranger.upload("/page/a/upload/1", b"x").status == 403
    assert stranger.ask("/survey/a/b").body.count(b"There is no such page") == 1
    assert b"client_id" not in stranger.ask("/survey/../plan").body
    with pytest.raises(InvalidStatus) as refused, stranger.socket():
        pass
    assert refused.value.response.status_code == 403


def test_the_link_with_its_token_leads_in_and_the_token_is_nowhere_else(
    stranger: Intruder, strange: RunningStudio
) -> None:
    token = strange.token
    came = stranger.ask(f"/styles?token={token}")
    assert came.headers["refresh"] == "0; url=/styles"
    carries = f"Cookie: {came.headers['set-cookie'].split(';')[0]}"
    invited = Intruder(stranger.port, carries)
    inside = invited.ask("/styles")
    assert inside.status == 200
    assert token.encode() not in inside.body
    with invited.socket():
        pass
    invited.ask(f"/nothing?token={token}")
    assert strange.output.count(token) == 1


def test_strangers_leave_no_trace_in_the_terminal(abroad: RunningStudio) -> None:
    stranger = Intruder(abroad.port)
    for path in ("/", "/nothing", "/?token=a", "/%00", "//survey/x"):
        assert stranger.ask(path).status in (400, 403, 404)
    assert len(abroad.output.splitlines()) == 2, abroad.output


def _chooser(html: str) -> str:
    """Find the last element that takes uploads: of a form of a plan, the one for pictures."""
    return re.findall(r"/page/[^/]+/upload/(\d+)", html)[-1]
