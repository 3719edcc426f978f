"""``maulstick style compare``: how alike the strokes of two hands are."""

from typing import Annotated

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from rich.text import Text

Floats = NDArray[np.float64]

_HALVINGS = 20
_LEAST_APART = 0.4  # of a standard deviation: what is less is not worth saying
_MOST_SAID = 3
_LENGTH = 0
_MORE_AND_LESS = {  # of a description (maulstick.style.compare) that is larger, and smaller
    1: ("end farther from where they begin", "end nearer to where they begin"),
    2: ("bend more", "bend less"),
    3: ("turn more to the right", "turn more to the left"),
    12: ("are rougher", "are smoother"),
    13: ("change the side that they bend to more often", "change the side that they bend to less often"),
}


def compare(
    a: Annotated[str, typer.Argument(metavar="A", help="Name of a style, or its JSON.")],
    b: Annotated[str, typer.Argument(metavar="B", help="Name of the other.")],
) -> None:
    """Compare the strokes of the hands that two styles were learned from."""
    from maulstick.cli.style.reading import read_fitted  # these load torch
    from maulstick.style.compare import describe, energy_distance, nearest_neighbour_accuracy

    styles = read_fitted((a, b))
    first_strokes, second_strokes = ({path.tobytes() for path in style.hand.paths} for style in styles)
    if first_strokes & second_strokes:
        part = "" if first_strokes == second_strokes else "in part "
        print(f"{a} and {b} were learned {part}from the same strokes", flush=True)
        return
    described = [describe(style.hand.paths) for style in styles]
    together = np.concatenate(described)
    spread = together.std(axis=0)
    first, second = ((each - together.mean(axis=0)) / np.where(spread > 0, spread, 1) for each in described)
    chance = np.random.default_rng(0)
    accuracy = nearest_neighbour_accuracy(first, second, chance)
    rows = [
        ("energy distance", energy_distance(first, second), "0 where they are the same"),
        (f"of halves of {styles[0].name}", _of_halves(first, chance), "as near as two parts of one hand are"),
        ("1-NN accuracy", accuracy, "0.5 where they are the same, 1 at most"),
    ]
    table = Table(title=Text(f"{styles[0].name} and {styles[1].name}"), show_header=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_column()
    for name, value, meaning in rows:
        table.add_row(name, f"{value:.2f}", meaning)
    Console().print(table)
    ratio = float(np.exp(described[1][:, _LENGTH].mean() - described[0][:, _LENGTH].mean()))
    told = in_words(first, second, ratio)
    print(f"compared with the strokes of {styles[0].name}, those of {styles[1].name} {told}", flush=True)


def _of_halves(described: Floats, chance: np.random.Generator) -> float:
    """Energy distance of one half of the strokes to the other, on average over several ways to halve them."""
    from maulstick.style.compare import energy_distance

    halves = [np.array_split(described[chance.permutation(len(described))], 2) for _ in range(_HALVINGS)]
    return float(np.mean([energy_distance(*pair) for pair in halves]))


def in_words(first: Floats, second: Floats, ratio: float) -> str:
    """What differs most from the first standardised descriptions to the second, whose strokes are `ratio` as long."""
    apart = second.mean(axis=0) - first.mean(axis=0)
    columns = sorted((_LENGTH, *_MORE_AND_LESS), key=lambda column: -abs(apart[column]))
    said = [
        f"are {ratio:.2g} times as long" if column == _LENGTH else _MORE_AND_LESS[column][int(apart[column] < 0)]
        for column in columns[:_MOST_SAID]
        if abs(apart[column]) >= _LEAST_APART
    ]
    if not said:
        return "are as long, as bent and as rough"
    return " and ".join([", ".join(said[:-1]), said[-1]] if len(said) > 1 else said)
