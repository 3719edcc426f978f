"""How the fast kernels run: the same bits every time, beside other Python threads, in little memory."""

import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest
import torch
from torch import Tensor

from maulstick.rendering.kernels import _cpu, cpu
from tests.rendering.kernels.conftest import (
    Renderer,
    composite_with_gradients,
    darkness_with_gradients,
    each_fast_renderer,
    random_scene,
)


def same_bits(a: dict[str, Tensor], b: dict[str, Tensor]) -> bool:
    return all(torch.equal(a[name].view(torch.int32), b[name].view(torch.int32)) for name in a)


@each_fast_renderer
@pytest.mark.parametrize("operation", [composite_with_gradients, darkness_with_gradients])
def test_the_bits_are_the_same_for_any_number_of_threads_and_every_repeat(
    fast: Renderer, operation: Callable[..., dict[str, Tensor]]
) -> None:
    scene = random_scene(30, strokes=300, points=16, height=130, width=150)

    def run(threads: int) -> dict[str, Tensor]:
        return operation(
            Renderer(partial(fast.darkness, threads=threads), partial(fast.composite, threads=threads)), scene
        )

    alone = run(1)
    for threads in (1, 2, 5):
        for _ in range(3):
            assert same_bits(run(threads), alone)


def test_several_python_threads_may_render_at_once() -> None:
    scenes = [random_scene(40 + i, strokes=50, height=130, width=150) for i in range(8)]
    fast = Renderer(cpu.darkness, cpu.composite)
    one_by_one = [composite_with_gradients(fast, scene) for scene in scenes]
    with ThreadPoolExecutor(4) as pool:
        at_once = list(pool.map(lambda scene: composite_with_gradients(fast, scene), scenes))
    assert all(same_bits(a, b) for a, b in zip(at_once, one_by_one, strict=True))


def native_calls() -> dict[str, Callable[[], None]]:
    """Each native function, kept busy for some tens of milliseconds; nothing but it can give the interpreter away."""
    scene = random_scene(31, strokes=400, points=32, height=512, width=512)
    canvas, points, thickness, colours, *numbers = (x.numpy() for x in scene)
    out, images = torch.empty(3, 512, 512).numpy(), torch.ones(400, 128, 128).numpy()
    records, alone = torch.empty(400, 3 * 32 + 3 + 3).numpy(), torch.empty(400, 3 * 32 + 3).numpy()
    everyone = torch.ones(400, dtype=torch.uint8).numpy()
    first = cpu.INSTRUCTION_SETS[0], 1
    stroke, coloured = (points, thickness, *numbers), (points, thickness, colours, *numbers)
    traced = partial(_cpu.composite_traced, *first, cpu.TRACES, canvas, *coloured, everyone, True, out)
    back = (canvas, points, colours, *numbers, everyone, True, traced(), canvas, out, records)
    return {
        "composite": partial(_cpu.composite, *first, canvas, *coloured, out),
        "composite_traced": traced,
        "composite_backward": partial(_cpu.composite_backward, *first, *back),
        "darkness": partial(_cpu.darkness, *first, *stroke, images),
        "darkness_backward": partial(_cpu.darkness_backward, *first, *stroke, images, alone),
    }


@pytest.mark.parametrize(
    "name", ["composite", "composite_traced", "composite_backward", "darkness", "darkness_backward"]
)
def test_another_python_thread_runs_while_a_kernel_does(name: str) -> None:
    call = native_calls()[name]
    started, done, steps = threading.Event(), threading.Event(), [0]

    def count() -> None:
        while not done.is_set():
            steps[0] += 1
            started.set()
            time.sleep(1e-4)  # gives the interpreter away at every step

    other, interval = threading.Thread(target=count), sys.getswitchinterval()
    sys.setswitchinterval(1000)  # from here on a thread only gets the interpreter when another gives it away
    other.start()
    try:
        started.wait()
        for _ in range(100):
            before = steps[0]
            call()
            if progress := steps[0] - before:
                break
    finally:
        sys.setswitchinterval(interval)
        done.set()
        other.join()
    assert progress > 0


PEAK_MEMORY = """
import pathlib
import torch
from maulstick.rendering.kernels import cpu
from tests.rendering.kernels.conftest import Renderer, composite_with_gradients, random_scene

cpu.TRACES = 20

def peak():
    status = pathlib.Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024

def paint(strokes, size):
    scene = random_scene(1, strokes=strokes, points=8, height=size, width=size)
    composite_with_gradients(Renderer(cpu.darkness, cpu.composite), scene)

paint(10, 512)
before = peak()
paint(2000, 512)
print(peak() - before)
"""

MEMORY_OF_OTHERS = """
import ctypes
import numpy as np
from maulstick.rendering.kernels import _cpu
from tests.rendering.kernels.conftest import random_scene

libc = ctypes.CDLL(None)
libc.malloc.restype = ctypes.c_void_p
libc.mallopt(-3, 2**30)  # M_MMAP_THRESHOLD and M_TRIM_THRESHOLD: what is given back is used again
libc.mallopt(-1, 2**30)
for seed in range(40):
    arguments = [x.numpy() for x in random_scene(seed, strokes=3, points=5, height=60, width=130)]
    gradients = np.empty((3, 5 * 3 + 6), np.float32)
    everyone, weights = np.ones(3, np.uint8), np.ones_like(arguments[0])
    dirty = libc.malloc(2**26)
    ctypes.memset(dirty, 255, 2**26)  # every number of it is not one
    libc.free(ctypes.c_void_p(dirty))
    how, flags = ("baseline", 1), (everyone, True)
    traces = _cpu.composite_traced(*how, seed % 2, *arguments, *flags, np.empty_like(weights))
    canvas, xy, _, *rest = arguments
    _cpu.composite_backward(*how, canvas, xy, *rest, *flags, traces, weights, np.empty_like(weights), gradients)
    assert np.isfinite(gradients).all(), seed
"""

NO_MORE_THREADS = """
import pathlib
import resource
import torch
from maulstick.rendering.kernels import _cpu
from tests.rendering.kernels.conftest import random_scene

arguments = [x.numpy() for x in random_scene(1)]
alone, crowd = (torch.empty(3, 37, 70).numpy() for _ in range(2))
_cpu.composite("baseline", 1, *arguments, alone)
size = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + 4 * 2**20,) * 2)  # too little for the stack of a thread
_cpu.composite("baseline", 3, *arguments, crowd)
print((alone == crowd).all())
"""

linux_only = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")


def output_of(script: str, folder: Path) -> str:
    run = subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.strip()


@linux_only
def test_gradients_do_not_come_from_memory_that_nobody_wrote(pytestconfig: pytest.Config) -> None:
    assert output_of(MEMORY_OF_OTHERS, pytestconfig.rootpath) == ""


def test_strokes_without_traces_are_painted_again_with_the_same_gradients(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene, fast = random_scene(7, strokes=60, height=90, width=150), Renderer(cpu.darkness, cpu.composite)
    traced = composite_with_gradients(fast, scene)
    monkeypatch.setattr(cpu, "TRACES", 0)
    assert same_bits(composite_with_gradients(fast, scene), traced)


@linux_only
def test_memory_does_not_grow_with_strokes_times_pixels(pytestconfig: pytest.Config) -> None:
    mib = float(output_of(PEAK_MEMORY, pytestconfig.rootpath))
    assert mib < 100  # one byte a stroke and pixel would be 500


@linux_only
def test_a_system_without_threads_to_spare_gets_the_same_picture(pytestconfig: pytest.Config) -> None:
    assert output_of(NO_MORE_THREADS, pytestconfig.rootpath) == "True"
