import builtins
import gc
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from natnet import NatNetClient, nat_net_client
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError, how_to_add
from maulstick.recording.mocap import natnet
from maulstick.recording.mocap.natnet import Seen, receive
from maulstick.recording.mocap.take import Take
from tests.support.recording import natnet_server
from tests.support.recording.natnet_server import Server

FRAMES = 40
_CONNECT, _REQUEST_MODELS, _FRAME = 0, 4, 7


def forever() -> bool:
    return True


def received(server: Server, frames: int, **options: Any) -> Take:
    """What comes until there are so many frames."""
    said: list[Seen] = []
    return receive(server.address, lambda: not said or said[-1].frames < frames, watch=said.append, **options)


@pytest.fixture(autouse=True)
def nothing_is_left_open_or_running(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    hasty = SimpleNamespace(time=time.time, sleep=lambda _: time.sleep(0.005))  # the package rests 0.1 s at a time
    monkeypatch.setattr(nat_net_client, "time", hasty)
    running = threading.active_count()
    yield
    gc.collect(1)  # a socket left open warns, which fails the test
    assert threading.active_count() == running


@pytest.fixture
def take() -> Take:
    """A take in single precision, which is what is streamed, with a pen and markers that are lost at times."""
    rng = np.random.default_rng(3)

    def places(*shape: int) -> np.ndarray:
        return rng.uniform(-1, 1, (*shape, 3)).astype(np.float32).astype(np.float64)

    rotations = Rotation.random(FRAMES, rng=rng).as_quat().astype(np.float32).astype(np.float64)
    take = Take(100 + np.arange(FRAMES) / 240, places(FRAMES), rotations, places(FRAMES, 4), places(FRAMES, 3))
    take.pen_positions[10:15] = take.pen_rotations[10:15] = take.pen_markers[8:20, 1] = np.nan
    take.canvas_markers[30:32, 2] = np.nan
    return take


def assert_same(got: Take, want: Take, frames: list[int] | None = None) -> None:
    for name, values in vars(want).items():
        np.testing.assert_array_equal(getattr(got, name), values if frames is None else values[frames], err_msg=name)


@pytest.mark.parametrize("names", [("Pen", "Canvas"), ("Stylus",)])
@pytest.mark.parametrize("version", [(3, 0), (3, 1), (4, 0), (4, 1), (4, 2)])
def test_what_is_received_is_what_was_sent(take: Take, version: tuple[int, int], names: tuple[str, ...]) -> None:
    with Server(take, version=version, names=names) as server:
        assert_same(received(server, FRAMES), take)


def test_frames_that_are_lost_on_the_way_are_missing_and_nothing_else(
    take: Take, capsys: pytest.CaptureFixture[str]
) -> None:
    with Server(take, lost={3, 4, 35}, garbled=True) as server:
        assert_same(received(server, FRAMES - 3), take, [i for i in range(FRAMES) if i not in {3, 4, 35}])
    assert capsys.readouterr() == ("", "")


def test_frames_that_come_twice_or_late_are_left_out(take: Take) -> None:
    sent = replace(take, times=take.times.copy())
    sent.times[20:23] = take.times[19], take.times[5], np.nan
    with Server(sent) as server:
        assert_same(received(server, FRAMES - 3), take, [i for i in range(FRAMES) if i not in {20, 21, 22}])


def test_a_server_whose_clock_began_again_ends_the_recording_and_loses_nothing(
    take: Take, monkeypatch: pytest.MonkeyPatch
) -> None:
    sent: list[int] = []

    class Looping(Server):
        def frame(self, index: int) -> bytes:
            sent.append(index)
            return super().frame(index % 5)

    monkeypatch.setattr(natnet, "_PATIENCE", 1.0)
    monkeypatch.setattr(natnet_server, "_BETWEEN", 0.01)
    seconds, *others = vars(take).values()
    lasting = Take(np.append(seconds, 1e3 + np.arange(360)), *(values[np.arange(400) % FRAMES] for values in others))
    with Looping(lasting) as server:
        assert_same(receive(server.address, forever), take, list(range(5)))
        assert len(sent) < len(lasting), "the server goes on sending what can no longer be kept"


def test_markers_that_are_not_streamed_are_where_the_rigid_body_puts_them(take: Take) -> None:
    still = Take(*list(vars(take).values())[:4], np.broadcast_to(take.canvas_markers[0], (FRAMES, 3, 3)).copy())
    with Server(still, labelled=False) as server:
        got = received(server, FRAMES)
    np.testing.assert_allclose(got.canvas_markers, still.canvas_markers, atol=1e-6)
    seen = np.isfinite(take.pen_positions[:, 0])
    want = take.pen_positions[seen] + Rotation.from_quat(take.pen_rotations[seen]).apply([3e-3, 4e-3, 5e-3])
    np.testing.assert_allclose(got.pen_markers[seen, 1], want, atol=1e-6)
    assert np.isnan(got.pen_markers[~seen]).all()


def test_a_recording_goes_on_until_it_is_told_to_stop(take: Take) -> None:
    with Server(take) as server:
        assert 12 <= len(received(server, 12)) <= FRAMES


@pytest.mark.parametrize("names", [("Pen", "Canvas"), ("Pen",)])
@pytest.mark.parametrize(("frames", "pen", "canvas"), [(12, False, True), (30, True, True), (31, True, False)])
def test_what_is_seen_is_said(take: Take, names: tuple[str, ...], frames: int, pen: bool, canvas: bool) -> None:
    said: list[Seen] = []
    first = Take(*(values[:frames] for values in vars(take).values()))
    with Server(first, names=names) as server:
        receive(server.address, lambda: not said or said[-1].frames < frames, watch=said.append)
    assert said[-1] == Seen(frames, take.times[frames - 1] - take.times[0], pen, canvas)


def test_a_server_that_falls_silent_ends_the_recording_and_loses_nothing(
    take: Take, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(natnet, "_PATIENCE", 1.0)
    with Server(take) as server:
        assert_same(receive(server.address, forever), take)


@pytest.mark.parametrize(
    ("fault", "text"),
    [
        (
            {"deaf": [_CONNECT]},
            "{} does not answer; check the address, the firewall, and that Motive there streams in unicast",
        ),
        (
            {"deaf": [_REQUEST_MODELS]},
            "{} does not say what it tracks that can be read; switch on streaming in Motive, with rigid bodies, "
            "labelled and unlabelled markers",
        ),
        (
            {"deaf": [_FRAME]},
            "{} sends no frames that can be read; switch on streaming in Motive, with rigid bodies, labelled and "
            "unlabelled markers",
        ),
        ({"version": (2, 10)}, "{} streams NatNet 2.10.0.0; it must be 3 or 4, those of Motive 2 and 3"),
        ({"version": (5, 0)}, "{} streams NatNet 5.0.0.0; it must be 3 or 4, those of Motive 2 and 3"),
        (
            {"names": ("A", "B")},
            "there is no telling which is the canvas; name it (sheet), a rigid body of exactly three markers, or "
            "let exactly three markers be loose: there are the rigid bodies 'A' (4 markers), 'B' (3 markers) and 0 "
            "loose markers",
        ),
        ({"names": ("Pen", "Pen")}, "two rigid bodies are called 'Pen'; rename one in Motive, and try again"),
        (
            {"names": ()},
            "there is no telling which rigid body is the pen; name it (pen): there are no rigid bodies and 3 loose "
            "markers",
        ),
    ],
)
def test_a_server_that_cannot_be_recorded_is_one_line(
    take: Take, monkeypatch: pytest.MonkeyPatch, fault: Mapping[str, Any], text: str
) -> None:
    monkeypatch.setattr(natnet, "_PATIENCE", 0.5)
    with Server(take, **fault) as server, pytest.raises(InputError) as caught:
        receive(server.address, forever)
    assert str(caught.value) == text.format(server.address)


def test_names_choose_the_pen_and_the_canvas(take: Take) -> None:
    with Server(take, names=("A", "B")) as server:
        assert_same(received(server, FRAMES, pen="A", canvas="B"), take)


def test_what_answers_without_speaking_natnet_is_one_line(take: Take, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Server, "send", lambda server, kind, content, client: server.socket.sendto(b"\x01", client))
    with Server(take) as server, pytest.raises(InputError, match="answers, but not as Motive does"):
        receive(server.address, forever)


def test_stopping_before_the_first_frame_records_nothing(take: Take) -> None:
    with Server(take) as server, pytest.raises(InputError, match="stopped before the first frame had come"):
        receive(server.address, lambda: False)


@pytest.mark.parametrize(
    ("server", "local", "text"),
    [
        ("", None, "'' is not the address of a server; write 192.168.1.5 or 192.168.1.5:1510"),
        ("127.0.0.1:70000", None, "'127.0.0.1:70000' is not the address of a server; write"),
        ("127.0.0.1:x", None, "'127.0.0.1:x' is not the address of a server; write"),
        ("x" * 70, None, f"there is no machine '{'x' * 70}' to be found; check server"),
        ("127.0.0.1", "192.0.2.1", "'192.0.2.1' is not an address of this machine; leave out local"),
        ("127.0.0.1", "x" * 70, f"'{'x' * 70}' is not an address of this machine; leave out local"),
    ],
)
def test_addresses_that_cannot_be_are_refused(server: str, local: str | None, text: str) -> None:
    with pytest.raises(InputError) as caught:
        receive(server, forever, local=local)
    assert str(caught.value).startswith(text)


def test_multicast_is_asked_for_where_it_is_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    def connect(client: NatNetClient, timeout: float) -> None:
        assert client.use_multicast
        assert (client.server_ip_address, client.local_ip_address) == ("127.0.0.1", "127.0.0.1")
        raise TimeoutError

    monkeypatch.setattr(NatNetClient, "connect", connect)
    with pytest.raises(InputError, match=r"127\.0\.0\.1 does not answer; .* streams in multicast"):
        receive("127.0.0.1", forever, multicast=True)


def test_a_port_that_is_taken_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(client: NatNetClient, timeout: float) -> None:
        raise OSError(98, "Address already in use")

    monkeypatch.setattr(NatNetClient, "connect", refuse)
    with pytest.raises(InputError) as caught:
        receive("127.0.0.1", forever)
    assert str(caught.value) == "cannot listen to 127.0.0.1 in unicast: Address already in use"


def test_without_the_package_the_error_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    imported: Callable[..., object] = builtins.__import__

    def without(name: str, *rest: object, **options: object) -> object:
        if name == "natnet":
            raise ImportError(name)
        return imported(name, *rest, **options)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(InputError) as caught:
        receive("127.0.0.1", forever)
    assert str(caught.value) == (f"recording live needs the package natnet; {how_to_add('mocap')}")
