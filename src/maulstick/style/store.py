"""Files of styles: arrays in NAME.safetensors, and their card in NAME.json beside it. Nothing is ever unpickled."""

import hashlib
import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from maulstick.errors import InputError, OutputError
from maulstick.storage.arrays import Floats
from maulstick.storage.files import atomic_write, read_whole
from maulstick.storage.records import write_record
from maulstick.storage.text import made_printable
from maulstick.strokes.strokes import POINTS, path_lengths
from maulstick.style.cards import (
    BUILT_IN,
    LARGEST,
    STYLES,
    ExemplarSettings,
    StyleCard,
    TrajVAESettings,
    read_card,
)
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import LONGEST, Hand
from maulstick.style.pooled import PooledHands
from maulstick.style.pressure import KNOTS
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.trajvae import TrajVAE

_HAND = {"paths": (POINTS, 2), "pressure": (KNOTS,), "speeds": (POINTS,)}  # shapes per stroke
_HANDS = {"covariance": (GIST + 1, GIST + 1), "residual": (RESIDUAL,)}  # shapes
_SHORTEST = 1e-4  # metres: a file with a shorter stroke, or one of over `LONGEST`, is damaged

Arrays = dict[str, NDArray[np.generic]]
"""Arrays of a file by their names."""

Fitted = Exemplar | TrajVAE
"""Styles that are learned from a hand."""


def write_style(style: Fitted, source: str, folder: Path, overwrite: bool = True) -> Path:
    """Write a style into a folder, which is made where missing, and return the path of its JSON.

    source: what the style was learned from, for people.  overwrite: replace a style of that name, whose title and
    earlier names stay.  Raises OutputError where there is one that is not to be replaced, or writing fails, and
    InputError where another process goes on writing into the folder. A JSON is never left beside arrays that do not
    belong to it.
    """
    name = STYLES.check_name(style.name)
    arrays = {field: getattr(style.hand, field).astype(np.float32) for field in _HAND}
    if style.hand.poses is not None:
        arrays["poses"] = style.hand.poses.astype(np.float32)
    if isinstance(style, Exemplar):
        settings: ExemplarSettings | TrajVAESettings = ExemplarSettings(freedom=style.freedom)
        arrays |= {field: getattr(style.hands, field) for field in _HANDS}
    else:
        settings = TrajVAESettings()
        arrays |= style.arrays()
    content = save(arrays)
    digest = hashlib.sha256(content).hexdigest()
    card = StyleCard(
        name=name, source=made_printable(source), strokes=len(style.hand), settings=settings, sha256=digest
    )
    path = folder / f"{name}.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with STYLES.writing_into(folder), TemporaryDirectory(dir=folder, prefix=".maulstick-") as staging:
            if not overwrite:  # asked while nobody else writes, or two that learn one name would both keep it
                STYLES.check_unused(name, folder)
            _replace(path, card, content, Path(staging))
    except OutputError:
        raise
    except OSError as error:
        raise OutputError(f"cannot write into the folder of styles {folder}: {error.strerror}") from error
    return path


def _replace(path: Path, card: StyleCard, content: bytes, staging: Path) -> None:
    with suppress(InputError):  # there is none, or it is broken
        replaced = read_card(path)
        former = tuple(each for each in replaced.names if each != card.name) or None
        card = card.model_copy(update={"title": replaced.title, "formerly": former})
    new = staging / path.name
    try:
        atomic_write(new.with_suffix(".safetensors"), content)
        write_record(card, new)
    except OutputError as error:
        raise error.replaced(str(staging), str(path.parent)) from error
    path.unlink(missing_ok=True)
    new.with_suffix(".safetensors").replace(path.with_suffix(".safetensors"))
    new.replace(path)


def read_style(path: Path) -> Fitted:
    """Return the style whose JSON is at `path`. Raises InputError where it or the arrays beside it cannot be used."""
    card = read_card(path)
    beside = path.with_suffix(".safetensors")
    if not os.path.lexists(beside):
        raise InputError(f"{path} has no {beside.name} beside it; copy both")
    content = read_whole(beside, "style", LARGEST)
    if hashlib.sha256(content).hexdigest() != card.sha256:
        raise InputError(f"{beside} does not belong to {path}, or it is damaged; copy both files again")
    try:
        arrays = _arrays(content)
        hand = _hand(arrays, card.strokes)
        if isinstance(card.settings, ExemplarSettings):
            return Exemplar(card.name, hand, _hands(arrays), card.settings.freedom)
        return TrajVAE.from_arrays(card.name, hand, arrays)
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{beside} does not hold a style: {made_printable(str(error))}") from error


def write_hands(hands: PooledHands, folder: Path) -> Path:
    """Write the statistics of many hands into a folder, for `load_hands`, and return the path of the file."""
    atomic_write(folder / "hands.safetensors", save({field: getattr(hands, field) for field in _HANDS}))
    return folder / "hands.safetensors"


def load_hands() -> PooledHands:
    """Return the statistics of many hands that come with Maulstick."""
    return _hands(_arrays(read_whole(BUILT_IN / "hands.safetensors", "style", LARGEST)))


def _arrays(content: bytes) -> Arrays:
    try:
        return dict(load(content))
    except SafetensorError as error:
        raise ValueError(error) from error


def _array(arrays: Arrays, name: str, shape: tuple[int, ...]) -> Floats:
    array = arrays[name]
    if array.shape != shape or array.dtype.kind != "f":
        raise ValueError(f"{name} is {array.dtype} of shape {array.shape}; it must be floating point of shape {shape}")
    return array.astype(np.float64)


def _hand(arrays: Arrays, strokes: int) -> Hand:
    hand = Hand(*(_array(arrays, name, (strokes, *shape)) for name, shape in _HAND.items()))
    if "poses" in arrays:
        hand = replace(hand, poses=_array(arrays, "poses", (strokes, 3)))
    lengths = path_lengths(hand.paths)
    if not ((lengths >= _SHORTEST) & (lengths <= LONGEST)).all() or hand.paths[:, 0].any():
        raise ValueError("a stroke of it is no standardised path of 0.1 mm to 100 m")
    if hand.poses is not None and not (np.abs(hand.poses) <= LONGEST).all():
        raise ValueError("a stroke of it lies nowhere")
    for name, values, most in (("pressure", hand.pressure, 1.0), ("speeds", hand.speeds, np.inf)):
        known = np.isfinite(values).all(axis=1)
        if not (known | np.isnan(values).all(axis=1)).all() or (values < 0).any() or (values > most).any():
            raise ValueError(f"its {name} are impossible, or known along a part of a stroke only")
    return hand


def _hands(arrays: Arrays) -> PooledHands:
    hands = PooledHands(*(_array(arrays, name, shape) for name, shape in _HANDS.items()))
    if not (np.isfinite(hands.residual).all() and (hands.residual > 0).all()):
        raise ValueError("residual must be finite and above 0")
    covariance = hands.covariance
    if not np.isfinite(covariance).all() or not np.allclose(covariance, covariance.T):
        raise ValueError("covariance must be finite and symmetric")
    if np.linalg.eigvalsh(covariance)[0] <= 0:
        raise ValueError("covariance must be positive definite")
    return hands
