"""The command line, run in this process (torch takes seconds to load) or as its users run it."""

import io
import os
import re
import signal
import subprocess
import sys
import tty
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

import pytest
from skimage.data import data_dir

from maulstick.cli import main

COMMAND = Path(sys.executable).with_name("maulstick")
PORTRAIT = str(Path(data_dir) / "astronaut.png")
QUICK = ("--steps", "30", "--strokes", "20", "--px", "48")
RESULTS = ["painting.json", "painting.svg", "palette.png", "preview.png"]


class Ran(NamedTuple):
    code: int
    stdout: str
    stderr: str

    @property
    def mistake(self) -> str:
        """The one line that a user's mistake gets, on standard error and nothing else anywhere."""
        assert self.stdout == ""
        assert self.stderr.startswith("maulstick: ")
        assert self.stderr.count("\n") == 1
        return self.stderr.removeprefix("maulstick: ").rstrip("\n")


def run(*words: str | Path) -> Ran:
    """Run ``maulstick`` with these words in this process."""
    out, err = io.StringIO(), io.StringIO()
    with (
        patch.object(sys, "argv", ["maulstick", *map(str, words)]),
        redirect_stdout(out),
        redirect_stderr(err),
        pytest.raises(SystemExit) as left,
    ):
        main()
    assert isinstance(left.value.code, int)
    return Ran(left.value.code, out.getvalue(), err.getvalue())


def paint(out: Path, *words: str | Path, photo: str | Path = PORTRAIT) -> Ran:
    """Paint quickly and badly."""
    return run("plan", photo, *QUICK, "--out", out, *words)


def contents(folder: Path) -> dict[str, bytes]:
    """All files in a folder."""
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def run_command(*words: str | Path, stdout: int = subprocess.PIPE, **environment: str) -> Ran:
    """Run ``maulstick`` as a command of its own."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", **environment}
    ran = subprocess.run([COMMAND, *words], stdout=stdout, stderr=subprocess.PIPE, text=True, env=environment)
    return Ran(ran.returncode, ran.stdout or "", ran.stderr)


class Running:
    """``maulstick`` in a terminal, by these words or as that `command`; keys: whether it hears what is typed there."""

    def __init__(self, *words: str | Path, command: Sequence[str | Path] = (COMMAND,), keys: bool = False) -> None:
        self._terminal, theirs = os.openpty()
        self._process = subprocess.Popen(
            [*command, *words],
            stdin=theirs if keys else None,
            stdout=subprocess.DEVNULL,
            stderr=theirs,
            env={**os.environ, "OMP_NUM_THREADS": "1", "TERM": "xterm", "COLUMNS": "100"},
            start_new_session=True,
        )
        os.close(theirs)
        self.said = ""

    def wait_for(self, text: str) -> None:
        """Return once it has said so."""
        while not re.search(text, self.said):
            assert self.listen(), self.said

    def interrupt_after(self, text: str) -> None:
        """press Ctrl-C once it has said so; a terminal tells all its processes."""
        self.wait_for(text)
        os.killpg(self._process.pid, signal.SIGINT)

    @property
    def pid(self) -> int:
        """The process."""
        return self._process.pid

    def kill(self) -> None:
        """As a power cut would."""
        self._process.kill()

    def leave(self) -> int:
        """The exit code, at the end."""
        while self.listen():
            pass
        os.close(self._terminal)
        return self._process.wait()

    def listen(self) -> bool:
        """Whether anything more is said."""
        try:
            heard = os.read(self._terminal, 4096)
        except OSError:  # the other end is closed
            return False
        self.said += heard.decode(errors="replace")
        return bool(heard)


@pytest.fixture(scope="session")
def painted(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ran]:
    """A folder with a painting, that no test changes, and what was said while it was made."""
    out = tmp_path_factory.mktemp("painted") / "new" / "folder"
    return out, run("plan", PORTRAIT, *QUICK, "--out", out)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Where keys are pressed: they come in on standard input."""
    keyboard, theirs = os.openpty()
    tty.setraw(theirs)
    with open(theirs) as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        yield keyboard
    os.close(keyboard)
