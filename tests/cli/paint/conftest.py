"""Runs of small paintings, on the simulator or on a machine that takes notes."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import read_picture
from maulstick.robot.journal import Journal, journal_of
from tests.cli.conftest import run
from tests.support.nominal import nominal
from tests.support.robot.recorder import Recorder
from tests.support.robot.small_paintings import SIX, painting_of

ALL = list(range(10, 16))
MESSAGE = "6 strokes, 105 mm, 2 paints, about 1 min"


@pytest.fixture(autouse=True)
def data(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody else's machines are in use."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    write_painting(SIX, tmp_path / "painting.json")
    return tmp_path / "painting.json"


@pytest.fixture
def calibrated(tmp_path: Path) -> Path:
    """The same with a brush that knows how deep the simulator's marker is pressed."""
    brush = nominal("marker").model_copy(update={"depth": (0.0, 0.002)})
    write_painting(painting_of(SIX.strokes, [brush]), tmp_path / "calibrated.json")
    return tmp_path / "calibrated.json"


@pytest.fixture
def begun(painting: Path) -> Path:
    """The painting after a run that was cut off: 10 is painted, 11 was under the brush."""
    with Journal.open(journal_of(painting)) as journal:
        journal.revise(painting)
        journal.begin(10)
        journal.end(10)
        journal.begin(11)
    return painting


def events(painting: Path) -> list[str]:
    lines = [json.loads(line) for line in journal_of(painting).read_text().splitlines()]
    return [f"{line['event']} {line['stroke']}" for line in lines if "stroke" in line]


def painted(painting: Path) -> list[int]:
    """The strokes that were begun and finished, in order."""
    return [int(event.split()[1]) for event in events(painting) if event.startswith("end ")]


def answers(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    """A person, who is asked, types this."""
    monkeypatch.setattr("sys.stdin", io.StringIO(text))


@pytest.fixture
def recorder(monkeypatch: pytest.MonkeyPatch) -> Recorder:
    """The machine that is now called grbl."""
    robot = Recorder()
    monkeypatch.setattr("maulstick.jobs.paint.setup.machine", lambda spec, easel: robot)
    return robot


def picture_of(path: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.asarray(read_picture(path), dtype=np.float64)


def correlation(painting: Path) -> float:
    """Of the sheet that was painted, with the brush's own picture of the painting."""
    assert run("render", painting, "--out", painting.with_name("preview.png"), "--overwrite").code == 0
    one, other = (
        picture_of(painting.with_name(f"{painting.stem}-painted.png")),
        picture_of(painting.with_name("preview.png")),
    )
    rows = np.linspace(0, 1, 80)
    samples = [
        image[(rows * (image.shape[0] - 1)).astype(int)][:, (rows * (image.shape[1] - 1)).astype(int)].ravel()
        for image in (one, other)
    ]
    return float(np.corrcoef(*samples)[0, 1])
