"""Tables of how like a hand its style draws, from rows that were kept."""

import numpy as np
from kept import Row, rows_of, table, with_interval, with_range


def kinds_table() -> str:
    """Shares of strokes awry, with intervals over sessions and seeds."""
    titles = {"worst_kind": "worst kind", "seven_curls": "seven curls"}
    models = ("by people", "exemplar", "trajvae")
    rows = {(row["name"], row["kind"], row["session"], row["model"]): row for row in rows_of("kinds")}
    lines = []
    for name, kind in dict.fromkeys((name, kind) for name, kind, *_ in rows):
        sessions = {at[2] for at in rows if at[:2] == (name, kind)} - {"all"}
        line = [titles[name], f"{len(sessions)} {'Wacom' if kind == 'wacom' else kind}"]
        for model in models:
            row = rows.get((name, kind, "all", model))
            line.append("" if row is None else with_interval(row["awry"], row["interval"]))
        lines.append(line)
    return table(["", "hands", *models], sorted(lines, key=lambda line: line[0] != "worst kind"))


def recognition_table() -> str:
    """Whom sheets are taken for rightly; then who is taken for whom."""
    titles = {"human": "human, held out", "exemplar": "exemplar, samples", "trajvae": "trajvae, samples"}
    found = {(row["model"], row["session"]): row for row in rows_of("recognition")}
    sessions = [session for model, session in found if model == "human" and session != "all"]
    lines = []
    for model, title in titles.items():
        every = found[model, "all"]
        own = [f"{found[model, session]['accuracy']:.2f}" for session in sessions]
        lines.append([title, with_interval(every["accuracy"], every["interval"]), *own])
    text = table(["sheets", "all", *sessions], lines)
    for model in ("human", "exemplar"):
        named = [[session, *(f"{share:.2f}" for share in found[model, session]["named"])] for session in sessions]
        text += (
            f"\n{titles[model][0].upper()}{titles[model][1:]}: whose they are (rows), and whom they are taken for:\n\n"
        )
        text += table(["", *sessions], named)
    return text


def plans_table() -> str:
    """Whose strokes those of plans are taken for, and what it costs to hold them to their hand."""
    titles = {"1.0": "held to its hand, as usual", "inf": "not held"}
    lines = [
        [
            titles[row["max_mean_cost"]],
            with_interval(row["accuracy"], row["accuracy_interval"]),
            f"{with_interval(row['psnr'], row['psnr_interval'], 1)} dB",
            f"{with_interval(row['less'], row['less_interval'])} dB" if any(row["less_interval"]) else "",
        ]
        for row in rows_of("plans")
        if row["name"] == "price"
    ]
    return table(["plans", "sheets named rightly", "PSNR", "more than when not held"], lines)


def reconstruction_table() -> str:
    """Errors of codes, medians and 95 % quantiles, mm."""
    rows = rows_of("reconstruction")
    models = list(dict.fromkeys(row["model"] for row in rows))
    mocap = list(dict.fromkeys(row["session"] for row in rows if row["model"] == "trajvae"))
    gist = {row["session"]: row for row in rows if row["model"] == "gist"}
    lines = []
    for session in mocap:
        each = [[row for row in rows if (row["model"], row["session"]) == (model, session)] for model in models]
        lines.append([session, *map(_errors, each)])
    mouse = [row for session, row in gist.items() if session.startswith("mouse")]
    wacom = [row for session, row in gist.items() if session not in mocap and row not in mouse]
    for kind, found in (("Wacom", wacom), ("mouse", mouse)):
        middle = [f"{np.median([row[key] for row in found]):.2f}" for key in ("median_mm", "p95_mm")]
        lines.append([f"{len(found)} {kind} drawings, the median one", " / ".join(middle), *[""] * (len(models) - 1)])
    numbers = {row["model"]: row["numbers"] for row in rows}
    return table(["session", *(f"{model}, {numbers[model]} numbers" for model in models)], lines)


def _errors(rows: list[Row]) -> str:
    """Of one session's seeds the mean, the least and the most, of both quantiles."""
    both = [[row[key] for row in rows] for key in ("median_mm", "p95_mm")]
    return " / ".join(with_range(each, 2) if len(each) > 1 else f"{each[0]:.2f}" for each in both)
