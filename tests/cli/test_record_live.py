import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.recording.mocap import natnet
from maulstick.recording.mocap.take import read_take
from maulstick.strokes.ink import read_ink
from maulstick.strokes.strokes import read_strokes
from tests.cli.conftest import run
from tests.support.recording.natnet_server import Server
from tests.support.recording.simulated_take import Simulated, loops_and_lines, simulate

PEN = ("--pen-length", "139mm")


@pytest.fixture(scope="module")
def drawn() -> Simulated:
    """A short take of a few strokes."""
    return simulate(loops_and_lines(2), seed=1)


def seconds_of(drawn: Simulated) -> str:
    return f"{drawn.take.times[-1] - 1e-3:.6f}"


def test_what_a_pen_draws_while_it_is_recorded_becomes_ink(drawn: Simulated, tmp_path: Path) -> None:
    out = tmp_path / "new" / "cat.ink.npz"
    with Server(drawn.take) as server:
        ran = run("record", "live", "--server", server.address, "--out", out, *PEN, "--seconds", seconds_of(drawn))
    assert (ran.code, ran.stderr) == (0, "")
    plot, kept = out.with_name("cat.contact.png"), out.with_name("cat.take.npz")
    assert ran.stdout.splitlines()[0] == "the tip is 139mm from the rigid body along -y"
    assert ran.stdout.splitlines()[-3:] == [str(out), str(plot), str(kept)]
    assert sorted(os.listdir(out.parent)) == sorted(path.name for path in (out, plot, kept))
    assert len(read_ink(out)) == len(drawn.strokes)
    np.testing.assert_allclose(read_take(kept).canvas_markers, drawn.take.canvas_markers, atol=1e-6)


def test_ctrl_c_ends_a_recording_and_writes_it(drawn: Simulated, tmp_path: Path) -> None:
    def interrupt() -> None:
        time.sleep(0.1)  # for the last frames to arrive
        os.kill(os.getpid(), signal.SIGINT)

    out = tmp_path / "cat.strokes.npz"
    with Server(drawn.take, after=interrupt) as server:
        ran = run("record", "live", "--server", server.address, "--out", out, *PEN)
    assert (ran.code, ran.stderr) == (0, "")
    assert len(read_strokes(out)) == len(drawn.strokes)
    assert len(read_take(tmp_path / "cat.take.npz")) == len(drawn.take)


@pytest.mark.parametrize("kind", [1, 5], ids=["as a server", "what is tracked"])
def test_ctrl_c_before_the_first_frame_leaves_at_once_and_blames_nobody(
    drawn: Simulated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: int
) -> None:
    answer = Server.send

    def interrupt_instead(server: Server, came: int, content: bytes, client: tuple[str, int]) -> None:
        if came == kind:
            os.kill(os.getpid(), signal.SIGINT)
        elif came < kind:
            answer(server, came, content, client)

    monkeypatch.setattr(Server, "send", interrupt_instead)
    with Server(drawn.take) as server:
        ran = run("record", "live", "--server", server.address, "--out", tmp_path / "new" / "cat.ink.npz", *PEN)
    assert ran == (130, "", "")
    assert os.listdir(tmp_path) == []


