"""Tables of how like a hand its style draws, from rows that were kept."""

from kept import rows_of, table


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


def with_interval(value: float, ends: list[float], digits: int = 2) -> str:
    """A figure and the ends of its interval."""
    return f"{value:.{digits}f} ({ends[0]:.{digits}f} to {ends[1]:.{digits}f})"


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
