"""``maulstick style fit``: learns a style from strokes of one hand."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.errors import InputError
from maulstick.jobs.learn import KINDS, learn_style, strokes_of
from maulstick.storage.arrays import Floats
from maulstick.storage.folders import MAKE_ROOM, made_folder
from maulstick.strokes.strokes import path_lengths
from maulstick.style.cards import STYLES

if TYPE_CHECKING:
    from maulstick.style.hand import Hand
    from maulstick.style.store import Fitted

_FEW_LATENTS = 16  # fewer active ones than this draw strokes that are much alike
_FREEDOM = ("kept close to the hand's", "varied a little", "varied freely", "varied as freely as can be")


def fit(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="Files with strokes of one hand: NAME.ink.npz or NAME.strokes.npz."),
    ],
    name: Annotated[str, typer.Option(metavar="NAME", help="Name of the new style.")],
    kind: Annotated[
        str,
        typer.Option(
            metavar="KIND",
            help="Kind of style: exemplar keeps the strokes themselves, trajvae trains the paper's network on them.",
        ),
    ] = "exemplar",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace your earlier style of that name.")
    ] = False,
) -> None:
    """Learn a style from the strokes of one hand; 20 strokes make a good one.

    It is kept among your own styles, and maulstick plan --style NAME plans with it.

    Example: maulstick style fit me.ink.npz --name me
    """
    if kind not in KINDS:
        raise InputError.of_choice("kind", kind, KINDS)
    STYLES.check_own_name(name, overwrite)
    from maulstick.style.store import write_style  # loads torch

    started = time.monotonic()
    strokes = strokes_of(files)
    with made_folder(STYLES.own(), MAKE_ROOM):
        with Console(stderr=True).status("learning …"):
            style = learn_style(name, strokes, kind)
        path = write_style(style, ", ".join(file.name for file in files), STYLES.own(), overwrite)
    hand = style.hand
    rows = {
        "strokes": f"{len(hand)}{_left_out(len(strokes) - len(hand))}",
        "lengths": _lengths(path_lengths(hand.paths)),
        "pressure": _recorded(hand.pressure),
        "speed": _recorded(hand.speeds),
        "arranged": _arranged(hand, len(files)),
        **_told(style),
        "learned in": f"{time.monotonic() - started:.2g} s",
        "kept as": f"{path}",
    }
    table = Table(title=Text(f"the style {name}"), show_header=False)
    table.add_column()
    table.add_column(overflow="fold")
    for row, value in rows.items():
        table.add_row(row, Text(value))
    Console().print(table)
    print(f"maulstick plan photo.jpg --style {name}", flush=True)


def _told(style: "Fitted") -> dict[str, str]:
    from maulstick.style.exemplar import Exemplar
    from maulstick.style.trajvae import activity

    if isinstance(style, Exemplar):
        return {"new strokes": _FREEDOM[round(style.freedom * (len(_FREEDOM) - 1))]}
    latents = activity(style.weights, style.hand.paths)
    told = f"{latents.active} active, of an effective rank of {latents.effective_rank:.1f}"
    if latents.active < _FEW_LATENTS:
        told += ": the strokes are much alike; draw more varied ones"
    return {"latents": told}


def _arranged(hand: "Hand", recordings: int) -> str:
    from maulstick.style.arrangement.arrangement import FEWEST
    from maulstick.style.arrangement.words import told

    if hand.arrangement is not None:
        return told(hand.arrangement, recordings)
    return "too scattered to be learned" if len(hand) >= FEWEST else f"not learned: {FEWEST} strokes tell it"


def _left_out(dots: int) -> str:
    return f" (and {dots} left out, shorter than 1 mm)" if dots else ""


def _lengths(lengths: "Floats") -> str:
    # With .3g alone a metre and more would be told as 1e+03 mm.
    middle, least, most = (float(f"{1e3 * f(lengths):.3g}") for f in (np.median, np.min, np.max))
    return f"median {middle:g} mm, {least:g} to {most:g} mm"


def _recorded(values: "Floats") -> str:
    known = int(np.isfinite(values[:, 0]).sum())
    return {0: "not recorded", len(values): "recorded"}.get(known, f"recorded in {known} of them")
