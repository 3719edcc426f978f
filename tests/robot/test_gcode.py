import re

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.robot.adapters.grbl_stream import BUFFER
from maulstick.robot.easel import Easel, Pen
from maulstick.robot.export.gcode import Dialect, Gcode
from maulstick.robot.limits import SLACK, Limits
from maulstick.storage.arrays import Floats
from tests.support.tolerances import FEED, GCODE_METRES

LIMITS = Limits(
    lower=(0, 0, -0.01),
    upper=(0.3, 0.2, 0.05),
    speed=0.1,
    climb=0.02,
    acceleration=0.5,
    deviation=1e-5,
    varies_pressure=True,
)
SERVO = Pen(up=500, down=700, seconds=0.25)
ABOVE = np.array([0.01, 0.02, 0.005])
PATH = np.array([[0.01, 0.02, 0.0], [0.04, 0.06, -0.001], [0.1234567, 0.06, -0.002]])
SPEED = np.array([0.05, 0.03, 0.04])


def places(lines: list[str], start: Floats) -> Floats:
    """Read where each line that moves goes to, metres, independently of the package."""
    at, reached = start.copy(), []
    for line in lines:
        words = {word[0]: float(word[1:]) for word in re.findall(r"[XYZ]-?\d+\.\d+", line)}
        if line.startswith("G1"):
            at = np.array([1e-3 * words[axis] if axis in words else at[i] for i, axis in enumerate("XYZ")])
            reached.append(at)
    return np.array(reached).reshape(-1, 3)


def feeds(lines: list[str]) -> list[float]:
    """Return the speed of each line that has a feed, metres per second."""
    return [float(found[1]) / 60e3 for line in lines if (found := re.search(r"F([\d.]+)", line))]


def test_what_is_written_is_the_path_to_half_a_micrometre() -> None:
    gcode = Gcode("grbl", LIMITS)
    lines = gcode.draw(ABOVE, PATH, SPEED)
    np.testing.assert_allclose(places(lines, ABOVE), PATH, atol=GCODE_METRES)
    np.testing.assert_allclose(places(lines, ABOVE), gcode.rounded(PATH), atol=1e-12)


def test_a_feed_is_the_smaller_speed_of_a_segments_ends() -> None:
    np.testing.assert_allclose(feeds(Gcode("grbl", LIMITS, SERVO).draw(ABOVE, PATH, SPEED)), [0.03, 0.03], rtol=FEED)


def test_height_changes_no_faster_than_the_machine_can() -> None:
    steep = np.array([[0.01, 0.02, 0.0], [0.013, 0.02, -0.004]])
    lowering, along = feeds(Gcode("grbl", LIMITS).draw(ABOVE, steep, np.full(2, 0.1)))
    assert lowering == pytest.approx(LIMITS.climb, rel=FEED)
    assert along * 0.8 == pytest.approx(LIMITS.climb, rel=FEED)


def test_a_pen_with_a_servo_has_no_height() -> None:
    gcode = Gcode("grbl", LIMITS, SERVO)
    lines = [*gcode.begin(), *gcode.travel(ABOVE, ABOVE), *gcode.draw(ABOVE, PATH, SPEED), *gcode.lift(ABOVE)]
    assert not [line for line in lines if "Z" in line]


@pytest.mark.parametrize(
    ("dialect", "lowered"),
    [("grbl", ["M3 S700", "G4 P0.250"]), ("marlin", ["M400", "M280 P0 S700", "G4 P250"])],
)
def test_a_servo_gets_its_time(dialect: Dialect, lowered: list[str]) -> None:
    assert Gcode(dialect, LIMITS, SERVO).draw(ABOVE, PATH, SPEED)[: len(lowered)] == lowered


@pytest.mark.parametrize("dialect", ["grbl", "marlin"])
def test_a_tip_without_a_servo_is_lifted_straight_up(dialect: Dialect) -> None:
    assert Gcode(dialect, LIMITS).lift(ABOVE) == ["G1 Z5.000 F1200.0"]


def test_a_pause_tells_why_in_each_dialect() -> None:
    message = "take the red\npen (2); then go on"
    assert Gcode("grbl", LIMITS).pause(message) == ["(take the redpen 2 then go on)", "M0"]
    assert Gcode("marlin", LIMITS).pause(message) == ["M0 take the redpen 2 then go on"]


@pytest.mark.parametrize("name", ["STEP 2", "PASS 1 red", "S2", "stripes -3", "P .5", "P+1"])
def test_a_name_is_no_time_that_marlin_waits_instead_of_for_a_person(name: str) -> None:
    """Its parser takes a letter and a number after it, with or without spaces, for a parameter: M0 P and S end."""
    (line,) = Gcode("marlin", LIMITS).pause(f"put in the pen with the paint {name} #cc1a1a")
    assert re.search(r"[PS] *[-+.]?\d", line, re.IGNORECASE) is None
    assert line.replace(":", "").endswith(f"the paint {name} #cc1a1a")


