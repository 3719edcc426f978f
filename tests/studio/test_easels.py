"""Easels of the studio: stored by name, and none is lost when another replaces it."""

from pathlib import Path

import pytest

from maulstick.errors import InputError
from maulstick.robot.easel import read_easel
from maulstick.studio.state.easels import Easels
from maulstick.studio.state.folder import Folder
from tests.robot.test_easel import EASEL


def test_an_easel_of_the_same_name_leaves_the_former_one_in_the_trash(tmp_path: Path) -> None:
    moved = EASEL.shifted(0.01, 0.0)
    with Folder.opened(tmp_path) as folder:
        easels = Easels(folder)
        for easel in (EASEL, moved):
            assert easels.keep("My Easel.json", easel.model_dump_json().encode()) == "my-easel"
        with pytest.raises(InputError, match="that file is not an easel: "):
            easels.keep("my-easel.json", b"{}")
    assert read_easel(easels.path("my-easel")) == moved
    (former,) = (tmp_path / "trash").glob("*/[a-z]*")
    assert read_easel(former) == EASEL
