"""How many threads torch works with."""

from collections.abc import Iterator
from contextlib import contextmanager

import torch

_USUAL = torch.get_num_threads()


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """Most tensors here are too small to share out, and torch's threads would wait for each other busily.

    The kernels have threads of their own.
    """
    with _threads(1):
        yield


@contextmanager
def usual_torch_threads() -> Iterator[None]:
    """As many as torch began with: for networks, whose tensors are large."""
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