def test_a_message_keeps_its_letters_without_their_accents() -> None:
    assert Gcode("grbl", LIMITS).pause("put in Blaugrün weiß, Éclat ½")[0] == "(put in Blaugrun weiss, Eclat)"


LONG = "put in the copic-multiliner-0.35 with the paint deep ultramarine, a little green #12406f"


def test_a_long_message_is_told_to_its_end() -> None:
    *comments, stop = Gcode("grbl", LIMITS).pause(LONG)
    assert (" ".join(comment[1:-1] for comment in comments), stop) == (LONG, "M0")
    assert max(map(len, comments)) < BUFFER
    comment, stop = Gcode("marlin", LIMITS).pause(LONG)
    assert comment == f"; {LONG}"
    assert stop == f"M0 {LONG[:57]}..."


def test_no_letter_of_a_message_is_a_command() -> None:
    every = "".join(map(chr, range(0x250)))
    for start in range(0, len(every), 50):
        comment, _ = Gcode("grbl", LIMITS).pause(every[start : start + 50])
        assert comment.isascii()
        assert not set(comment[1:-1]) & set("?!~();\x18\n\r")


def test_all_is_in_millimetres_and_absolute() -> None:
    assert {"G21", "G90"} <= set(Gcode("grbl", LIMITS).begin())
    assert {"G21", "G90"} <= set(Gcode("marlin", LIMITS).begin())


def test_nothing_is_written_that_leaves_the_limits() -> None:
    outside = PATH + np.array([0.2, 0, 0])
    with pytest.raises(InputError, match=r"the machine's x is 323\.457 mm; it must be 0 to 300 mm: 23\.46 mm less far"):
        Gcode("grbl", LIMITS).draw(ABOVE, outside, SPEED)
    with pytest.raises(InputError, match="the machine's x"):
        Gcode("grbl", LIMITS).travel(ABOVE, outside[2])
    with pytest.raises(InputError, match="the machine's z"):
        Gcode("grbl", LIMITS, SERVO).lift(ABOVE + np.array([0, 0, 0.1]))
    with pytest.raises(InputError, match=r"the speed is 200 mm/s"):
        Gcode("grbl", LIMITS).draw(ABOVE, PATH, SPEED * 4)


@st.composite
def a_machine(draw: st.DrawFn) -> Limits:
    low = st.floats(-0.3, 0.1)
    room = st.floats(1e-3, 0.4)
    lower = [draw(low) for _ in range(3)]
    return Limits(
        lower=tuple(lower),
        upper=tuple(value + draw(room) for value in lower),
        speed=draw(st.floats(1e-3, 0.5)),
        climb=draw(st.floats(1e-3, 0.5)),
        acceleration=0.5,
        varies_pressure=True,
    )


@given(
    limits=a_machine(),
    dialect=st.sampled_from(["grbl", "marlin"]),
    pen=st.sampled_from([None, SERVO]),
    corner=st.tuples(*[st.floats(-0.1, 0.3)] * 3),
    turn=st.floats(-3.2, 3.2),
    seed=st.integers(0, 2**32 - 1),
    reach=st.floats(0, 0.2),
)
@example(  # a thousandth of a last digit below a round feed
    limits=LIMITS.model_copy(update={"speed": 0.1860283318547222, "climb": 0.5}),
    dialect="grbl",
    pen=None,
    corner=(0.0, 0.0, 0.0),
    turn=0.0,
    seed=0,
    reach=0.0,
)
def test_whatever_strokes_easel_and_pen_nothing_beyond_the_limits_is_written(
    limits: Limits,
    dialect: Dialect,
    pen: Pen | None,
    corner: tuple[float, float, float],
    turn: float,
    seed: int,
    reach: float,
) -> None:
    rng = np.random.default_rng(seed)
    easel = Easel(corner=corner, right=(1, 0, 0), down=(0, -1, 0)).shifted(0, 0, turn)
    path = easel.canvas_to_machine(rng.uniform(-reach, reach, (8, 3)))
    if rng.uniform() < 0.5:  # so that many do lie inside, some of them on its very edge
        path = np.clip(path, limits.lower, limits.upper)
    speed = limits.speed * rng.uniform(0.01, 1, 8)
    gcode = Gcode(dialect, limits, pen)
    start = np.clip(path[0] + (0, 0, 0.005), limits.lower, limits.upper)
    try:
        lines = [*gcode.travel(start, start), *gcode.draw(start, path, speed), *gcode.lift(start)]
    except InputError:
        assert np.any((path < limits.lower) | (path > limits.upper))
        return
    reached = places(lines, start)
    assert np.all(reached >= np.array(limits.lower) - SLACK)
    assert np.all(reached <= np.array(limits.upper) + SLACK)
    assert max(feeds(lines)) <= limits.speed + SLACK
