import json
import re

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.painting.painting import Painting
from maulstick.robot.easel import Pen
from maulstick.robot.export.export import as_gcode, as_hpgl, as_json
from maulstick.robot.export.gcode import Dialect
from maulstick.robot.routine import Draw, routine
from maulstick.storage.arrays import Floats
from tests.support.robot.recorder import EASEL, LIMITS
from tests.support.robot.small_paintings import SIX, line, painting_of
from tests.support.robot.trays import TRAY
from tests.support.tolerances import GCODE_METRES, HPGL_METRES

LIFTS = LIMITS.model_copy(update={"varies_pressure": False})
ONE = painting_of([line(0, (0.01, 0.02), (0.03, 0.02), pressure=(0.2, 0.8))])


def places_of(text: str) -> Floats:
    """Return the places (n, 3) that lines of G-code go to, metres; z stays where it is left out."""
    here, places = [np.nan] * 3, []
    for words in (dict(re.findall(r"([GXYZ])(-?[\d.]+)", row)) for row in text.splitlines() if row.startswith("G1")):
        here = [float(words[axis]) if axis in words else at for axis, at in zip("XYZ", here, strict=True)]
        places.append(here)
    return 1e-3 * np.array(places)


def test_gcode_lifts_first_and_then_goes_along_every_path() -> None:
    actions = routine(SIX, EASEL, LIMITS)
    text = as_gcode(actions, LIMITS, "grbl", None)
    assert text.endswith("\n")
    assert text.splitlines()[:5] == ["G21", "G90", "G94", "G54", "G1 Z5.000 F6000.0"]
    places = places_of(text)[1:]
    for draw in (action for action in actions if isinstance(action, Draw)):
        motion = draw.motion
        wanted = [motion.start, *motion.path, [*motion.path[-1, :2], motion.after]]
        assert np.abs(places[: len(wanted)] - wanted).max() < GCODE_METRES
        places = places[len(wanted) :]
    assert len(places) == 0


@pytest.mark.parametrize(("dialect", "pause"), [("grbl", "(put in the marker with the paint #1a33b2)\nM0"),
                                                ("marlin", "M0 put in the marker with the paint #1a33b2")])  # fmt: skip
def test_gcode_waits_for_the_pen_to_be_changed_while_it_is_lifted(dialect: Dialect, pause: str) -> None:
    text = as_gcode(routine(SIX, EASEL, LIMITS), LIMITS, dialect, None)
    assert text.count("M0") == 2
    before, after = text.split(pause)
    assert places_of(before)[-1, 2] == pytest.approx(EASEL.travel)
    assert len(after.splitlines()) == 1 + 3 * 7


def test_gcode_lifts_above_the_tray_before_it_goes_there() -> None:
    text = as_gcode(routine(SIX, EASEL, LIMITS, TRAY), LIMITS, "grbl", None)
    assert places_of(text)[0, 2] == TRAY.clearance


def test_gcode_of_a_servo_moves_no_height() -> None:
    text = as_gcode(routine(SIX, EASEL, LIFTS), LIFTS, "grbl", Pen(up=30, down=90))
    assert "Z" not in text
    assert text.count("M3 S90") == 6
    assert text.count("M3 S30") == 7


def test_gcode_outside_the_limits_is_not_written() -> None:
    actions = routine(SIX, EASEL, LIMITS)
    with pytest.raises(InputError, match="the machine's x is"):
        as_gcode(actions, LIMITS.model_copy(update={"upper": (0.02, 0.1, 0.1)}), "grbl", None)


def test_gcode_of_a_machine_whose_origin_is_outside_its_limits_never_goes_there() -> None:
    easel = EASEL.model_copy(update={"corner": (0.3, 0.3, 0.0)})
    limits = LIMITS.model_copy(update={"lower": (0.3, 0.2, -0.02), "upper": (0.4, 0.3, 0.1)})
    places = places_of(as_gcode(routine(SIX, easel, limits), limits, "grbl", None))
    assert np.isnan(places[0, :2]).all(), "the first motion is up"
    assert places[1:, :2].min() > 0.2


def test_hpgl_draws_every_path_with_a_pen_a_paint() -> None:
    easel = EASEL.model_copy(update={"corner": (0.0, 0.04, 0.0)})
    actions = routine(SIX, easel, LIFTS)
    (load,) = as_hpgl(actions, LIFTS)
    text = load.text
    assert re.findall(r"SP(\d)", text) == ["1", "2", "0"]
    draws = [action for action in actions if isinstance(action, Draw)]
    rows = re.findall(r"PU(-?\d+,-?\d+);PD([-\d,]+);", text)
    assert len(rows) == len(draws)
    for draw, (start, rest) in zip(draws, rows, strict=True):
        units = np.array(f"{start},{rest}".split(","), dtype=float).reshape(-1, 2)
        assert np.abs(units * 0.025e-3 - draw.motion.path[:, :2]).max() < HPGL_METRES


def test_hpgl_has_no_tray() -> None:
    with pytest.raises(InputError, match="HPGL knows pens and no wells; leave out the tray, or export gcode"):
        as_hpgl(routine(SIX, EASEL, LIMITS, TRAY), LIMITS)


def test_json_is_an_object_a_line_with_all_that_a_machine_needs() -> None:
    (entry,) = (json.loads(row) for row in as_json(routine(ONE, EASEL, LIMITS)).splitlines())
    assert (entry["do"], entry["stroke"], entry["paint"]) == ("draw", 0, 0)
    assert entry["path"][0] == [0.01, -0.02, -0.0016]
    assert entry["path"][-1] == [0.03, -0.02, -0.0064]
    assert (entry["above"], entry["after"]) == (EASEL.travel, EASEL.travel)
    assert set(entry["speed"]) == {LIMITS.speed}


@pytest.mark.parametrize(
    ("painting", "does"),
    [(SIX, ["ask", "draw", "draw", "draw", "ask", "draw", "draw", "draw"]), (ONE, ["draw"])],
)
def test_json_says_when_a_person_is_needed(painting: Painting, does: list[str]) -> None:
    entries = [json.loads(row) for row in as_json(routine(painting, EASEL, LIMITS)).splitlines()]
    assert [entry["do"] for entry in entries] == does
    assert all(entry["message"].startswith("put in the marker") for entry in entries if entry["do"] == "ask")


def test_json_has_the_visits_to_the_tray() -> None:
    entries = [json.loads(row) for row in as_json(routine(SIX, EASEL, LIMITS, TRAY)).splitlines()]
    visits = [entry["do"] for entry in entries if entry["do"] != "draw"]
    assert visits[:1] == ["dip"]
    assert visits[visits.index("rinse") :][:3] == ["rinse", "wipe", "dip"]
