"""Device that plans: the processor, or a GPU whose kernels agreed with it on a small scene in this installation."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import torch
from platformdirs import user_cache_path
from pydantic import BaseModel, ConfigDict

from maulstick.errors import InputError, OutputError, option
from maulstick.jobs.plan.request import sum_of
from maulstick.rendering.kernels import agreement
from maulstick.storage.files import file_sum
from maulstick.storage.records import read_record, write_record

_CPU, _CUDA = torch.device("cpu"), torch.device("cuda")
_PACKAGES = ("maulstick", "torch", "triton")  # on whose versions it depends what a GPU computes


@dataclass(frozen=True)
class Gpu:
    """A GPU that PyTorch finds: its name, and whether Triton is there, in which its kernels are written."""

    name: str
    has_triton: bool


@dataclass(frozen=True)
class Choice:
    """The device that plans, and one sentence for people where it is another than might be expected."""

    device: torch.device
    note: str | None = None


class Verdict(BaseModel):
    """What a GPU showed in one installation, as it is kept.

    gpu: its name.  versions: of all packages that it depends on.  kernels: SHA-256 of their source.
    disagreement: where they differ from the CPU's; None where they agree.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    gpu: str
    versions: dict[str, str]
    kernels: str
    disagreement: str | None = None


def choose_device(wanted: str) -> Choice:
    """Return the device for ``auto``, ``cpu`` or ``cuda`` on this machine. Raises InputError as `chosen` does."""
    return chosen(wanted, None if wanted == "cpu" else find_gpu(), lambda gpu: kept_disagreement(gpu.name))


def chosen(wanted: str, gpu: Gpu | None, disagrees: Callable[[Gpu], str | None]) -> Choice:
    """Return the device for ``auto``, ``cpu`` or ``cuda``.

    gpu: the one that is there.  disagrees: returns where its kernels differ from the CPU's, or None; may raise what a
    GPU raises that cannot run them. Only ``auto`` asks; who wants ``cuda`` gets it.
    Raises InputError for ``cuda`` where there is no GPU, or no Triton.
    """
    if wanted == "cpu" or (wanted == "auto" and gpu is None):
        return Choice(_CPU)
    if wanted == "cuda":
        if gpu is None:
            raise InputError(
                f"{option('device')} is cuda, and PyTorch finds no GPU here; leave it out, or install a driver and "
                "PyTorch for CUDA"
            )
        if not gpu.has_triton:
            raise InputError(
                f"{option('device')} is cuda, and Triton is missing, which draws on the {gpu.name}; leave it out, or "
                "install it: pip install triton"
            )
        return Choice(_CUDA)
    assert gpu is not None
    if not gpu.has_triton:
        return Choice(_CPU, f"the processor plans, for the {gpu.name} needs Triton: pip install triton")
    try:
        difference = disagrees(gpu)
    except Exception as error:  # a driver, a compiler or a full memory: nearly anything is raised
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        return Choice(_CPU, f"the processor plans, for the {gpu.name} could not draw a test scene: {reason}")
    if difference is not None:
        return Choice(_CPU, f"the processor plans, for the {gpu.name} draws otherwise than it should: {difference}")
    return Choice(_CUDA)


def find_gpu() -> Gpu | None:
    """Return the GPU that PyTorch would use, or None."""
    if not torch.cuda.is_available():
        return None
    return Gpu(torch.cuda.get_device_name(), find_spec("triton") is not None)


def kept_disagreement(
    gpu: str, compare: Callable[[], str | None] | None = None, folder: Path | None = None
) -> str | None:
    """Return where the kernels of the GPU of this name differ from the CPU's, or None where they agree.

    It is found out once per installation and kept among the user's cached files; what cannot be kept is found out
    again. compare: finds it out.  folder: for the file.
    """
    versions = {package: _version(package) for package in _PACKAGES}
    asked = Verdict(gpu=gpu, versions=versions, kernels=_source_sum())
    path = (folder or user_cache_path("maulstick", appauthor=False)) / f"gpu-{sum_of(asked.model_dump())[:16]}.json"
    with suppress(InputError):  # there is none, or it is damaged
        kept = read_record(Verdict, path, "verdict on a GPU")
        if kept.model_copy(update={"disagreement": None}) == asked:
            return kept.disagreement
    difference = (compare or _compare)()
    with suppress(OSError, OutputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_record(asked.model_copy(update={"disagreement": difference}), path)
    return difference


def _compare() -> str | None:
    from maulstick.rendering.kernels import gpu  # needs Triton

    return agreement.disagreement(gpu, _CUDA)


def _source_sum() -> str:
    """Return a sum of all files of the kernels, which change without a version while somebody works on them."""
    return sum_of({path.name: file_sum(path) for path in Path(agreement.__file__).parent.iterdir() if path.is_file()})


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # installed without pip
        return "unknown"
