"""Findings about an installation: what works, and what to install or to do for the rest."""

import os
import platform
import sys
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from maulstick.errors import how_to_add
from maulstick.painting.brush import BRUSHES
from maulstick.robot.simulated import mypaint
from maulstick.storage.library import Library
from maulstick.style.cards import STYLES

DEVICES = Path("/dev")


class State(StrEnum):
    """State of one thing; ``installed`` means that it is there and was not loaded."""

    WORKS = "works"
    INSTALLED = "installed"
    MISSING = "missing"
    NOT_FOUND = "not found"
    NO_ACCESS = "no access"


@dataclass(frozen=True)
class Finding:
    """One thing that Maulstick can use: its name, its state, and a version or what to do."""

    name: str
    state: State
    note: str


@dataclass(frozen=True)
class Extra:
    """Extra of the package: what it is for, the package that it installs, and the module in that package."""

    purpose: str
    package: str
    module: str


EXTRAS: Final = {
    "camera": Extra("cameras", "opencv-python-headless", "cv2"),
    "clip": Extra("paintings of texts", "open-clip-torch", "open_clip"),
    "video": Extra("videos as MP4", "av", "av"),
    "studio": Extra("the studio and surveys", "nicegui", "nicegui"),
    "ray": Extra("sweeps on Ray", "ray", "ray"),
    "slurm": Extra("sweeps on Slurm", "submitit", "submitit"),
    "mocap": Extra("motion capture live", "natnet", "natnet"),
    "wacom": Extra("Wacom's files of ink", "universal-ink-library", "uim"),
    "franka": Extra("Franka's arms", "franky-control", "franky"),
    "ur": Extra("arms of Universal Robots", "ur-rtde", "rtde_control"),
    "xarm": Extra("xArm and Lite 6", "xarm-python-sdk", "xarm"),
}
"""Extras of pyproject.toml by name."""

NATIVE: Final = {
    "native renderer": ("rendering.kernels._cpu", "rendering._laying"),
    "native ordering": ("ordering._tour",),
    "native styles": ("style._density", "style._free", "style._shape"),
}
"""Modules that a compiler made, which need no PyTorch."""

NATIVE_PLANNER: Final = (
    "planning.objectives._edges",
    "planning.objectives._pyramid",
    "style.arrangement._neighbourhoods",
)
"""Modules that a compiler made, beside others that need PyTorch."""


def findings() -> Iterator[Finding]:
    """Yield all findings in the order in which they are shown. Nothing that is missing raises an error."""
    yield Finding("Maulstick", State.WORKS, version("maulstick"))
    yield Finding("Python", State.WORKS, f"{platform.python_version()}, {platform.system()} {platform.machine()}")
    for name, modules in NATIVE.items():
        yield _native(name, modules)
    yield from _torch()
    for name, extra in EXTRAS.items():
        yield _extra(name, extra)
    yield from _mypaint()
    yield _browser()
    yield from _cameras()
    yield from _serial_ports()
    for library in (STYLES, BRUSHES):
        yield _own(library)


def _native(name: str, modules: Sequence[str]) -> Finding:
    try:
        first, *_ = [import_module(f"maulstick.{module}") for module in modules]
    except (ImportError, OSError) as error:
        return Finding(
            name, State.MISSING, f"{error}; install it again, in its source: pip install --force-reinstall ."
        )
    sets: Callable[[], list[str]] | None = getattr(first, "instruction_sets", None)
    return Finding(name, State.WORKS, "" if sets is None else f"instructions: {sets()[0]}")


