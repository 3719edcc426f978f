from collections.abc import Iterator
from contextvars import ContextVar

import pytest
import torch

from maulstick.rendering import threads
from maulstick.rendering.threads import one_thread_for_networks, one_torch_thread, usual_torch_threads

USUAL = 3  # on any machine, also where torch has one thread


@pytest.fixture(autouse=True)
def three_threads(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    before = torch.get_num_threads()
    monkeypatch.setattr(threads, "_USUAL", ContextVar("usual", default=USUAL))
    torch.set_num_threads(USUAL)
    yield
    torch.set_num_threads(before)


def test_networks_get_torch_s_own_number_of_threads_and_one_where_that_is_asked() -> None:
    with one_torch_thread():
        assert torch.get_num_threads() == 1
        with usual_torch_threads():
            assert torch.get_num_threads() == USUAL
        with one_thread_for_networks(), usual_torch_threads():
            assert torch.get_num_threads() == 1
        with usual_torch_threads():
            assert torch.get_num_threads() == USUAL
    assert torch.get_num_threads() == USUAL


def test_the_thread_that_asks_goes_back_through_what_is_planned_itself_and_others_do_afterwards() -> None:
    walked = torch._C._is_multithreading_enabled  # type: ignore[attr-defined]
    assert walked()
    with one_torch_thread():
        assert not walked()
        with usual_torch_threads():
            assert not walked()
    assert walked()
