"""Table of how near paintings on a simulated easel come to their pictures, from rows that were kept."""

import numpy as np
from intervals import interval, mean
from kept import rows_of, table

COLUMNS = {
    "planned": "planned",
    "planned_again": "planned again",
    "calibrated": "calibrated",
    "replanned": "replanned",
    "floor": "floor",
    "calibrated_plan": "to plan",
    "last_plan": "last to plan",
    "last_floor": "last floor",
}


def sim_to_real_table() -> str:
    """Means over pairs of a medium, and what replanning changes, with its interval by bootstrap over pairs."""
    rows = rows_of("sim_to_real")
    lines = []
    for medium in sorted({row["medium"] for row in rows}):
        of = [row for row in rows if row["medium"] == medium]
        changes = 100 * np.array([row["replanned"] / row["calibrated"] - 1 for row in of])
        low, high = interval([changes], mean)
        means = [f"{np.mean([row[key] for row in of]):.2f}" for key in COLUMNS]
        lines.append([medium, f"{len(of)}", *means, f"{changes.mean():+.1f} % ({low:+.1f} to {high:+.1f})"])
    return table(["medium", "pairs", *COLUMNS.values(), "change"], lines)
