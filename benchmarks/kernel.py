"""Time and memory of the fast kernels: one JSON object per line, every key in every row, null where it does not apply.

    .venv/bin/python benchmarks/kernel.py [--device cuda]

device: where it is drawn. On a GPU only 400 strokes at 256 pixels, 4000 at 1024 and 2048 at 1344 are; times end when it
    is done.
strokes, points, px, width, half_width: what is drawn, px high; strokes are arcs of 0.19 of the height, half_width is a
    fraction of it and half_width_px the same in pixels, colours have three channels. `darkness` draws each stroke on an
    image of its own.
ms_forward, ms_backward: medians of 8 warm runs. Gradients are asked for points, thickness and colours.
dense_ms_per_stroke: the dense reference, forward and backward, float32, one stroke at a time; the median of 8 runs that
    take turns with those of the kernel. Left out where a single stroke takes seconds and gigabytes.
speedup: dense_ms_per_stroke * strokes / (ms_forward + ms_backward).
extra_mib: how much more memory a fresh process holds at the worst moment of three forward and backward passes than just
    before them (VmHWM, reset through /proc/self/clear_refs, less VmRSS, after malloc_trim), less the bytes of the
    result and of the gradients asked for. Linux only. On a GPU: what torch has allocated there.
bandwidth_share: how long the arguments, the result and all gradients, each moved once at the speed at which this GPU
    copies 1 GiB, would take, as a fraction of ms_forward + ms_backward.
"""

import argparse
import ctypes
import json
import math
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType

import torch
from torch import Tensor

from maulstick.rendering.kernels import reference
from maulstick.rendering.kernels.render import kernels_for

LENGTH = 0.19  # of the side
RUNS = 8


@dataclass(frozen=True)
class Row:
    """What is measured."""

    name: str
    strokes: int
    points: int
    px: int
    width: int
    half_width: float

    @property
    def printed(self) -> dict[str, str | float]:
        """The keys about what is drawn."""
        return asdict(self) | {"half_width_px": round(self.half_width * self.px, 3)}


ROWS = [
    *(Row("composite", 400, 32, px, px, half_width) for px in (256, 1024) for half_width in (0.004, 0.01)),
    *(Row("composite", 4000, 32, 1024, 1024, half_width) for half_width in (0.004, 0.01)),
    *(Row("composite", *scene) for scene in ((400, 32, 256, 256, 0.001), (4000, 32, 1024, 1024, 0.0005))),  # fineliners
    Row("composite", 2048, 32, 1344, 2040, 0.004),  # as other papers draw
    *(Row("darkness", 100, 32, 256, 256, half_width) for half_width in (0.004, 0.01)),
]
ON_GPU = [(400, 256), (4000, 1024), (2048, 1344)]


class Task:
    """One row's tensors on a device, and a pass forward and back through them."""

    def __init__(self, row: Row, device: torch.device):
        generator = torch.Generator().manual_seed(0)
        first = 2 * math.pi * torch.rand(row.strokes, 1, generator=generator)
        bend = torch.randn(row.strokes, 1, generator=generator)
        heading = first + bend * torch.linspace(-0.5, 0.5, row.points)
        path = torch.stack([heading.cos(), heading.sin()], dim=-1).cumsum(1) * LENGTH / (row.points - 1)
        place = torch.rand(row.strokes, 1, 2, generator=generator)
        self.row, self.device, self.kernels = row, device, kernels_for(device)
        points = row.px * (path - path.mean(1, keepdim=True)) + place * torch.tensor([row.width, row.px])
        self.points = points.to(device).requires_grad_()
        self.thickness = torch.full((row.strokes, row.points), row.half_width * row.px, device=device).requires_grad_()
        self.colours = torch.rand(row.strokes, 3, generator=generator).to(device).requires_grad_()
        self.numbers = torch.tensor([[1.5], [0.2], [0.9]], device=device).unbind()  # c, q, o
        self.canvas = torch.ones(3, row.px, row.width, device=device)
        images = 3 if row.name == "composite" else row.strokes
        self.weights = torch.randn(images, row.px, row.width, generator=generator).to(device)

    @property
    def leaves(self) -> list[Tensor]:
        """What gradients are asked for of."""
        return [self.points, self.thickness] + [self.colours] * (self.row.name == "composite")

    def forward(self, kernels: ModuleType, strokes: Sequence[Tensor]) -> Tensor:
        """What strokes look like: their points, thickness and, on a canvas, colours."""
        if self.row.name == "darkness":
            return kernels.darkness(*strokes, *self.numbers, height=self.row.px, width=self.row.width)
        return kernels.composite(self.canvas, *strokes, *self.numbers)

    def backward(self, out: Tensor) -> tuple[Tensor, ...]:
        """The gradients asked for."""
        return torch.autograd.grad(out, self.leaves, self.weights[: out.shape[0]])

    def now(self) -> float:
        """Seconds, once everything asked for is done."""
        if self.device.type == "cuda":
            torch.cuda.synchronize(self.device)
        return time.perf_counter()

    def fast(self) -> tuple[float, float]:
        """Milliseconds forward and back."""
        start = self.now()
        out = self.forward(self.kernels, self.leaves)
        middle = self.now()
        with torch.autograd.set_multithreading_enabled(False):  # as in a plan
            self.backward(out)
        return 1e3 * (middle - start), 1e3 * (self.now() - middle)

    def dense(self, stroke: int) -> float:
        """Milliseconds forward and back for one stroke."""
        start = self.now()
        self.backward(self.forward(reference, [x[stroke : stroke + 1] for x in self.leaves]))
        return 1e3 * (self.now() - start)

    def moved_bytes(self) -> int:
        """Of what is read and written at least: strokes and canvas, their gradients, the result and its gradient."""
        strokes = self.points.numel() + self.thickness.numel() + self.colours.numel()
        return 4 * (2 * strokes + 2 * self.canvas.numel() + 2 * self.weights.numel())


