"""``maulstick style show``: draws a picture of a style, or a map of several."""

from pathlib import Path
from typing import Annotated

import typer

from maulstick.cli.show import check_picture
from maulstick.errors import InputError
from maulstick.storage.files import atomic_write


def show(
    names: Annotated[
        list[str], typer.Argument(metavar="NAME", help="Name of a style, or its JSON file; with --map, up to six.")
    ],
    on_map: Annotated[
        bool,
        typer.Option("--map", metavar="", help="Draw a map of the latent space, with each stroke at its place."),
    ] = False,
    px: Annotated[int, typer.Option(metavar="N", help="Height of the picture in pixels.")] = 1024,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", show_default="NAME.png or NAME-map.png here", help="The PNG file to write."),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace an earlier picture.")] = False,
) -> None:
    """Draw strokes that a style was learned from beside strokes that it draws itself.

    Example: maulstick style show loops hatching --map --out styles.png
    """
    if len(names) > 1 and not on_map:
        raise InputError(f"a sheet shows one style, and {len(names)} are named; name one, or add --map")
    called = "-".join(Path(name).stem for name in names)
    path = out or Path(f"{called}-map.png" if on_map else f"{called}.png")
    check_picture(path, px, overwrite)
    from maulstick.cli.style.reading import read_fitted  # these load torch
    from maulstick.plots.latent_map import latent_map
    from maulstick.plots.style import style_plot

    styles = read_fitted(names)
    if on_map:
        picture = latent_map(styles, called if len(styles) == 1 else f"{len(styles)} styles", px)
    else:
        picture = style_plot(styles[0], called, px)
    atomic_write(path, picture)
    print(path, flush=True)
