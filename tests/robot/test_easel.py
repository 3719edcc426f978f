import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pydantic import ValidationError

from maulstick.errors import InputError, OutputError
from maulstick.robot.easel import Easel, Pen, read_easel, write_easel
from tests.support.robot.recorder import EASEL, LIMITS
from tests.support.tolerances import FLOAT64_METRES_NEAR

angles = st.floats(-0.5, 0.5)
lengths = st.floats(-1, 1)


@st.composite
def easels(draw: st.DrawFn, angle: st.SearchStrategy[float] = angles) -> Easel:
    """Sheets that face upwards, tilted about both axes and turned about the third."""
    about_x, about_y, about_z = draw(angle), draw(angle), draw(st.floats(-np.pi, np.pi))
    (cx, cy, cz), (sx, sy, sz) = np.cos([about_x, about_y, about_z]), np.sin([about_x, about_y, about_z])
    turn = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    tilt = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    right, down = (tilt @ turn @ np.array([[1.0, 0, 0], [0, -1.0, 0]]).T).T.tolist()
    return Easel(corner=(draw(lengths), draw(lengths), draw(lengths)), right=right, down=down)


@given(easels(), arrays(np.float64, (4, 3), elements=lengths))
def test_a_place_comes_back_from_the_machine(easel: Easel, path: np.ndarray[Any, Any]) -> None:
    there = easel.canvas_to_machine(path)
    assert np.abs(easel.machine_to_canvas(there) - path).max() < FLOAT64_METRES_NEAR
    assert (
        np.abs(
            np.diff(np.linalg.norm(there[:, None] - there, axis=-1) - np.linalg.norm(path[:, None] - path, axis=-1))
        ).max()
        < FLOAT64_METRES_NEAR
    )


@given(easels())
def test_the_corner_touches_and_height_goes_up(easel: Easel) -> None:
    assert np.allclose(easel.canvas_to_machine(np.zeros(3)), easel.corner)
    assert easel.canvas_to_machine(np.array([0, 0, 0.01]))[2] > easel.corner[2]


def test_x_runs_along_right_y_along_down_and_height_along_up() -> None:
    easel = Easel(corner=(0.1, 0.2, 0.3), right=(0, 1, 0), down=(1, 0, 0))
    assert np.allclose(easel.up, (0, 0, 1))
    assert np.allclose(easel.canvas_to_machine(np.array([0.01, 0.02, 0.03])), (0.12, 0.21, 0.33))


def test_the_tilt_is_the_angle_of_the_paper_against_the_machine() -> None:
    easel = Easel(corner=(0, 0, 0), right=(np.cos(0.1), 0, np.sin(0.1)), down=(0, -1, 0))
    assert easel.tilt == pytest.approx(0.1)
    assert EASEL.tilt == 0


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"right": (1, 0.01, 0)}, "two unit vectors at a right angle"),
        ({"right": (2, 0, 0)}, "two unit vectors at a right angle"),
        ({"down": (1, 0, 0)}, "two unit vectors at a right angle"),
        ({"down": (np.nan, 0, 0)}, "two unit vectors at a right angle"),
        ({"down": (0, 1, 0)}, "faces away from the machine"),
        ({"corner": (0, np.inf, 0)}, "is not a place"),
        ({"travel": 0}, "greater than 0"),
        ({"deepest": -1e-3}, "greater than or equal to 0"),
        ({"depth": 1e-3}, "Extra inputs"),
    ],
)
def test_what_is_no_sheet_before_the_machine_is_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Easel.model_validate({**EASEL.model_dump(), **change})


@given(easels(), st.floats(-0.01, 0.01), st.floats(-0.01, 0.01), st.floats(-0.1, 0.1))
def test_a_shifted_sheet_has_moved_and_turned_in_its_own_plane(easel: Easel, dx: float, dy: float, turn: float) -> None:
    moved = easel.shifted(dx, dy, turn)
    assert np.allclose(moved.up, easel.up)
    assert np.allclose(easel.machine_to_canvas(np.array(moved.corner)), (dx, dy, 0), atol=FLOAT64_METRES_NEAR)
    point = easel.machine_to_canvas(moved.canvas_to_machine(np.array([0.1, 0, 0])))
    assert np.allclose(point, (dx + 0.1 * np.cos(turn), dy + 0.1 * np.sin(turn), 0), atol=FLOAT64_METRES_NEAR)


def test_an_easel_is_equal_to_that_in_its_file(tmp_path: Path) -> None:
    easel = EASEL.model_copy(update={"limits": LIMITS, "pen": Pen(up=40, down=60), "error": 1e-4})
    write_easel(easel, tmp_path / "easel.json")
    assert read_easel(tmp_path / "easel.json") == easel


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("{", "is not an easel: "),
        ("[]", "is not an easel: "),
        (json.dumps({"corner": [0, 0, 0], "right": [1, 0, 0], "down": [0, 1, 0]}), "the paper faces away"),
        (json.dumps({"corner": [0, 0], "right": [1, 0, 0], "down": [0, -1, 0]}), "corner"),
        (
            json.dumps({"corner": [0, 160, 0], "right": [1, 0, 0], "down": [0, -1, 0]}),
            r"easel.json has its corner at 160 m; it must be at most 100, so divide millimetres by 1000",
        ),
        (
            json.dumps({"corner": [0, -0.1, 0], "right": [1, 0, 0], "down": [0, -1, 0], "travel": 5}),
            r"easel.json has its travel at 5 m; it must be at most 1, so divide millimetres by 1000",
        ),
        (
            json.dumps({"schema_version": 2, "corner": [0, 0, 0], "right": [1, 0, 0], "down": [0, -1, 0]}),
            "schema_version",
        ),
        (
            json.dumps({"corner": [0, 0, 0], "right": [1, 0, 0], "down": [0, -1, 0], "pen": {"up": 5, "down": 5}}),
            "pen: up and down are the same, so the pen is never lifted; give two numbers that differ",
        ),
        ("", "is empty"),
    ],
)
def test_a_file_that_is_no_easel_is_refused_in_one_sentence(tmp_path: Path, content: str, said: str) -> None:
    (tmp_path / "easel.json").write_text(content)
    with pytest.raises(InputError, match=said) as caught:
        read_easel(tmp_path / "easel.json")
    assert "\n" not in str(caught.value)


def test_an_easel_that_cannot_be_written_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError):
        write_easel(EASEL, tmp_path / "none" / "easel.json")
