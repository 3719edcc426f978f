"""Tables of what the planner's parts bring, faces and relocations; and of other ways beside it."""

import numpy as np
from kept import Row, rows_of, table, with_range


def faces_table() -> str:
    """What it changes that faces count more: over seeds, and the gain in pairs of a seed."""
    rows = rows_of("faces")
    keys = {"psnr": 2, "ssim": 3, "face_psnr": 2}
    lines = []
    for image in dict.fromkeys(row["image"] for row in rows):
        for faces in (1.0, 0.0):
            of = [row for row in rows if (row["image"], row.get("faces")) == (image, faces)]
            figures = [with_range([row[key] for row in of], digits) for key, digits in keys.items()]
            lines.append([image, f"{faces:g}", *figures])
        gains = next(row["gain"] for row in rows if row["image"] == image and "gain" in row)
        line = [image, "gain"]
        for key, digits in keys.items():
            mean, low, high = (gains[key][each] for each in ("mean", "low", "high"))
            line.append(f"{mean:+.{digits}f} ({low:+.{digits}f} to {high:+.{digits}f})")
        lines.append(line)
    return table(["photograph", "`faces`", "PSNR", "SSIM", "PSNR of the face"], lines)


def removal_table() -> str:
    """How well the costs of removing strokes are estimated: seed by seed, and all."""
    lines = []
    for row in rows_of("removal"):
        low, high = row["quartiles"]
        line = [f"{row['seed']}" if "seed" in row else "all", f"{row['calls']}", f"{row['strokes']:,}"]
        line += [f"{row['median_error']:.0%} ({low:.0%} to {high:.0%})", f"{row['rank_correlation']:.2f}"]
        lines.append([*line, f"{row['moved_right']:.0%}"])
    head = ["seed", "estimates", "strokes", "error, median (quartiles)", "rank correlation", "moved rightly"]
    return table(head, lines)


def horse_table() -> str:
    """Strokes that stray onto bare paper."""
    rows = [row for row in rows_of("horse") if "seed" in row]
    names = {"plan": "tones", "likeness": "with likeness", "paper": "published"}
    lines = []
    for name, title in names.items():
        of = [row for row in rows if row["name"] == name]
        counts = [with_range([row[key] for row in of], 0) for key in ("strokes", "stray")]
        decibels = [f"{with_range([row[key] for row in of], 1)} dB" for key in ("psnr", "psnr_planned")]
        lines.append([title, *counts, *decibels])
    return table(["", "strokes", "of them stray", "PSNR", "on the planner's pixels"], lines)


def frida_table() -> str:
    """FRIDA's way, its curves planned by ours, and hands: over seeds, or the least and the most of all plans."""
    rows = rows_of("frida")
    plans = [row for row in rows if "image" in row]
    images = list(dict.fromkeys(row["image"] for row in plans))
    lines = []
    for way in dict.fromkeys(row["name"] for row in plans):
        of = [row for row in plans if row["name"] == way]
        line = [way]
        for image in images:
            each = [row for row in of if row["image"] == image]
            psnr = [row["psnr"] for row in each]
            mean = f"{psnr[0]:.1f}" if len(psnr) == 1 else with_range(psnr, 1)
            line.append(f"{mean} dB, {np.mean([row['ssim'] for row in each]):.2f}")
        line.append(_from_to([row["paint_changes"] for row in of], 0))
        line.append(f"{_from_to([row['metres'] for row in of], 0)} m")
        lines.append([*line, *(_to_hands(of, way, key, digits) for key, digits in (("energy", 2), ("told_apart", 2)))])
    (hand,) = (row for row in rows if row["name"] == "hand")
    halves = [", ".join(f"{hand[key][name]:.2f}" for name in hand[key]) for key in ("energy", "told_apart")]
    lines.append([f"two halves of {' and '.join(hand['energy'])}", *[""] * len(images), "", "", *halves])
    head = ["", *images, "paint changes", "drawn", "energy distance to its hand, or to either", "told apart"]
    return table(head, lines)


def _to_hands(rows: list[Row], way: str, key: str, digits: int) -> str:
    """The least and the most, to the hand that was planned with, or to any."""
    hands = rows[0][key]
    return _from_to([row[key][hand] for row in rows for hand in ([way] if way in hands else hands)], digits)


def _from_to(values: list[float], digits: int) -> str:
    least, most = (f"{value:.{digits}f}" for value in (min(values), max(values)))
    return least if least == most else f"{least} to {most}"


def few_calls_table() -> str:
    """How little is left of a network's loss after so many calls of it."""
    rows, lines = rows_of("few_calls"), []
    for title, prefix in {"plain": "plain_", "warm": "warm_", "few calls": ""}.items():
        calls, seconds, losses = ([row[prefix + key] for row in rows] for key in ("calls", "seconds", "loss"))
        found = with_range(losses, 3) if len(losses) > 1 else f"{losses[0]:.3f}"
        lines.append([title, f"{np.mean(calls):,.0f}", found, f"{np.mean(seconds):.0f}"])
    return table(["", "calls", "loss", "seconds of the processor"], lines)
