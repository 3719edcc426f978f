"""Reaches against whole kinematics: what they accept has a pose, with the range of each joint, and a pen downwards."""

from pathlib import Path
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from maulstick.robot.adapters.reaches import FRANKA_REACH, UFACTORY_REACHES, UR_REACHES
from maulstick.robot.reach import Reach
from maulstick.storage.arrays import Floats
from tests.support.robot.kinematics import CHAINS

DOWNWARDS: Final = np.diag([1.0, -1.0, -1.0])
REACHES: Final = {
    **UR_REACHES,
    **{reach.model: reach for reach in UFACTORY_REACHES.values()},
    "FER": FRANKA_REACH,
    "FR3": FRANKA_REACH,
}
PENS: Final = (0.05, 0.12, 0.2)  # metres below the flange
LOWEST, HIGHEST = -0.1, 0.15  # metres: heights of a sheet above the base


def held(reach: Reach, pen: float) -> Reach:
    return reach.holding(DOWNWARDS, np.array([0.0, 0.0, pen]))


def about(reach: Reach, rng: np.random.Generator, count: int) -> Floats:
    """Return places (count, 3) about the base, at the heights of a sheet, a little farther than printed."""
    radius, turn = rng.uniform(0, 1.1 * reach.printed, count), rng.uniform(-np.pi, np.pi, count)
    heights = rng.uniform(LOWEST, HIGHEST, count)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), heights], axis=1)


def test_the_table_of_the_documentation_is_that_of_the_code() -> None:
    rows = []
    for reach in dict.fromkeys(REACHES.values()):
        _, (least,), (most,) = held(reach, 0.12).radii(np.zeros((1, 3)))
        rows.append(f"| {reach.model} | {1e3 * reach.printed:.0f} | {1e3 * least:.0f} to {1e3 * most:.0f} |")
    assert "\n".join(rows) in (Path(__file__).parents[2] / "docs" / "machines.md").read_text()


def test_every_model_has_kinematics_to_be_compared_with() -> None:
    assert set(REACHES) == set(CHAINS)


@pytest.mark.parametrize("pen", PENS)
@pytest.mark.parametrize("model", REACHES)
def test_whatever_a_reach_accepts_has_a_pose_with_the_pen_downwards(model: str, pen: float) -> None:
    rng = np.random.default_rng(0)
    reach = held(REACHES[model], pen)
    places = about(reach, rng, 150)
    accepted = places[reach.beyond(places) == 0]
    assert len(accepted) > 30
    found = CHAINS[model].reaches(accepted, pen, 60, rng)
    assert accepted[~found].round(3).tolist() == []


@pytest.mark.parametrize("model", REACHES)
def test_a_reach_refuses_what_has_no_pose_and_little_of_what_has_one(model: str) -> None:
    rng = np.random.default_rng(0)
    reach = held(REACHES[model], 0.12)
    places = about(reach, rng, 200)
    possible = CHAINS[model].reaches(places, 0.12, 20, rng)
    accepted = reach.beyond(places) == 0
    assert not accepted[np.hypot(*places[:, :2].T) > 1.001 * reach.printed].any(), "no farther than it is printed"
    assert accepted[possible].mean() > 0.5, "a reach is no excuse"


@given(st.sampled_from(sorted(REACHES)), st.floats(0.1, 2.0), st.floats(-np.pi, np.pi), st.floats(LOWEST, HIGHEST))
def test_a_place_is_reached_whatever_its_direction_and_moved_by_what_is_beyond(
    model: str, radius: float, turn: float, height: float
) -> None:
    reach = held(REACHES[model], 0.12)
    ahead = np.array([np.cos(turn), np.sin(turn), 0.0])
    place = radius * ahead + [0, 0, height]
    (beyond,) = reach.beyond(place[None])
    assert beyond == pytest.approx(reach.beyond(np.array([[radius, 0.0, height]]))[0], abs=1e-9)
    assert reach.beyond((place - (beyond + np.copysign(1e-9, beyond)) * ahead)[None])[0] == 0


@pytest.mark.parametrize(
    ("model", "radius", "fault"),
    [
        ("UR3e", 0.96, "too far from the base of the UR3e, whose wrist gets 498 mm from its axis at that height"),
        ("UR3e", 0.13, "too near to the base of the UR3e, whose wrist must stay 216 mm from its axis at that height"),
        ("Lite 6", 0.5, "too far from the base of the Lite 6"),
        ("Franka", 0.2, "too near to the base of the Franka"),
    ],
)
def test_what_is_wrong_with_a_place_is_said_with_by_how_much(model: str, radius: float, fault: str) -> None:
    reach = held({**REACHES, "Franka": FRANKA_REACH}[model], 0.1)
    place = np.array([0.0, radius, 0.0])
    assert fault in reach.fault(place)
    assert reach.fault(place).startswith(f"is {1e3 * abs(reach.beyond(place[None])[0]):.3g} mm too")


@pytest.mark.parametrize(("height", "word"), [(1.2, "high"), (-0.9, "low")])
def test_a_place_above_or_below_all_reach_is_said_to_be_that(height: float, word: str) -> None:
    reach = held(REACHES["UR3e"], 0.1)
    place = np.array([0.3, 0.0, height])
    assert reach.beyond(place[None])[0] != 0
    assert reach.fault(place) == f"is too {word} for the UR3e at any distance from its base"


def test_a_pen_held_aside_moves_the_wrist_and_not_the_reach() -> None:
    reach = REACHES["UR5e"].holding(DOWNWARDS, np.array([0.06, 0.0, 0.1]))
    np.testing.assert_allclose(reach.wrist, (-0.06, 0.0, 0.1996), atol=1e-12)
    turned = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    np.testing.assert_allclose(
        REACHES["UR5e"].holding(turned, np.array([0.06, 0.0, 0.1])).wrist, (0.0, -0.06, 0.1996), atol=1e-12
    )
