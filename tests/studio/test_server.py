"""Server: a port or folder in use is refused in one sentence, and Ctrl-C ends it whatever pages are open."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from websockets.sync.client import connect

from maulstick.errors import InputError, how_to_add
from maulstick.studio.server.server import serve
from maulstick.studio.state.folder import Folder
from tests.studio.conftest import COMMAND, RunningStudio
from tests.support.studio.processes import PATIENCE, children_of, have_ended


@pytest.fixture
def taken() -> socket.socket:
    return socket.create_server(("127.0.0.1", 0))


def ran(*words: str, code: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [str(COMMAND)] if code is None else [sys.executable, "-c", code]
    return subprocess.run([*command, "studio", *words], capture_output=True, text=True, timeout=PATIENCE)


def test_a_port_in_use_is_told(tmp_path: Path, taken: socket.socket) -> None:
    with taken, pytest.raises(InputError, match=r"cannot listen at 127\.0\.0\.1, port \d+: Address already in use"):
        serve(tmp_path, "127.0.0.1", taken.getsockname()[1], browse=False)


def test_an_address_of_another_machine_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot listen at 192\.0\.2\.200, port 0: .*; choose another port, or"):
        serve(tmp_path, "192.0.2.200", 0, browse=False)


@pytest.mark.parametrize("host", ["", "evil.example", "127.0.0.1:80", "[::1]", "127.0.0.1\n", "localhost\0", "::g"])
def test_what_is_no_address_is_told_before_anything_is_made(tmp_path: Path, host: str) -> None:
    with pytest.raises(InputError, match="it must be an address of this machine"):
        serve(tmp_path / "studio", host, 0, browse=False)
    assert not (tmp_path / "studio").exists()


def test_a_folder_that_cannot_be_had_is_told_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    refused = ran(str(tmp_path / "file"), "--port", "0", "--no-browser")
    assert (refused.returncode, refused.stdout) == (1, "")
    assert refused.stderr.startswith("maulstick: cannot work in ")
    assert refused.stderr.count("\n") == 1


def test_the_folder_of_another_studio_is_told_in_a_line(tmp_path: Path) -> None:
    with Folder.opened(tmp_path):
        refused = ran(str(tmp_path), "--port", "0", "--no-browser")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == f"maulstick: another studio works in {tmp_path}; use that one, or name another folder\n"


@pytest.mark.parametrize("port", ["99999", "-1", "http"])
def test_what_is_no_port_is_told(tmp_path: Path, port: str) -> None:
    refused = ran(str(tmp_path), "--port", port)
    assert refused.returncode == 2
    assert "Traceback" not in refused.stderr


def test_without_its_extra_the_studio_says_what_to_install(tmp_path: Path) -> None:
    code = "import sys; sys.modules['nicegui'] = None; from maulstick.cli import main; main()"
    refused = ran(str(tmp_path / "studio"), code=code)
    assert refused.returncode == 2
    assert refused.stderr == f"maulstick: the studio needs NiceGUI; {how_to_add('studio')}\n"
    assert not (tmp_path / "studio").exists()


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_a_terminal_shows_a_tablet_the_way_in_where_it_can_come_in(tmp_path: Path, host: str) -> None:
    ours, theirs = os.openpty()
    words = [str(COMMAND), "studio", str(tmp_path / "studio"), "--port", "0", "--no-browser", "--host", host]
    with subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs) as studio:
        os.close(theirs)
        told = b""
        try:
            while b"token=" not in told or (host == "0.0.0.0" and b"point its camera at this" not in told):
                told += os.read(ours, 2**16)
            studio.send_signal(signal.SIGINT)
            assert studio.wait(PATIENCE) == 130
        finally:
            studio.kill()
            os.close(ours)
    assert ("█▀▀▀" in told.decode() or "▄▄▄▄" in told.decode()) == (host == "0.0.0.0")


@pytest.mark.parametrize("times", [1, 2])
def test_ctrl_c_ends_the_studio_and_all_its_processes_while_pages_are_open(tmp_path: Path, times: int) -> None:
    studio = RunningStudio(tmp_path)
    address = studio.url.removeprefix("http://")
    process, origin = studio._process, studio.url
    engine = f"ws://{address}/_nicegui_ws/socket.io/?EIO=4&transport=websocket"
    carries = {"Cookie": "{}={}".format(*studio.cookie)}
    with (
        connect(engine, origin=origin, additional_headers=carries),  # type: ignore[arg-type]
        socket.create_connection(("127.0.0.1", studio.port)) as never_asks,
    ):
        children = children_of(process.pid)
        for _ in range(times):
            process.send_signal(signal.SIGINT)
            time.sleep(0.1)  # two at once would be delivered as one
        assert process.wait(PATIENCE) == 130
        never_asks.settimeout(PATIENCE)
        assert never_asks.recv(1) == b""
    assert "Traceback" not in studio.output, studio.output
    assert have_ended(children)
