"""Context managers for the number of torch's threads."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch

_USUAL = torch.get_num_threads()  # torch's own choice, read before anything here changes it


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """Let torch use one thread: most tensors here are too small to be shared, and idle threads would burn time.

    The kernels have their own threads.
    """
    with _threads(1):
        yield


@contextmanager
def usual_torch_threads() -> Iterator[None]:
    """Let torch use as many threads as at its start: for networks, whose tensors are large."""
    with _threads(_USUAL):
        yield


@contextmanager
def _threads(count: int) -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(count)
    try:
        yield
    finally:
        torch.set_num_threads(before)
