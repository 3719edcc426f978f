"""A plan in the making as arrays, so that planning can go on from a file as if it had not stopped."""

import json
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import JsonValue
from torch import Generator

from maulstick.errors import InputError
from maulstick.storage.arrays import read_arrays, write_arrays

KIND = "plan in the making"
"""Kind of the file, as `read_arrays` checks it."""

State = dict[str, NDArray[np.generic]]
"""Arrays by name: everything that the next step depends on."""

_LARGEST = 2**35  # bytes, unpacked: 32 windows of a mural in work, each of 6,144 pixels per side, as networks saw them
_SET_BACK = 0.6  # share of the plan that counts as over at most where weights change: rates are a third of the largest
_SOONER = 1.5  # times as fast as usual it goes on from there, so that somebody who waits sees where it leads


def write_state(path: str | Path, state: State, request: dict[str, JsonValue]) -> None:
    """Write the state, and the request: all that is needed to ask for the same plan again.

    Raises OutputError where that fails; what was at `path` is then still there.
    """
    write_arrays(path, KIND, {**state, "request": np.array(json.dumps(request))})


def read_state(path: str | Path) -> tuple[State, dict[str, JsonValue]]:
    """Return state and request in the file at `path`. Raises InputError where there is none, or it is damaged."""
    state = read_arrays(path, KIND, largest=_LARGEST)
    try:
        request = json.loads(str(state.pop("request")))
    except (KeyError, ValueError) as error:
        raise InputError(f"{path} is not a {KIND}, or it is damaged; plan anew") from error
    return state, request


def rng_state(rng: np.random.Generator, torch_rng: Generator) -> State:
    """Return the states of two generators of random numbers."""
    return {"rng": np.array(json.dumps(rng.bit_generator.state)), "torch_rng": torch_rng.get_state().numpy()}


def restore_rng(state: State, rng: np.random.Generator, torch_rng: Generator) -> None:
    """Put both generators into the states that `rng_state` returned."""
    rng.bit_generator.state = json.loads(str(state["rng"]))
    torch_rng.set_state(torch.from_numpy(state["torch_rng"]))


def set_back(state: State) -> State:
    """Return a state of planning from which strokes can follow other weights: late in a plan they hardly move.

    From there it takes two thirds of the usual steps.
    """
    progress = state["progress"].copy()
    if progress[0] > _SET_BACK:
        usual = state.get("usual_stride", progress[1])  # older files have none
        progress[:2] = _SET_BACK, max(progress[1], _SOONER * usual.item())
    return {**state, "progress": progress}
