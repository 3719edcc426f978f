"""Tables of models of strokes and of fits, from rows that were kept."""

from itertools import product

from kept import Row, rows_of, table

KINDS_OF_TEST = {"l1_out_of_distribution": "unlike those learned from", "l1": "alike"}


def datasets_of(rows: list[Row]) -> list[str]:
    """Their datasets, in order."""
    return list(dict.fromkeys(row["dataset"] for row in rows))


def stroke_models_table() -> str:
    """The extended model over the paper's seven numbers, as executed and registered."""
    ratios = [row for row in rows_of("stroke_models") if row["name"] == "extended_over_seven"]
    found = {(row["dataset"], row["metric"]): row for row in ratios}
    lines = []
    for dataset, (metric, strokes) in product(datasets_of(ratios), KINDS_OF_TEST.items()):
        line = [dataset, strokes]
        for row in (found[dataset, metric], found[dataset, f"{metric}_registered"]):
            (low, high), (least, most) = row["interval"], row["splits"]
            line += [f"{row['seven']:.5f}", f"{row['extended']:.5f}", f"{row['ratio']:.3f} ({low:.3f} to {high:.3f})"]
            line += [f"{least:.3f} to {most:.3f}"]
        lines.append(line)
    protocols = [[f"seven, {protocol}", "extended", "ratio", "in splits"] for protocol in ("as executed", "registered")]
    return table(["medium", "strokes", *protocols[0], *protocols[1]], lines)


def stroke_networks_table() -> str:
    """Errors of networks beside those of the paper's seven numbers and of the extended model, one split."""
    networks = rows_of("stroke_networks")
    rows = [*networks, *(row for row in rows_of("stroke_models") if row["name"] == "stroke_models")]
    found = {(row["dataset"], row["model"]): row for row in rows}
    names = {"cnn": "CNN", "coordconv": "CoordConv", "traj2stroke": "seven", "traj2stroke_unet": "with U-Net"}
    names["extended"] = "extended"
    protocols = {"": "as executed", "_registered": "registered"}
    lines = [
        [dataset, strokes, protocol, *(f"{found[dataset, model][metric + suffix]:.5f}" for model in names)]
        for dataset, (metric, strokes), (suffix, protocol) in product(
            datasets_of(networks), KINDS_OF_TEST.items(), protocols.items()
        )
    ]
    return table(["medium", "strokes", "", *names.values()], lines)


def brush_table() -> str:
    """How long a fit takes, and what it finds."""
    lines = [
        [
            row["dataset"],
            f"{row['strokes']}",
            f"{row['seconds']:.0f}",
            ", ".join(row["kept"]) or "nothing",
            f"{row['l1']:.4f}",
            f"{row['l1_paper']:.4f}",
        ]
        for row in rows_of("brush")
        if row["name"] == "fit"
    ]
    head = ["strokes of", "used", "seconds", "kept", "L1 around an opened stroke, as executed"]
    return table([*head, "with the paper's seven"], lines)
