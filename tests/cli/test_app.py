import os
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.cli.conftest import run, run_command


def test_the_version_is_the_one_that_is_installed() -> None:
    assert run("--version") == (0, f"maulstick {version('maulstick')}\n", "")


def test_without_a_word_it_says_which_words_there_are() -> None:
    ran = run()
    assert ran.code == 2
    assert "paint" in ran.stdout
    assert "render" in ran.stdout


def test_help_says_what_each_exit_code_means() -> None:
    ran = run("--help")
    assert ran.code == 0
    for meaning in ("0 done", "1 a result could not be written", "2 a file or an option", "130 stopped with Ctrl-C"):
        assert meaning in " ".join(ran.stdout.split())


def test_the_command_that_is_installed_leaves_with_one_line_and_a_code() -> None:
    ran = run_command("plan", "none.jpg")
    assert ran.code == 2
    assert ran.mistake == f"there is no picture {Path('none.jpg').absolute()}; check its name and folder"


def test_a_mistake_is_found_before_torch_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "torch.py").write_text("raise SystemExit('torch was loaded')")
    there = str(tmp_path)
    for words, text in {
        ("plan", "--demo", "--px", "0"): "--px is 0; it must be from 16 to 32768",
        ("plan", "--demo", "--ink", "octarine"): "'octarine' is not a colour; write a name such as black, or #rrggbb",
        ("render", "none.json"): "there is no painting none.json; check its name and folder",
    }.items():
        assert run_command(*words, PYTHONPATH=there).mistake == text
    assert "torch was loaded" in run_command("plan", "--demo", "--out", tmp_path / "out", PYTHONPATH=there).stderr


def test_ctrl_c_while_the_program_loads_is_no_traceback(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("raise KeyboardInterrupt")
    assert run_command("--help", PYTHONPATH=str(tmp_path)) == (130, "", "")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_a_standard_output_that_is_full_is_one_line() -> None:
    full = os.open("/dev/full", os.O_WRONLY)
    try:
        ran = run_command("--version", stdout=full)
    finally:
        os.close(full)
    assert ran.code == 1
    assert ran.mistake == "cannot write to the standard output: No space left on device"


def test_what_takes_long_to_load_is_not_loaded_for_help() -> None:
    script = "import sys, maulstick.cli.app; print(*{'torch', 'sklearn', 'open_clip'} & set(sys.modules))"
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []
