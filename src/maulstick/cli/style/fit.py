"""``maulstick style fit``: from a hand's strokes to a style."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats, kind_of
from maulstick.strokes.ink import read_ink
from maulstick.strokes.strokes import POINTS, Strokes, path_lengths, read_strokes
from maulstick.style.cards import STYLES

if TYPE_CHECKING:
    from maulstick.style.hand import Hand
    from maulstick.style.store import Fitted

_KINDS = ("exemplar", "trajvae")
_FEW_LATENTS = 16
_FREEDOM = ("kept close to the hand's", "varied a little", "varied freely", "varied as freely as can be")


def fit(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE", help="Strokes of one hand: NAME.ink.npz or NAME.strokes.npz.")
    ],
    name: Annotated[str, typer.Option(metavar="NAME", help="What the style is to be called, as in cat.")],
    kind: Annotated[
        str,
        typer.Option(
            metavar="KIND", help="exemplar: from the strokes themselves; trajvae: the paper's network, trained on them."
        ),
    ] = "exemplar",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", metavar="", help="Replace your style of that name, if there is one.")
    ] = False,
) -> None:
    """Learn a style from the strokes of a hand; 20 of them make a good one.

    It is kept among your own styles, and maulstick plan --style NAME paints in it.
    """
    if kind not in _KINDS:
        raise InputError.of_choice("kind", kind, _KINDS)
    if len(files) != len({file.resolve() for file in files}):
        raise InputError("a file is named twice, and its strokes would count twice; name each file once")
    from maulstick.style.hand import Hand  # these load torch
    from maulstick.style.store import write_style

    STYLES.check_own_name(name, overwrite)
    started = time.monotonic()
    strokes = _read(files)
    hand = Hand.of(strokes)
    style, told = _exemplar(name, hand) if kind == "exemplar" else _trajvae(name, hand)
    path = write_style(style, ", ".join(file.name for file in files), STYLES.own())
    rows = {
        "strokes": f"{len(hand)}{_left_out(len(strokes) - len(hand))}",
        "lengths": _lengths(path_lengths(hand.paths)),
        "pressure": _recorded(hand.pressure),
        "speed": _recorded(hand.speeds),
        **told,
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


def _read(files: list[Path]) -> Strokes:
    parts = [_strokes_in(file) for file in files]
    return Strokes(
        np.concatenate([part.trajectories for part in parts]),
        np.concatenate([part.times for part in parts]),
        np.concatenate([part.poses for part in parts]),
    )


def _strokes_in(file: Path) -> Strokes:
    kind = kind_of(file)
    if kind == "ink":
        return Strokes.of(read_ink(file))
    if kind == "strokes":
        strokes = read_strokes(file)
        points = strokes.trajectories.shape[1]
        if points != POINTS:
            raise InputError.of_range(f"the number of points of a stroke in {file}", points, f"{POINTS}")
        return strokes
    raise InputError(f"{file} is neither ink nor strokes; make ink of it with maulstick record")


def _exemplar(name: str, hand: "Hand") -> tuple["Fitted", dict[str, str]]:
    from maulstick.style.exemplar import Exemplar
    from maulstick.style.store import load_hands

    style = Exemplar.fit(name, hand, load_hands())
    return style, {"new strokes": _FREEDOM[round(style.freedom * (len(_FREEDOM) - 1))]}


def _trajvae(name: str, hand: "Hand") -> tuple["Fitted", dict[str, str]]:
    from maulstick.style.train import fine_tune, pretrained
    from maulstick.style.trajvae import activity

    with Console(stderr=True).status("training the network …"):
        style = fine_tune(pretrained(), hand, seed=0, name=name)
    latents = activity(style.weights, hand.paths)
    told = f"{latents.active} active, of an effective rank of {latents.effective_rank:.1f}"
    if latents.active < _FEW_LATENTS:
        told += ": the strokes are much alike; draw more varied ones"
    return style, {"latents": told}


def _left_out(dots: int) -> str:
    return f" (and {dots} left out, shorter than 1 mm)" if dots else ""


def _lengths(lengths: "Floats") -> str:
    return f"median {1e3 * np.median(lengths):.3g} mm, {1e3 * lengths.min():.3g} to {1e3 * lengths.max():.3g} mm"


def _recorded(values: "Floats") -> str:
    known = int(np.isfinite(values[:, 0]).sum())
    return {0: "not recorded", len(values): "recorded"}.get(known, f"recorded in {known} of them")
