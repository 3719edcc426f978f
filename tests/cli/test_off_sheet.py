"""A painting with a stroke off its sheet, at every door: nothing is drawn, and no machine is opened."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import maulstick as ms
from maulstick.errors import InputError
from maulstick.painting.painting_file import write_painting
from maulstick.studio.wording import error_text
from maulstick.studio.workers.planned_paints import planned_paints
from tests.cli.conftest import run
from tests.support.robot.small_paintings import SIX

FAULT = (
    "stroke 12 reaches 40 mm beyond the sheet of 60 x 40 mm, onto a machine's bed; at most 1 mm is allowed: "
    "move the stroke, or give a larger sheet"
)


@pytest.fixture
def painting(tmp_path: Path) -> Path:
    """Return a file whose third stroke, of id 12, ends 40 mm right of the sheet."""
    path = tmp_path / "painting.json"
    write_painting(SIX, path)
    content = json.loads(path.read_text())
    content["strokes"][2]["trajectory"][-1][0] = 0.1
    path.write_text(json.dumps(content))
    path.with_name("copy.json").write_text(json.dumps(content))
    return path


@pytest.mark.parametrize(
    "words",
    [
        ("paint", "{}", "--robot", "sim"),
        ("render", "{}"),
        ("show", "{}"),
        ("compare", "{}", "copy.json", "--out", "both.png"),
        ("export", "{}", "--format", "gcode"),
        ("mix", "{}"),
    ],
    ids=lambda words: words[0],
)
def test_a_command_refuses_a_stroke_off_the_sheet_by_its_id_and_writes_nothing(
    painting: Path, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(painting.parent)
    ran = run(*(word.format(painting.name) for word in words))
    assert ran.code == 2
    assert ran.mistake == f"painting.json is not a painting: {FAULT}"
    assert {path.name for path in painting.parent.iterdir()} == {"copy.json", "painting.json"}


@pytest.mark.parametrize("door", [ms.read_painting, ms.render, lambda path: ms.paint(path, robot="sim")])
def test_python_refuses_a_stroke_off_the_sheet_by_its_id(painting: Path, door: Callable[[Path], object]) -> None:
    with pytest.raises(InputError) as caught:
        door(painting)
    assert str(caught.value) == f"{painting} is not a painting: {FAULT}"


def test_the_studio_refuses_a_stroke_off_the_sheet_by_its_id(painting: Path) -> None:
    with pytest.raises(InputError) as caught:
        planned_paints(painting, None)
    assert error_text(caught.value) == f"{painting} is not a painting: {FAULT}"
