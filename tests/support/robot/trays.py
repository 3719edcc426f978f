"""A tray to the right of the small sheets of the tests, with wells for their two paints."""

from typing import Any, Final

from maulstick.robot.tray import Tray

TRAY_JSON: Final[dict[str, Any]] = {
    "schema_version": 1,
    "reach": 0.04,
    "clearance": 0.03,
    "paints": {
        "#cc1a1a": {"x": 0.1, "y": 0.0, "height": -0.004},
        "#1a33b2": {"x": 0.1, "y": 0.03, "height": -0.004},
    },
    "water": {"x": 0.12, "y": 0.0, "height": -0.01, "turns": 3},
    "cloth": {"x": 0.12, "y": 0.03, "height": 0.001},
}
"""The content of the tray's file."""

TRAY: Final = Tray.model_validate(TRAY_JSON)
