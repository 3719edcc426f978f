"""Tables of models of strokes, from rows that were kept."""

from kept import rows_of, table


def stroke_models_table() -> str:
    """Errors out of distribution, as executed and registered."""
    ratios = [row for row in rows_of("stroke_models") if row["name"] == "extended_over_seven"]
    lines = []
    for dataset in dict.fromkeys(row["dataset"] for row in ratios):
        line = [dataset]
        for metric in ("l1_out_of_distribution", "l1_out_of_distribution_registered"):
            (row,) = (row for row in ratios if (row["dataset"], row["metric"]) == (dataset, metric))
            low, high = row["interval"]
            line += [f"{row['seven']:.4f}", f"{row['extended']:.4f}", f"{row['ratio']:.3f} ({low:.3f} to {high:.3f})"]
        lines.append(line)
    head = ["", "seven, as executed", "extended", "ratio", "seven, registered", "extended", "ratio"]
    return table(head, lines)
