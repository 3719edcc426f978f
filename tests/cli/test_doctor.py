import subprocess
import sys
from pathlib import Path

import pytest
from serial.tools import list_ports

from maulstick.errors import how_to_add
from maulstick.jobs import doctor
from tests.cli.conftest import run, run_command


def cells(out: str) -> dict[str, list[str]]:
    """The state and the note of each row that begins on a line, by its first cell."""
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in out.splitlines() if "│" in line]
    return {name: rest for name, *rest in rows if name}


def test_the_command_tells_what_works_in_a_table(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    ran = run("doctor")
    assert ran.code == 0
    assert ran.stderr == ""
    rows = cells(ran.stdout)
    assert rows["native renderer"][0] == "works"
    assert rows["cameras [camera]"][0] == "installed"


def test_nothing_that_is_missing_is_an_error(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.setattr(doctor, "find_spec", lambda name: None)
    monkeypatch.setattr(doctor, "DEVICES", tmp_path)
    monkeypatch.setattr(list_ports, "comports", list)
    ran = run("doctor")
    assert ran.code == 0
    rows = cells(ran.stdout)
    assert rows["the studio and surveys [studio]"] == ["missing", how_to_add("studio")]
    assert rows["serial port"] == ["not found", "connect a plotter by USB, and switch it on"]


def test_the_command_loads_none_of_the_extras() -> None:
    script = "import sys; from maulstick.jobs.doctor import *; list(findings()); print(*sys.modules)"
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert not {extra.module for extra in doctor.EXTRAS.values()} & set(ran.stdout.split())


def test_the_installed_command_ends_well() -> None:
    ran = run_command("doctor", COLUMNS="200")
    assert (ran.code, ran.stderr) == (0, "")
    assert "Maulstick" in ran.stdout
