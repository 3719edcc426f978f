"""Reaches of arms, by their makers' figures; docs/machines.md has them with their sources.

The lengths of links are the makers' Denavit-Hartenberg parameters. tests/robot/test_reach.py has whole kinematics, with
the range of each joint, and finds a pose for every place that a reach accepts.
"""

from typing import Final

import numpy as np

from maulstick.robot.reach import Reach

_STRAIGHT: Final = 0.98  # of the arm's length: straighter, its elbow turns faster than it may, and is then singular
_FOLDED: Final = np.radians(30)  # between the links of a UR at its elbow: closer, they touch


def _ur(model: str, printed: float, d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> Reach:
    """Return the reach of a UR with this printed reach and these Denavit-Hartenberg parameters, metres.

    Its wrist may point to either side, so that it gets nearer than its folded elbow does. Nearer to the axis than the
    wrist's own offsets, the base has to turn too fast, and the wrist runs into the shoulder.
    """
    folded = float(np.sqrt(a2**2 + a3**2 - 2 * a2 * a3 * np.cos(_FOLDED)))
    return Reach(
        model=model,
        shoulder=d1,
        nearest=max(folded - d5, 0.0),
        farthest=_STRAIGHT * (a2 + a3),
        forward=d5,
        sideways=d4,
        printed=printed,
        column=d4 + d5,
        flange=d6,
    )


# Universal Robots, "DH parameters for calculations of kinematics and dynamics", and for the UR30 the maker's
# Universal_Robots_ROS2_Description; the printed reach is that of the data sheets.
UR_REACHES: Final = {
    reach.model: reach
    for reach in (
        _ur("UR3", 0.5, 0.1519, 0.24365, 0.21325, 0.11235, 0.08535, 0.0819),
        _ur("UR3e", 0.5, 0.15185, 0.24355, 0.2132, 0.13105, 0.08535, 0.0921),
        _ur("UR5", 0.85, 0.089159, 0.425, 0.39225, 0.10915, 0.09465, 0.0823),
        _ur("UR5e", 0.85, 0.1625, 0.425, 0.3922, 0.1333, 0.0997, 0.0996),
        _ur("UR10", 1.3, 0.1273, 0.612, 0.5723, 0.163941, 0.1157, 0.0922),
        _ur("UR10e", 1.3, 0.1807, 0.6127, 0.57155, 0.17415, 0.11985, 0.11655),
        _ur("UR16e", 0.9, 0.1807, 0.4784, 0.36, 0.17415, 0.11985, 0.11655),
        _ur("UR20", 1.75, 0.2363, 0.862, 0.7287, 0.201, 0.1593, 0.1543),
        _ur("UR30", 1.3, 0.2363, 0.637, 0.5037, 0.201, 0.1593, 0.1543),
    )
}
"""Reaches of Universal Robots' arms by model, with an e for the e-series."""


def _xarm(model: str) -> Reach:
    """Return the reach of an xArm 5, 6 or 7: the ranges of its joints keep it 0.2 m from its axis."""
    return Reach(
        model=model,
        shoulder=0.267,
        nearest=0.0925,  # of its elbow, bent as far as it goes
        farthest=_STRAIGHT * 0.6406,
        forward=0.076,
        printed=0.7,
        column=0.2,
        flange=0.097,
    )


# UFACTORY, "Kinematic and dynamic parameters" at docs.ufactory.cc, and the ranges of joints in xarm-python-sdk; the
# printed reach is that of the user manuals.
UFACTORY_REACHES: Final = {
    (5, 5): _xarm("xArm 5"),
    (6, 6): _xarm("xArm 6"),
    (7, 3): _xarm("xArm 7"),
    (7, 7): _xarm("xArm 7"),
    (6, 9): Reach(
        model="Lite 6",
        shoulder=0.2433,
        nearest=0.0437,
        farthest=_STRAIGHT * 0.4386,
        printed=0.44,
        column=0.15,
        flange=0.0615,
    ),
    (6, 12): Reach(
        model="UFACTORY 850",
        shoulder=0.364,
        nearest=0.1315,
        farthest=_STRAIGHT * 0.8416,
        printed=0.85,
        column=0.25,
        flange=0.09,
    ),
}
"""Reaches of UFACTORY's arms, by number of axes and device type."""

# Franka Robotics, "Robot limits" and "Denavit-Hartenberg parameters" at frankarobotics.github.io/docs, and 855 mm of
# the data sheets. The elbow does not straighten: its range leaves 0.719 m from shoulder to wrist.
FRANKA_REACH: Final = Reach(
    model="Franka",
    shoulder=0.333,
    nearest=0.211,
    farthest=0.69,
    forward=0.088,
    printed=0.855,
    column=0.28,
    flange=0.107,
)
"""Reach of FER and FR3, whose links are the same."""
