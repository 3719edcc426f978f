"""``maulstick style compare``: measures how alike the strokes of two hands are."""

from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text


def compare(
    a: Annotated[str, typer.Argument(metavar="A", help="Name of a style, or its JSON file.")],
    b: Annotated[str, typer.Argument(metavar="B", help="Name of the other style, or its JSON file.")],
) -> None:
    """Compare the strokes that two styles were learned from.

    Example: maulstick style compare loops hatching
    """
    from maulstick.cli.style.reading import read_fitted  # these load torch
    from maulstick.style.compare import Comparison

    first, second = read_fitted((a, b))
    found = Comparison.of(first.hand.paths, second.hand.paths, np.random.default_rng(0))
    if found.shared:
        part = "" if found.shared == 1 else "in part "
        print(f"{a} and {b} were learned {part}from the same strokes", flush=True)
        return
    rows = [
        ("energy distance", found.distance, "0 where they are the same"),
        (f"of halves of {first.name}", found.of_halves, "as near as two parts of one hand are"),
        ("1-NN accuracy", found.accuracy, "0.5 where they are the same, 1 at most"),
    ]
    table = Table(title=Text(f"{first.name} and {second.name}"), show_header=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_column()
    for name, value, meaning in rows:
        table.add_row(name, f"{value:.2f}", meaning)
    Console().print(table)
    print(f"compared with the strokes of {first.name}, those of {second.name} {found.told}", flush=True)
