import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.robot.tray import Tray, Well, read_tray
from tests.support.robot.small_paintings import SIX
from tests.support.robot.trays import TRAY, TRAY_JSON


def fault(tmp_path: Path, content: str) -> str:
    (tmp_path / "tray.json").write_text(content)
    with pytest.raises(InputError) as caught:
        read_tray(tmp_path / "tray.json")
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_tray_is_read_from_its_file(tmp_path: Path) -> None:
    (tmp_path / "tray.json").write_text(json.dumps(TRAY_JSON))
    assert read_tray(tmp_path / "tray.json") == TRAY


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"schema_version": 2}, "schema_version"),
        ({"reach": 0}, "reach"),
        ({"reach": 600}, "it is 600 m; it must be at most 20, so divide millimetres by 1000"),
        ({"speed": -1}, "speed"),
        ({"depth": 1}, "depth"),
        (
            {"water": {"x": 0.08, "y": 0.0, "height": 0.03}},
            "water: its height 0.03 m is not below the clearance 0.03 m",
        ),
        ({"cloth": {"x": 0.08, "y": 0.0}}, "cloth.height"),
        ({"cloth": {"x": 0.08, "y": 0.0, "height": 0.0, "turns": 21}}, "cloth.turns"),
    ],
)
def test_a_file_that_is_no_tray_is_refused_with_the_field(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    assert said in fault(tmp_path, json.dumps({**TRAY_JSON, **change}))


def test_a_file_that_is_not_json_is_refused(tmp_path: Path) -> None:
    assert "is not a tray: " in fault(tmp_path, "dip, dip")


def test_a_tray_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^there is no tray "):
        read_tray(tmp_path / "none.json")


def test_wells_are_found_by_the_colour_or_the_name_of_a_paint() -> None:
    assert TRAY.wells_of(SIX) == [TRAY.paints["#cc1a1a"], TRAY.paints["#1a33b2"]]
    named = SIX.paints[0].model_copy(update={"name": "madder"})
    tray = TRAY.model_copy(update={"paints": {"madder": TRAY.water, "#1a33b2": TRAY.cloth}})
    assert tray.wells_of(SIX.model_copy(update={"paints": (named, SIX.paints[1])})) == [TRAY.water, TRAY.cloth]


def test_a_colour_may_be_written_in_capitals() -> None:
    wells = TRAY_JSON["paints"]
    tray = Tray.model_validate({**TRAY_JSON, "paints": {name.upper(): well for name, well in wells.items()}})
    assert tray == TRAY


def test_a_colour_that_is_named_twice_loses_no_well_without_a_word() -> None:
    wells = {"#CC1A1A": TRAY_JSON["water"], **TRAY_JSON["paints"]}
    with pytest.raises(ValueError, match="a colour is named twice, in small letters and in capitals"):
        Tray.model_validate({**TRAY_JSON, "paints": wells})


def test_paints_of_several_brushes_share_the_well_of_their_colour() -> None:
    shared = SIX.model_copy(update={"paints": (SIX.paints[0], SIX.paints[0])})
    TRAY.check_places(shared, {0, 1}, rinsed=True)
    madder = SIX.paints[0].model_copy(update={"name": "madder", "colour": SIX.paints[1].colour})
    lake = madder.model_copy(update={"name": "lake"})
    tray = TRAY.model_copy(
        update={"paints": {"madder": TRAY.paints["#cc1a1a"], "lake": TRAY.paints["#cc1a1a"].model_copy()}}
    )
    with pytest.raises(InputError, match="the well of #1a33b2 and the well of #1a33b2 of the tray are 0 mm apart"):
        tray.check_places(SIX.model_copy(update={"paints": (madder, lake)}), {0, 1}, rinsed=True)


def test_a_paint_without_a_well_is_refused_with_those_that_there_are() -> None:
    tray = TRAY.model_copy(update={"paints": {"#cc1a1a": TRAY.water}})
    with pytest.raises(InputError) as caught:
        tray.wells_of(SIX)
    assert str(caught.value) == "the tray has no well for the paint #1a33b2; there are: #cc1a1a; add it to its file"


def test_in_a_well_the_tip_goes_in_at_the_middle_turns_and_comes_out_there() -> None:
    path = Well(x=0.1, y=0.2, height=-0.004, radius=2e-3, turns=3).path()
    assert np.array_equal(path[[0, -1]], [[0.1, 0.2, -0.004]] * 2)
    assert np.all(path[:, 2] == -0.004)
    around = path[1:-1, :2] - (0.1, 0.2)
    assert np.allclose(np.hypot(*around.T), 2e-3)
    angle = np.unwrap(np.arctan2(around[:, 1], around[:, 0]))
    assert angle[-1] - angle[0] == pytest.approx(3 * 2 * np.pi)
