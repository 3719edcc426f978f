"""Work of a GPU that comes again and again, as CUDA graphs."""

from collections.abc import Callable

import torch


class Repeated:
    """Work that is always on the same tensors: a GPU records it when it comes again, and then replays it."""

    def __init__(self, device: torch.device) -> None:
        self._device, self._runs = device, 0
        self._on: object = None
        self._graph: torch.cuda.CUDAGraph | None = None

    def __call__(self, work: Callable[[], None], on: object) -> None:
        """Do the work; on: what stands for its tensors, another where they are others."""
        if self._device.type != "cuda":
            work()
            return
        if on is not self._on:
            self._on, self._runs, self._graph = on, 0, None
        with torch.cuda.device(self._device):
            if self._runs == 1:  # what it launches has been compiled by then
                self._graph = torch.cuda.CUDAGraph()
                with torch.cuda.graph(self._graph, capture_error_mode="thread_local"):
                    work()
            self._runs += 1
            if self._graph is None:
                work()
            else:
                self._graph.replay()
