"""Tables of styles, from rows that were kept."""

from itertools import groupby

import numpy as np
from intervals import of_few
from kept import rows_of, table, with_range


def published_table() -> str:
    """The sweep of the paper's recipe: of each row the steps of fine-tuning that serve best; means over trainings."""
    rows = [row for row in rows_of("published") if row["name"] == "sweep"]
    sessions = [key for key in rows[0] if isinstance(rows[0][key], list)]
    lines, recipe = [], ("width", "rate", "weight")
    for number, each in groupby(rows, lambda row: [row[key] for key in recipe]):
        best = min(each, key=lambda row: np.mean([row[session] for session in sessions]))
        trainings = np.mean([best[session] for session in sessions], axis=0).tolist()
        line = [*(f"{value:g}" for value in number), f"{best['steps_fine']:,}"]
        lines.append([*line, *(f"{np.mean(best[session]):.2f}" for session in sessions), with_range(trainings, 2)])
    return table(
        ["width", "rate", "weight of the KL", "steps", *sessions, "all (least, most of five trainings)"], lines
    )


def few_shot_table() -> str:
    """Likeness of twenty strokes' styles, over sessions; then session by session."""
    rows = [row | {"model": row["model"].replace("_", " ")} for row in rows_of("few_shot")]
    hands = {"mocap": "5 mocap, pure test", "mouse": "4 mouse, pure test", "wacom": "15 Wacom, chosen on"}
    lines = []
    for row in sorted((row for row in rows if row["session"] == "all"), key=lambda row: list(hands).index(row["kind"])):
        line = [hands[row["kind"]], row["model"], f"{row['energy']:.2f}"]
        for key in ("normalised", "one_nn"):
            low, high = row[f"{key}_interval"]
            line.append(f"{row[key]:.2f} ({low:.2f} to {high:.2f})")
        by_seed = row["normalised_by_seed"]
        lines.append([*line, f"{min(by_seed):.2f} to {max(by_seed):.2f}", f"{row['novelty']:.2f}"])
    head = ["sessions", "drawn by", "energy", "normalised", "1-NN", "normalised, by seed", "novelty"]
    tested = {(row["session"], row["model"]): row for row in rows if row["kind"] != "wacom" and row["session"] != "all"}
    sessions = list(dict.fromkeys(session for session, _ in tested))
    each = [
        [f"{model}: {title}", *(f"{row[key]:.2f}" if (row := tested.get((at, model))) else "" for at in sessions)]
        for model in ("exemplar", "trajvae", "paper")
        for key, title in (("normalised", "normalised"), ("one_nn", "1-NN"), ("novelty", "novelty"))
    ]
    return table(head, lines) + "\nSession by session:\n\n" + table(["", *sessions], each)


def splines_table() -> str:
    """How near each curve comes to what was drawn: means over drawings, and their 95 % intervals beside straight."""
    rows = rows_of("splines")
    of_curve = {name: [row for row in rows if row["curve"] == name] for name in dict.fromkeys(r["curve"] for r in rows)}
    lines = []
    for name, each in of_curve.items():
        line = [name]
        for key in ("worst", "mean"):
            shares = np.array([row[key] / other[key] for row, other in zip(each, of_curve["straight"], strict=True)])
            figure = f"{np.mean([row[key] for row in each]):.3f}"
            low, high = of_few(shares)
            line.append(figure if name == "straight" else f"{figure} ({low:.2f} to {high:.2f} of straight)")
        lines.append([*line, f"{max(row['sideways'] for row in each):.2f}"])
    return table(["curve", "worst", "mean", "furthest sideways, in a step's length"], lines)
