"""Time and memory of the CPU kernels: one JSON object a line, every key in every row, null where it does not apply.

    python benchmarks/kernel.py

strokes, points, px, half_width: what is drawn; strokes are arcs of 0.19 of the side, half_width is a fraction of the
    side, colours have three channels. `darkness` draws each stroke on a square of its own.
ms_forward, ms_backward: medians of 8 warm runs. Gradients are asked for points, thickness and colours.
dense_ms_per_stroke: the dense reference, forward and backward, float32, one stroke at a time; the median of 8 runs that
    take turns with those of the kernel. Left out where a single stroke takes seconds and gigabytes.
speedup: dense_ms_per_stroke * strokes / (ms_forward + ms_backward).
extra_mib: how much more memory a fresh process holds at the worst moment of three forward and backward passes than just
    before them (VmHWM, reset through /proc/self/clear_refs, less VmRSS, after malloc_trim), less the bytes of the
    result and of the gradients asked for. Linux only.
"""

import ctypes
import json
import math
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor

from maulstick.brush.kernels import cpu, reference

LENGTH = 0.19  # of the side
RUNS = 8


@dataclass(frozen=True)
class Row:
    """What is measured."""

    name: str
    strokes: int
    points: int
    px: int
    half_width: float


ROWS = [
    *(Row("composite", 400, 32, px, half_width) for px in (256, 1024) for half_width in (0.004, 0.01)),
    *(Row("composite", 4000, 32, 1024, half_width) for half_width in (0.004, 0.01)),
    *(Row("darkness", 100, 32, 256, half_width) for half_width in (0.004, 0.01)),
]


class Task:
    """One row's tensors, and a pass forward and back through them."""

    def __init__(self, row: Row):
        generator = torch.Generator().manual_seed(0)
        first = 2 * math.pi * torch.rand(row.strokes, 1, generator=generator)
        bend = torch.randn(row.strokes, 1, generator=generator)
        heading = first + bend * torch.linspace(-0.5, 0.5, row.points)
        path = torch.stack([heading.cos(), heading.sin()], dim=-1).cumsum(1) * LENGTH / (row.points - 1)
        place = torch.rand(row.strokes, 1, 2, generator=generator)
        self.row = row
        self.points = (row.px * (path - path.mean(1, keepdim=True) + place)).requires_grad_()
        self.thickness = torch.full((row.strokes, row.points), row.half_width * row.px).requires_grad_()
        self.colours = torch.rand(row.strokes, 3, generator=generator).requires_grad_()
        self.numbers = torch.tensor([1.5]), torch.tensor([0.2]), torch.tensor([0.9])  # c, q, o
        self.canvas = torch.ones(3, row.px, row.px)
        images = 3 if row.name == "composite" else row.strokes
        self.weights = torch.randn(images, row.px, row.px, generator=generator)

    def forward(self, darkness: Callable[..., Tensor], composite: Callable[..., Tensor], strokes: slice) -> Tensor:
        """What these strokes look like."""
        stroke = self.points[strokes], self.thickness[strokes]
        if self.row.name == "darkness":
            return darkness(*stroke, *self.numbers, height=self.row.px, width=self.row.px)
        return composite(self.canvas, *stroke, self.colours[strokes], *self.numbers)

    def backward(self, out: Tensor) -> tuple[Tensor, ...]:
        """The gradients asked for."""
        leaves = [self.points, self.thickness] + [self.colours] * (self.row.name == "composite")
        return torch.autograd.grad(out, leaves, self.weights[: out.shape[0]])

    def fast(self) -> tuple[float, float]:
        """Milliseconds forward and back."""
        start = time.perf_counter()
        out = self.forward(cpu.darkness, cpu.composite, slice(None))
        middle = time.perf_counter()
        self.backward(out)
        return 1e3 * (middle - start), 1e3 * (time.perf_counter() - middle)

    def dense(self, stroke: int) -> float:
        """Milliseconds forward and back for one stroke."""
        start = time.perf_counter()
        self.backward(self.forward(reference.darkness, reference.composite, slice(stroke, stroke + 1)))
        return 1e3 * (time.perf_counter() - start)


def time_of(row: Row) -> dict[str, float | None]:
    """The four keys about time."""
    task, with_dense = Task(row), row.px <= 256
    until = time.perf_counter() + 1
    while time.perf_counter() < until:
        task.fast()
    if with_dense:
        task.dense(0)
    fast, dense = [], []
    for run in range(RUNS):
        if with_dense:
            dense.append(task.dense(run))
        for _ in range(2):  # the dense run has filled the caches with something else
            task.fast()
        fast.append(task.fast())
    forward, backward = (statistics.median(times) for times in zip(*fast, strict=True))
    per_stroke = statistics.median(dense) if with_dense else None
    return {
        "ms_forward": round(forward, 3),
        "ms_backward": round(backward, 3),
        "dense_ms_per_stroke": per_stroke and round(per_stroke, 3),
        "speedup": per_stroke and round(per_stroke * row.strokes / (forward + backward)),
    }


def extra_mib_of(row: Row) -> float | None:
    """Measured in this process, which has rendered nothing else of size."""

    def mib(field: str) -> float:
        return int(Path("/proc/self/status").read_text().split(f"{field}:")[1].split()[0]) / 1024

    def once(task: Task) -> int:
        out = task.forward(cpu.darkness, cpu.composite, slice(None))
        return sum(x.numel() * x.element_size() for x in (out, *task.backward(out)))

    if not sys.platform.startswith("linux"):
        return None
    once(Task(Row(row.name, 2, row.points, 64, row.half_width)))  # loads what is loaded at the first use
    task = Task(row)
    ctypes.CDLL(None).malloc_trim(0)
    before = mib("VmRSS")
    Path("/proc/self/clear_refs").write_text("5")
    asked_for = max(once(task) for _ in range(3))
    return round(mib("VmHWM") - before - asked_for / 2**20, 1)


def main() -> None:
    if len(sys.argv) > 1:  # a process of its own for the memory of one row
        print(json.dumps(extra_mib_of(Row(**json.loads(sys.argv[1])))))
        return
    for row in ROWS:
        memory = subprocess.run(
            [sys.executable, __file__, json.dumps(asdict(row))], check=True, capture_output=True, text=True
        )
        print(json.dumps({**asdict(row), **time_of(row), "extra_mib": json.loads(memory.stdout)}), flush=True)


if __name__ == "__main__":
    main()
