"""The README's lines, in order, as a stranger would type them; plans with fewer steps."""

import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.pages import ROOT, blocks, lines

PAGE = ROOT / "README.md"
README = PAGE.read_text(encoding="utf-8")
BIN = Path(sys.executable).parent
QUICK = {
    "strokes=600": "strokes=40, steps=8, px=48",
    "--strokes 800": "--strokes 40 --steps 8 --px 48",
    "--strokes 1000": "--strokes 40 --steps 8 --px 48",
    "--hand-size 0.5": "--steps 4 --px 48",
}


def quickly(text: str) -> str:
    for slow, quick in QUICK.items():
        text = text.replace(slow, quick)
    return text


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the picture that the README makes."""
    folder = tmp_path_factory.mktemp("readme")
    (code,) = re.findall(r'python -c "(.*?)"\n', README)
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], cwd=folder, check=True)
    assert (folder / "cat.jpg").is_file()
    return folder


def test_the_python_of_the_readme_runs(folder: Path) -> None:
    (code,) = blocks(PAGE, "python")
    assert quickly(code) != code
    ran = subprocess.run([sys.executable, "-c", quickly(code)], cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert ran.stderr == "" or "libmypaint is not installed" in ran.stderr
    assert all((folder / name).is_file() for name in ("cat.json", "cat.png", "painted.png"))


def test_the_commands_of_the_readme_run_in_order(folder: Path) -> None:
    commands = [line for line in lines(PAGE) if line.startswith("maulstick ") and line != "maulstick studio"]
    assert len(commands) == 6
    for command in commands:
        ran = subprocess.run(
            [BIN / "maulstick", *shlex.split(quickly(command))[1:]], cwd=folder, capture_output=True, text=True
        )
        assert ran.returncode == 0, ran.stderr
    assert {"painting.json", "painting.svg", "preview.png", "palette.png"} <= {
        p.name for p in (folder / "cat").iterdir()
    }
    assert (folder / "cat" / "painting-painted.png").is_file()
    assert (folder / "cat" / "painting-2000px.png").is_file()


def test_the_studio_of_the_readme_starts_and_says_where_it_is(folder: Path) -> None:
    assert "maulstick studio" in lines(PAGE)
    with subprocess.Popen(
        [BIN / "maulstick", "studio", "--port", "0", "--no-browser"],
        cwd=folder,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as started:
        try:
            assert started.stdout is not None
            assert "is open; Ctrl-C closes it" in started.stdout.readline()
            told = started.stdout.readline()
            assert re.search(r"http://[\w.]+:\d+", told), told
            started.send_signal(signal.SIGINT)
            assert started.wait(60) == 130
        finally:
            started.kill()


def test_what_the_readme_installs_and_makes_is_in_the_makefile() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"^    make (\w+)", README, re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE)
    (extras,) = re.findall(r"pip install -c constraints.txt '\.\[([\w,]+)\]'", README)
    for extra in extras.split(","):
        assert f"\n{extra} = [" in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