def time_of(row: Row, device: torch.device) -> dict[str, float | None]:
    """The keys about time."""
    task, with_dense = Task(row, device), row.px <= 256
    task.fast()  # compiles
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
    least = 1e3 * task.moved_bytes() / bandwidth_of(device) if device.type == "cuda" else None
    return {
        "ms_forward": round(forward, 3),
        "ms_backward": round(backward, 3),
        "dense_ms_per_stroke": per_stroke and round(per_stroke, 3),
        "speedup": per_stroke and round(per_stroke * row.strokes / (forward + backward)),
        "bandwidth_share": least and round(least / (forward + backward), 4),
    }


def bandwidth_of(device: torch.device) -> float:
    """Bytes per second, read and written."""
    source = torch.zeros(2**28, device=device)
    target = torch.empty_like(source)
    seconds = []
    for _ in range(RUNS):
        torch.cuda.synchronize(device)
        start = time.perf_counter()
        target.copy_(source)
        torch.cuda.synchronize(device)
        seconds.append(time.perf_counter() - start)
    return 2 * 2**30 / statistics.median(seconds)


def extra_mib_of(row: Row, device: torch.device) -> float | None:
    """Measured in this process, which has rendered nothing else of size."""

    def mib(field: str) -> float:
        return int(Path("/proc/self/status").read_text().split(f"{field}:")[1].split()[0]) / 1024

    def once(task: Task) -> int:
        out = task.forward(task.kernels, task.leaves)
        return sum(x.numel() * x.element_size() for x in (out, *task.backward(out)))

    on_gpu = device.type == "cuda"
    if not on_gpu and not sys.platform.startswith("linux"):
        return None
    once(Task(Row(row.name, 2, row.points, 64, 64, row.half_width), device))  # loads what is loaded at the first use
    task = Task(row, device)
    if on_gpu:
        before = torch.cuda.memory_allocated(device) / 2**20
        torch.cuda.reset_peak_memory_stats(device)
    else:
        ctypes.CDLL(None).malloc_trim(0)
        before = mib("VmRSS")
        Path("/proc/self/clear_refs").write_text("5")
    asked_for = max(once(task) for _ in range(3))
    peak = torch.cuda.max_memory_allocated(device) / 2**20 if on_gpu else mib("VmHWM")
    return round(peak - before - asked_for / 2**20, 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", choices=["cpu", "cuda"], default="cpu", help="where to draw")
    parser.add_argument("--memory-of", metavar="ROW", help=argparse.SUPPRESS)  # in a process of its own
    asked = parser.parse_args()
    if asked.device == "cuda" and not torch.cuda.is_available():
        print("there is no GPU that torch can use here; leave --device out to measure the CPU", file=sys.stderr)
        sys.exit(2)
    device = torch.device(asked.device)
    if asked.memory_of:
        print(json.dumps(extra_mib_of(Row(**json.loads(asked.memory_of)), device)))
        return
    for row in ROWS:
        if asked.device == "cuda" and (row.strokes, row.px) not in ON_GPU:
            continue
        memory = subprocess.run(
            [sys.executable, __file__, "--device", asked.device, "--memory-of", json.dumps(asdict(row))],
            check=True,
            capture_output=True,
            text=True,
        )
        metrics = time_of(row, device) | {"extra_mib": json.loads(memory.stdout)}
        print(json.dumps(row.printed | {"device": asked.device} | metrics), flush=True)


if __name__ == "__main__":
    main()
