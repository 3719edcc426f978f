"""Context managers for the number of torch's threads."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import torch

_AT_START = torch.get_num_threads()  # torch's own choice, read before anything here changes it
_USUAL = ContextVar("usual", default=_AT_START)


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """Let torch use one thread: most tensors here are too small to be shared, and idle threads would burn time.

    The kernels have their own threads. What goes back through a GPU is asked for by this thread, too, which saves the
    way to another one and back at every step.
    """
    with _threads(1), torch.autograd.set_multithreading_enabled(False):
        yield


@contextmanager
def usual_torch_threads() -> Iterator[None]:
    """Let torch use as many threads as at its start: for networks, whose tensors are large."""
    with _threads(_USUAL.get()):
        yield


@contextmanager
def one_thread_for_networks() -> Iterator[None]:
    """Let networks use one thread, too, so that they compute the same bits wherever they are called."""
    before = _USUAL.set(1)
    try:
        yield
    finally:
        _USUAL.reset(before)


@contextmanager
def _threads(count: int) -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
