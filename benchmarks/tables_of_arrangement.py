"""Tables of arrangement, from rows that were kept."""

import numpy as np
from drawings import HANDS, TUNE_NOTHING
from intervals import Floats, interval, mean
from kept import Row, rows_of, table, with_range

_KEYS = ("energy", "energy_judging")


def arrangement_table() -> str:
    """Each way to plan, and the controls; then hand by hand."""
    rows = rows_of("arrangement")
    people = {(row["hand"], row["split"]): row for row in rows if row["row"] == "people"}
    lines, of_hands = [], {}
    for name in dict.fromkeys(row["row"] for row in rows):
        every = [row for row in rows if row["row"] == name]
        hands = {hand: [row for row in every if row["hand"] == hand] for hand in HANDS}
        hands = {hand: each for hand, each in hands.items() if each}
        line = [name.replace("_", " "), str(sum(map(len, hands.values())))]
        for key in _KEYS:
            groups = [above_floor(each, people, key) for each in hands.values()]
            low, high = interval(groups, normalised)
            line.append(f"{normalised(np.concatenate(groups)):.2f} ({low:.2f} to {high:.2f})")
        of_hands[line[0]] = {hand: normalised(above_floor(each, people, _KEYS[0])) for hand, each in hands.items()}
        line.append(f"{np.mean([row['taken_for'] == row['hand'] for row in every]):.2f}")
        counted = [row for each in hands.values() for row in each]
        of_last_seed = [row for row in counted if row["seed"] == counted[-1]["seed"]]
        for key, written in _MEANS.items():
            of = of_last_seed if key == "seconds" else counted  # the first seed was planned at other speeds
            line.append(written.format(np.mean([row[key] for row in of])) if key in of[0] else "")
        lines.append(line)
    titles = [f"{hand} (tunes nothing)" if hand in TUNE_NOTHING else hand for hand in HANDS]
    each = [
        [name, *(f"{of[hand]:.2f}" if hand in of else "" for hand in HANDS)]
        for name, of in of_hands.items()
        if name != "people"
    ]
    head = ["row", "drawings", "normalised", "by the numbers for judging only", "named", "copied groups", "order"]
    head += ["travel", "blurred", "seconds"]
    return table(head, lines) + "\nHand by hand, normalised:\n\n" + table(["", *titles], each)


def order_table() -> str:
    """In which order strokes are drawn: of people's drawings, and of plans."""
    rows = rows_of("order")
    own = {(row["hand"], row["split"]): row["order_nats"] for row in rows if row["strokes"] == "people"}
    lines = []
    for strokes, order in dict.fromkeys((row["strokes"], row["order"]) for row in rows):
        every = [row for row in rows if (row["strokes"], row["order"]) == (strokes, order)]
        hands = {row["hand"]: [each for each in every if each["hand"] == row["hand"]] for row in every}
        off = [
            np.array([abs(row["order_nats"] - own[row["hand"], row["split"]]) for row in of]) for of in hands.values()
        ]
        low, high = interval(off, mean)
        followed = [row["followed"] for row in every if row.get("followed") is not None]
        line = [
            strokes.replace("_", " "),
            order,
            str(len(every)),
            f"{np.mean([row['order_nats'] for row in every]):.2f}",
        ]
        line.append("" if order == "own" else f"{np.concatenate(off).mean():.2f} ({low:.2f} to {high:.2f})")
        line.append(f"{np.mean([row['energy'] for row in every]):.2f}")
        line.append(f"{np.mean(followed):.2f}" if followed else "")
        line.append(with_range([row["metres"] / row["tour_metres"] for row in every], 2))
        lines.append(line)
    head = ["strokes", "order", "drawings", "nats", "nats from the hand's own", "energy", "followed", "travel"]
    return table(head, lines)


_MEANS = {
    "copied_groups": "{:.2f}",
    "order_nats": "{:.2f} nats",
    "travel": "{:.2f}",
    "psnr_blurred": "{:.1f} dB",
    "seconds": "{:.0f} s",
}


def normalised(rows: Floats) -> float:
    """0 as near as the hand's own other half, 1 as far as other people; rows (n, 2) of `above_floor`."""
    above, others = rows.sum(axis=0)
    return float(above / others)


def above_floor(rows: list[Row], people: dict[tuple[str, int], Row], key: str) -> Floats:
    """How much farther than people each row is, and all others are, (n, 2)."""
    of = [people[row["hand"], row["split"]] for row in rows]
    pairs = [(row[key] - own[key], own[f"others_{key}"] - own[key]) for row, own in zip(rows, of, strict=True)]
    return np.array(pairs)


def inks_table() -> str:
    """Pens as inks and as paints, photograph by photograph."""
    rows, lines = rows_of("inks"), []
    for picture in [*dict.fromkeys(row["picture"] for row in rows), "all"]:
        for way in dict.fromkeys(row["way"] for row in rows):
            own = [row for row in rows if row["way"] == way and picture in (row["picture"], "all")]
            written = {"psnr_blurred": 1, "ssim": 2, "energy": 2, "strokes": 0}
            figures = [with_range([row[key] for row in own], digits) for key, digits in written.items()]
            lines.append([picture, way, str(len(own)), *figures])
    others = np.mean([row["others"] for row in rows])
    head = ["photograph", "pens as", "plans", "PSNR, blurred (dB)", "SSIM"]
    return table([*head, f"arrangement (others: {others:.2f})", "strokes"], lines)
