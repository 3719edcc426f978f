"""Tables of how well plans hold their hands, from rows that were kept."""

import numpy as np
from kept import Row, rows_of, table

KS = ("ks_length", "ks_chord", "ks_turning", "ks_roughness")
RATIOS = ("p90_ratio", "top_tenth_ratio", "longest_ratio", "edge_ink_ratio")


def held_table() -> str:
    """By brush and colours, before and now: mean and worst over hands, with the picture chelsea and seed 0."""
    return _table("hands", [row for row in rows_of("held") if _is_first(row)])


def held_elsewhere_table() -> str:
    """By brush and colours: mean and worst over three hands, two other pictures and three seeds."""
    return _table("rows", [row for row in rows_of("held") if not _is_first(row)])


def _is_first(row: Row) -> bool:
    return (row["picture"], row["seed"]) == ("chelsea", 0)


def _table(counted: str, rows: list[Row]) -> str:
    kinds = dict.fromkeys((row["brush"], row["paints"], row["plan"]) for row in rows)
    lines = []
    for brush, paints, plan in sorted(kinds, key=str):
        of = [row for row in rows if (row["brush"], row["paints"], row["plan"]) == (brush, paints, plan)]
        colours = "one ink" if paints is None else f"{paints} paints"
        line = [f"{brush}, {colours}", plan, str(len(of)), *(_mean_and_worst(of, key) for key in KS)]
        lines.append([*line, *(_worst(of, key) for key in RATIOS), f"{np.mean([row['novelty'] for row in of]):.2f}"])
    head = ["brush", "plans", counted, "length", "chord", "turning", "roughness", "90 % length", "longest tenth"]
    return table([*head, "longest", "ink at the edge", "novelty"], lines)


def _mean_and_worst(rows: list[Row], key: str) -> str:
    found = [row[key] for row in rows]
    return f"{np.mean(found):.2f}, {max(found):.2f}"


def _worst(rows: list[Row], key: str) -> str:
    return f"{max(row[key] for row in rows):.2f}"