def test_a_server_that_falls_silent_ends_a_recording_with_a_note(
    drawn: Simulated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(natnet, "_PATIENCE", 1.0)
    with Server(drawn.take) as server:
        ran = run("record", "live", "--server", server.address, "--out", tmp_path / "cat.ink.npz", *PEN)
    assert (ran.code, ran.stderr) == (
        0,
        f"note: no later frame came from {server.address}, so the recording ends there\n",
    )
    assert len(read_ink(tmp_path / "cat.ink.npz")) == len(drawn.strokes)


def test_a_recording_that_shows_no_drawing_is_kept_and_can_be_tried_again(drawn: Simulated, tmp_path: Path) -> None:
    out, kept = tmp_path / "cat.ink.npz", tmp_path / "cat.take.npz"
    upwards = ("--pen-length", "139mm", "--pen-axis=y")
    with Server(drawn.take) as server:
        ran = run("record", "live", "--server", server.address, "--out", out, *upwards, "--seconds", seconds_of(drawn))
    assert ran.code == 2
    assert ran.mistake.endswith(f" (the take is kept; try again with: maulstick record motive {kept})")
    assert os.listdir(tmp_path) == [kept.name]
    assert run("record", "motive", kept, "--out", out, *PEN).code == 0
    assert len(read_ink(out)) == len(drawn.strokes)


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (("--server", "127.0.0.1:1", *PEN, "--seconds", "0"), 2, "--seconds is 0; it must be more than 0"),
        (("--server", "127.0.0.1:1", *PEN, "--seconds", "nan"), 2, "--seconds is nan; it must be more than 0"),
        (("--server", "127.0.0.1:1"), 2, "say where the pen's tip is: with --pen-length, as in 139mm, or"),
        (("--server", "127.0.0.1:1", *PEN, "--merge", "1"), 2, "--merge is '1'; write a time and its unit"),
        (("--server", "127.0.0.1:1", *PEN, "--corner", "left"), 2, "there is no corner 'left'; there are: lower-left"),
        (("--server", "127.0.0.1:0", *PEN), 2, "'127.0.0.1:0' is not the address of a server; write 192.168.1.5"),
        (("--server", "127.0.0.1:1", *PEN, "--local", "192.0.2.1"), 2, "'192.0.2.1' is not an address of this machine"),
        (("--server", "127.0.0.1:1", *PEN), 2, "127.0.0.1:1 does not answer; check the address, the firewall, and"),
    ],
)
def test_what_cannot_be_recorded_is_refused_and_nothing_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], code: int, text: str
) -> None:
    monkeypatch.setattr(natnet, "_PATIENCE", 0.1)
    ran = run("record", "live", *words, "--out", tmp_path / "new" / "cat.ink.npz")
    assert ran.code == code
    assert ran.mistake.startswith(text)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("words", "asked"),
    [
        ((), "127.0.0.1 in unicast"),
        (("--server", "192.0.2.7"), "192.0.2.7 in unicast"),
        (("--multicast",), "127.0.0.1 in multicast"),
    ],
)
def test_motive_is_looked_for_on_this_machine_in_unicast_unless_something_else_is_said(
    words: tuple[str, ...], asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def receive(server: str, *_: object, multicast: bool, **__: object) -> None:
        raise InputError(f"{server} in {'multicast' if multicast else 'unicast'}")

    monkeypatch.setattr(natnet, "receive", receive)
    assert run("record", "live", *words, "--out", tmp_path / "cat.ink.npz", *PEN).mistake == asked


@pytest.mark.parametrize("name", ["cat.ink.npz", "cat.take.npz", "cat.contact.png"])
def test_what_is_there_is_not_lost(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"before")
    ran = run("record", "live", "--server", "127.0.0.1:1", "--out", tmp_path / "cat.ink.npz", *PEN)
    assert ran.code == 1
    assert ran.mistake.startswith(f"{tmp_path / name} is already there; choose another --")
    assert (tmp_path / name).read_bytes() == b"before"


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_recorded(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    ran = run("record", "live", "--server", "127.0.0.1:1", "--out", tmp_path / "file" / "cat.ink.npz", *PEN)
    assert ran.code == 1
    assert ran.mistake.startswith(f"cannot write into the folder {tmp_path / 'file'}: ")


def test_a_terminal_shows_what_comes(drawn: Simulated, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    out = tmp_path / "cat.ink.npz"
    out.write_bytes(b"before")
    with Server(drawn.take) as server:
        words = ("--server", server.address, "--seconds", seconds_of(drawn), "--overwrite")
        ran = run("record", "live", *words, "--out", out, *PEN)
    assert ran.code == 0
    assert " frames, " in ran.stderr
    assert " s, pen seen, canvas seen (Ctrl-C ends)" in ran.stderr
    assert len(read_ink(out)) == len(drawn.strokes)
