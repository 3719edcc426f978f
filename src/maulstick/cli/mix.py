"""``maulstick mix``: recipes to mix the paints of a painting from tubes."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.painting.painting import Paint, hex_colour
from maulstick.painting.painting_file import read_painting

if TYPE_CHECKING:
    from maulstick.colour.mixing import Recipe


def mix(
    painting: Annotated[Path, typer.Argument(metavar="PAINTING", help="The painting.json whose paints to mix.")],
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            show_default="a dozen usual acrylics",
            help="Paints at hand: a CSV file with lines name,#rrggbb.",
        ),
    ] = None,
) -> None:
    """Print recipes to mix the paints of a painting from tubes.

    A recipe comes from a model of paint and is a start: mix, compare, correct. A paint with a name is used as it comes
    from its tube, unless `--from` names other paints. With an error of 5 (CIEDE2000) or more, these paints cannot reach
    the colour.

    Example: maulstick mix cat/painting.json --from tubes.csv
    """
    plan = read_painting(painting)
    from maulstick.colour.mixing import mixing_advice  # these take a moment
    from maulstick.colour.tubes import USUAL_PAINTS, read_paints

    base = USUAL_PAINTS if source is None else read_paints(source)
    colours = plan.colours()
    recipes = mixing_advice(np.array([paint.colour for paint, _ in colours]).reshape(-1, 3), base)
    table = Table(title=Text(f"{painting}, from {'usual acrylics' if source is None else source}"))
    for column in ("paint", "metres", "recipe", "gives"):
        table.add_column(column, justify="right" if column == "metres" else "left", overflow="fold")
    for number, (paint, metres) in enumerate(colours, start=1):
        in_its_tube = source is None and paint.name is not None
        advice = None if in_its_tube else recipes[number - 1]
        table.add_row(_wanted(number, paint), f"{metres:.2f}", _recipe(advice), _given(advice))
    Console().print(table)


def _wanted(number: int, paint: Paint) -> Text:
    return Text.assemble(f"{number} ", ("   ", f"on {paint.hex}"), f" {paint.label}")


def _recipe(advice: "Recipe | None") -> Text:
    return Text("as it is in its tube" if advice is None else str(advice))


def _given(advice: "Recipe | None") -> Text:
    """Return the colour that a recipe gives, and its error; nothing for a paint from its tube."""
    if advice is None:
        return Text("")
    colour = hex_colour(advice.colour)
    return Text.assemble(("   ", f"on {colour}"), f" {colour}, {advice.verdict} ({advice.error:.1f})")
