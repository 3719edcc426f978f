"""Which device plans. No GPU is needed: what one would answer is given."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch
from torch import Tensor

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan import device as devices
from maulstick.jobs.plan import prepare
from maulstick.jobs.plan.device import Choice, Gpu, choose_device, chosen, kept_disagreement
from maulstick.rendering.kernels import cpu
from maulstick.rendering.kernels.agreement import disagreement
from maulstick.storage.arrays import Image
from tests.cli.conftest import PORTRAIT, run
from tests.support.planning.far_device import FAR, far_device

CPU, CUDA = torch.device("cpu"), torch.device("cuda")
GPU, WITHOUT_TRITON = Gpu("Tesla T4", has_triton=True), Gpu("Tesla T4", has_triton=False)


def agrees(gpu: Gpu) -> str | None:
    return None


def never(*gpu: Gpu) -> str | None:
    raise AssertionError("nobody needs to know")


def breaks(gpu: Gpu) -> str | None:
    raise RuntimeError("CUDA error: out of memory\nCompile with TORCH_USE_CUDA_DSA")


@pytest.mark.parametrize(
    ("wanted", "gpu", "disagrees", "device", "note"),
    [
        ("cpu", GPU, never, CPU, None),
        ("auto", None, never, CPU, None),
        ("cuda", GPU, never, CUDA, None),
        ("auto", GPU, agrees, CUDA, None),
        (
            "auto",
            GPU,
            lambda gpu: "its canvas is 0.1 off, and 2e-05 is allowed",
            CPU,
            "the processor plans, for the Tesla T4 draws otherwise than it should: "
            "its canvas is 0.1 off, and 2e-05 is allowed",
        ),
        (
            "auto",
            GPU,
            breaks,
            CPU,
            "the processor plans, for the Tesla T4 could not draw a test scene: CUDA error: out of memory",
        ),
        ("auto", WITHOUT_TRITON, never, CPU, "the processor plans, for the Tesla T4 needs Triton: pip install triton"),
    ],
)
def test_a_gpu_plans_where_it_is_asked_for_or_agrees_and_else_the_processor_with_one_sentence(
    wanted: str, gpu: Gpu | None, disagrees: Callable[[Gpu], str | None], device: torch.device, note: str | None
) -> None:
    assert chosen(wanted, gpu, disagrees) == Choice(device, note)


@pytest.mark.parametrize(
    ("gpu", "text"),
    [
        (
            None,
            "device is cuda, and PyTorch finds no GPU here; leave it out, or install a driver and PyTorch for CUDA",
        ),
        (
            WITHOUT_TRITON,
            "device is cuda, and Triton is missing, which draws on the Tesla T4; leave it out, or install it: "
            "pip install triton",
        ),
    ],
)
def test_cuda_is_refused_where_there_is_none_of_it(gpu: Gpu | None, text: str) -> None:
    with pytest.raises(InputError) as caught:
        chosen("cuda", gpu, never)
    assert str(caught.value) == text


def test_a_gpu_is_compared_once_per_installation_and_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def found(gpu: str, answer: str | None = None) -> str | None:
        return kept_disagreement(gpu, lambda: asked.append(gpu) or answer, tmp_path / "cache")

    assert found("T4") is None
    assert found("T4", "worse") is None
    assert found("A100", "its canvas is off") == "its canvas is off"
    assert found("A100") == "its canvas is off"
    assert asked == ["T4", "A100"]
    for name, change in (("_version", lambda package: "9.9"), ("_source_sum", lambda: "other kernels")):
        monkeypatch.setattr(devices, name, change)
        assert found("T4", name) == name
        assert found("T4") == name
    assert asked == ["T4", "A100", "T4", "T4"]


def test_a_verdict_that_is_damaged_or_cannot_be_kept_is_found_again(tmp_path: Path) -> None:
    assert kept_disagreement("T4", lambda: "off", tmp_path) == "off"
    (file,) = tmp_path.iterdir()
    file.write_text("{")
    assert kept_disagreement("T4", lambda: None, tmp_path) is None
    file.write_text(file.read_text().replace("T4", "A100"))
    assert kept_disagreement("T4", lambda: "off", tmp_path) == "off"
    for answer in ("off", None):
        assert kept_disagreement("T4", lambda answer=answer: answer, file / "no folder") == answer


def test_what_a_gpu_raises_is_not_kept(tmp_path: Path) -> None:
    def out_of_memory() -> str | None:
        raise RuntimeError("out of memory")

    with pytest.raises(RuntimeError, match="out of memory"):
        kept_disagreement("T4", out_of_memory, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_the_kernels_of_the_gpu_agree_with_those_of_the_cpu() -> None:
    pytest.importorskip("triton")
    from maulstick.rendering.kernels import gpu

    assert torch.cuda.is_available() or os.environ["TRITON_INTERPRET"] == "1"
    assert disagreement(gpu, CUDA if torch.cuda.is_available() else CPU) is None
    assert disagreement(cpu, CPU) is None


class _Wrong(torch.autograd.Function):
    """The same values, and gradients that are 0.1 % too large."""

    @staticmethod
    def forward(ctx: Any, x: Tensor) -> Tensor:
        return x.clone()

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> Tensor:
        return 1.001 * gradient


@pytest.mark.parametrize(
    ("composite", "text"),
    [
        (lambda **scene: cpu.composite(**scene) + 1e-4, r"its canvas is 0.0001 off, and 2e-05 is allowed"),
        (lambda **scene: cpu.composite(**scene) * float("nan"), r"its canvas is inf off"),
        (
            lambda thickness, **scene: cpu.composite(thickness=_Wrong.apply(thickness), **scene),
            r"its gradient of thickness is .* off, and .* is allowed",
        ),
    ],
)
def test_kernels_that_draw_otherwise_are_found(composite: Callable[..., Tensor], text: str) -> None:
    found = disagreement(SimpleNamespace(composite=composite), CPU)  # type: ignore[arg-type]
    assert found is not None
    assert re.match(text, found)


def test_a_painting_planned_on_another_device_is_the_same_and_says_where_it_was_planned(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    picture: Image = np.linspace(0, 1, 20 * 24 * 3, dtype=np.float32).reshape(20, 24, 3)

    def planned(device: str) -> ms.Painting:
        return ms.plan(picture, strokes=6, steps=6, px=20, paints=2, device=device)

    near = planned("cpu")
    assert near.provenance.options["device"] == "cpu"
    monkeypatch.setattr(prepare, "choose_device", lambda wanted: Choice(FAR, "the moon plans"))
    with far_device(), pytest.warns(UserWarning, match="^the moon plans$"):
        far = planned("auto")
    assert far.provenance.options["device"] == "meta"
    assert far.strokes == near.strokes
    assert far.paints == near.paints


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a GPU here")
def test_without_a_gpu_the_processor_plans_unless_one_is_demanded(tmp_path: Path) -> None:
    assert choose_device("auto") == choose_device("cpu") == Choice(CPU)
    ran = run("plan", PORTRAIT, "--device", "cuda", "--out", tmp_path / "out")
    assert ran.code == 2
    assert ran.mistake == (
        "--device is cuda, and PyTorch finds no GPU here; leave it out, or install a driver and PyTorch for CUDA"
    )
    assert not (tmp_path / "out").exists()
    assert run("plan", PORTRAIT, "--device", "tpu").mistake == "there is no device 'tpu'; there are: auto, cpu, cuda"


def test_the_command_line_says_in_one_sentence_why_the_processor_plans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(prepare, "choose_device", lambda wanted: Choice(CPU, f"{wanted}: the processor plans"))
    quick = ("--steps", "2", "--strokes", "3", "--px", "16", "--out", tmp_path)
    ran = run("plan", PORTRAIT, "--brush", "marker", *quick)
    assert ran.code == 0
    assert ran.stderr.startswith("note: auto: the processor plans\n")