def _torch() -> Iterator[Finding]:
    try:
        import torch  # takes a second or two, and only torch knows whether it can use the GPU
    except ModuleNotFoundError:
        yield Finding("PyTorch", State.MISSING, f"planning needs it; {how_to_add('plan')}")
        return
    except (ImportError, OSError) as error:
        yield Finding("PyTorch", State.MISSING, f"{error}; install it again: pip install --force-reinstall torch")
        return
    yield Finding("PyTorch", State.WORKS, torch.__version__)
    yield _native("native planner", NATIVE_PLANNER)
    if not torch.cuda.is_available():
        yield Finding("GPU", State.NOT_FOUND, "the processor plans and renders")
        return
    from maulstick.jobs.plan.device import choose_device  # loads torch

    if (note := choose_device("auto").note) is not None:
        yield Finding("GPU", State.MISSING, note)
    else:
        yield Finding("GPU", State.WORKS, f"{torch.cuda.get_device_name()}, Triton {_version('triton')}")


def _extra(name: str, extra: Extra) -> Finding:
    called = f"{extra.purpose} [{name}]"
    if find_spec(extra.module) is not None:
        return Finding(called, State.INSTALLED, f"{extra.package} {_version(extra.package)}")
    if name == "ur" and sys.version_info >= (3, 13):
        return Finding(called, State.MISSING, f"{extra.package} needs Python 3.12 or older")
    return Finding(called, State.MISSING, how_to_add(name))


def _mypaint() -> Iterator[Finding]:
    otherwise = "without it, the simulated easel draws with our own brush model"
    for name, there, package in (
        ("libmypaint", mypaint.library_loads(), "libmypaint-1.5-1"),
        ("libmypaint's brushes", mypaint.brushes_exist(), "mypaint-brushes"),
    ):
        yield (
            Finding(name, State.WORKS, "")
            if there
            else Finding(name, State.MISSING, f"apt-get install {package}; {otherwise}")
        )


def _browser() -> Finding:
    try:
        webbrowser.get()
    except webbrowser.Error:
        return Finding("browser", State.NOT_FOUND, "open the studio's link yourself, here or on another computer")
    return Finding("browser", State.INSTALLED, "")


def _cameras() -> Iterator[Finding]:
    cameras = sorted(DEVICES.glob("video[0-9]*"), key=lambda path: (len(path.name), path.name))
    if not cameras:
        yield Finding("camera", State.NOT_FOUND, "connect one by USB to photograph the sheet")
    for path in cameras:
        works = os.access(path, os.R_OK | os.W_OK)
        note = f"--camera usb:{path.name.removeprefix('video')}" if works else _join(path, "video")
        yield Finding(f"camera {path}", State.WORKS if works else State.NO_ACCESS, note)


def _serial_ports() -> Iterator[Finding]:
    from serial.tools import list_ports  # only now: looking for ports is all it is loaded for

    ports = sorted(list_ports.comports(), key=lambda port: str(port.device))
    if not ports:
        yield Finding("serial port", State.NOT_FOUND, "connect a plotter by USB, and switch it on")
    for port in ports:
        works = os.access(port.device, os.R_OK | os.W_OK)
        about = "" if port.description in (None, "n/a") else str(port.description)
        note = about if works else _join(Path(port.device), "dialout")
        yield Finding(f"serial port {port.device}", State.WORKS if works else State.NO_ACCESS, note)


def _own(library: Library) -> Finding:
    folder = library.own()
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    if existing.is_dir() and os.access(existing, os.W_OK | os.X_OK):
        number = sum(not library.is_built_in(path) for path in library.paths().values())
        return Finding(f"own {library.folder}", State.WORKS, f"{number} in {folder}")
    return Finding(f"own {library.folder}", State.NO_ACCESS, f"make {existing} a folder that you can write to")


def _join(path: Path, usual: str) -> str:
    """Return what to do about a device that may not be used: the group that owns it, or the usual one."""
    group = usual
    with suppress(ImportError, OSError, KeyError):
        import grp  # Windows has none

        group = grp.getgrgid(path.stat().st_gid).gr_name
    group = usual if group == "root" else group
    return f"add yourself to the group {group}: sudo usermod -aG {group} $USER, and log in again"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # installed without pip
        return "of an unknown version"
