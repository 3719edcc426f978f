"""What is found about an installation, with and without what can be missing."""

import ctypes
import os
import pty
import sys
import tomllib
import webbrowser
from collections.abc import Iterator
from importlib.metadata import version
from itertools import chain
from pathlib import Path
from types import SimpleNamespace
from typing import NoReturn

import pytest
from serial.tools import list_ports

from maulstick.errors import how_to_add
from maulstick.jobs import doctor
from maulstick.jobs.doctor import EXTRAS, NATIVE, NATIVE_PLANNER, Finding, State, findings
from maulstick.jobs.plan import device
from maulstick.painting.brush import BRUSHES

ROOT = Path(__file__).resolve().parents[2]


def found() -> dict[str, Finding]:
    return {finding.name: finding for finding in findings()}


@pytest.fixture
def devices(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in place of /dev, and no serial port."""
    monkeypatch.setattr(doctor, "DEVICES", tmp_path)
    monkeypatch.setattr(list_ports, "comports", list)
    return tmp_path


@pytest.fixture
def terminal() -> Iterator[str]:
    """The name of a serial port."""
    ours, theirs = pty.openpty()
    yield os.ttyname(theirs)
    os.close(ours)
    os.close(theirs)


def no_access(monkeypatch: pytest.MonkeyPatch, forbidden: Path) -> None:
    """Nobody may use that path; root may use any, so that its rights cannot be taken away."""
    access = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != forbidden and access(path, mode))


def test_the_extras_are_those_of_the_package() -> None:
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    packages = {
        name: lines[0].partition(">=")[0] for name, lines in declared.items() if name not in ("dev", "docs", "plan")
    }
    assert {name: extra.package for name, extra in EXTRAS.items()} == packages


def test_the_native_modules_are_all_that_are_compiled() -> None:
    folders = ROOT / "src" / "maulstick"
    compiled = {path.with_suffix("").relative_to(folders) for path in folders.rglob("_*.cpp")}
    compiled.add(Path("rendering/kernels/_cpu"))
    assert sorted([*chain(*NATIVE.values()), *NATIVE_PLANNER]) == sorted(".".join(path.parts) for path in compiled)


@pytest.mark.parametrize(
    ("name", "module"), [("native styles", "style._shape"), ("native planner", "planning.objectives._edges")]
)
def test_a_native_module_that_was_not_built_is_told(
    devices: Path, monkeypatch: pytest.MonkeyPatch, name: str, module: str
) -> None:
    monkeypatch.setitem(sys.modules, f"maulstick.{module}", None)
    there = found()[name]
    assert there.state == State.MISSING
    assert there.note.endswith("install it again, in its source: pip install --force-reinstall .")


def test_what_is_installed_has_a_version(devices: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))  # other tests keep brushes of their own
    there = found()
    assert there["Maulstick"] == Finding("Maulstick", State.WORKS, version("maulstick"))
    assert there["native renderer"].note.startswith("instructions: ")
    assert there["native ordering"].state == there["PyTorch"].state == State.WORKS
    studio = there["the studio and surveys [studio]"]
    assert studio == Finding(studio.name, State.INSTALLED, f"nicegui {version('nicegui')}")
    assert there["own brushes"] == Finding("own brushes", State.WORKS, f"0 in {BRUSHES.own()}")
    assert len(there) == len(EXTRAS) + 15


def test_what_is_missing_is_told_with_what_to_do_and_is_no_error(
    devices: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*_: object) -> NoReturn:
        raise OSError("no such library")

    def no_browser(*_: object) -> NoReturn:
        raise webbrowser.Error

    monkeypatch.setattr(doctor, "find_spec", lambda name: None)
    monkeypatch.setattr(doctor, "import_module", missing)
    monkeypatch.setattr(ctypes, "CDLL", missing)
    monkeypatch.setattr(webbrowser, "get", no_browser)
    there = found()
    for name, extra in EXTRAS.items():
        finding = there[f"{extra.purpose} [{name}]"]
        assert finding.state == State.MISSING
        assert how_to_add(name) in finding.note or (name == "ur" and "Python 3.12" in finding.note)
    assert there["native renderer"].state == State.MISSING
    assert there["libmypaint"].note.startswith("apt-get install libmypaint-1.5-1; without it, the simulated easel")
    assert there["browser"].state == State.NOT_FOUND
    assert there["camera"].state == there["serial port"].state == State.NOT_FOUND


def test_without_pytorch_it_says_what_planning_needs(devices: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    assert found()["PyTorch"] == Finding("PyTorch", State.MISSING, f"planning needs it; {how_to_add('plan')}")


@pytest.mark.parametrize(
    ("triton", "disagreement", "state", "note"),
    [
        (True, None, State.WORKS, "H200, Triton"),
        (
            True,
            "its canvas is off",
            State.MISSING,
            "the processor plans, for the H200 draws otherwise than it should: its",
        ),
        (False, None, State.MISSING, "the processor plans, for the H200 needs Triton: pip install triton"),
    ],
)
def test_a_gpu_works_where_triton_draws_on_it_as_the_processor_does(
    devices: Path, monkeypatch: pytest.MonkeyPatch, triton: bool, disagreement: str | None, state: State, note: str
) -> None:
    monkeypatch.setattr("torch.cuda.is_available", lambda: True)
    monkeypatch.setattr("torch.cuda.get_device_name", lambda: "H200")
    monkeypatch.setattr(device, "find_spec", lambda name: object() if triton else None)
    monkeypatch.setattr(device, "kept_disagreement", lambda gpu: disagreement)
    gpu = found()["GPU"]
    assert gpu.state == state
    assert gpu.note.startswith(note)


def test_a_camera_and_a_serial_port_say_how_to_name_them(
    devices: Path, terminal: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (devices / "video10").touch()
    (devices / "video2").touch()
    port = SimpleNamespace(device=terminal, description="USB Serial")
    monkeypatch.setattr(list_ports, "comports", lambda: [port])
    there = found()
    cameras = [finding for name, finding in there.items() if name.startswith("camera ")]
    assert [finding.note for finding in cameras] == ["--camera usb:2", "--camera usb:10"]
    assert there[f"serial port {terminal}"] == Finding(f"serial port {terminal}", State.WORKS, "USB Serial")


def test_a_port_that_may_not_be_opened_names_its_group(devices: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (device := devices / "ttyUSB0").touch()
    os.chown(device, -1, 0) if os.getuid() == 0 else None
    monkeypatch.setattr(list_ports, "comports", lambda: [SimpleNamespace(device=str(device), description=None)])
    no_access(monkeypatch, device)
    finding = found()[f"serial port {device}"]
    assert finding.state == State.NO_ACCESS
    assert finding.note.startswith("add yourself to the group ")
    if os.getuid() == 0:
        assert finding.note == "add yourself to the group dialout: sudo usermod -aG dialout $USER, and log in again"


def test_a_folder_of_ones_own_that_cannot_be_written_is_told(devices: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    BRUSHES.own().parent.mkdir(parents=True, exist_ok=True)
    existing = next(path for path in (BRUSHES.own(), *BRUSHES.own().parents) if path.exists())
    no_access(monkeypatch, existing)
    finding = found()["own brushes"]
    assert finding.state == State.NO_ACCESS
    assert str(existing) in finding.note
