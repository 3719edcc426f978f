"""A plan in the making as arrays, so that planning can go on from a file as if it had not stopped."""

import json
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import JsonValue
from torch import Generator, Tensor

from maulstick.errors import InputError
from maulstick.storage.arrays import read_arrays, write_arrays

KIND = "plan in the making"
State = dict[str, NDArray[np.generic]]
"""Everything that the next step depends on, by name."""


def write_state(path: str | Path, state: State, task: dict[str, JsonValue]) -> None:
    """Write the state, and the task: all that is needed to ask for the same plan again.

    Raises OutputError where that fails; what was at `path` is then still there.
    """
    write_arrays(path, KIND, {**state, "task": np.array(json.dumps(task))})


def read_state(path: str | Path) -> tuple[State, dict[str, JsonValue]]:
    """The state and the task in the file at `path`. Raises InputError where there is none, or it is damaged."""
    state = read_arrays(path, KIND)
    try:
        task = json.loads(str(state.pop("task")))
    except (KeyError, ValueError) as error:
        raise InputError(f"{path} is not a {KIND}, or it is damaged; plan anew") from error
    return state, task


def rng_state(rng: np.random.Generator, torch_rng: Generator) -> State:
    """Where two sources of chance are."""
    return {"rng": np.array(json.dumps(rng.bit_generator.state)), "chance": torch_rng.get_state().numpy()}


def restore_rng(state: State, rng: np.random.Generator, torch_rng: Generator) -> None:
    """Put them where they were."""
    rng.bit_generator.state = json.loads(str(state["rng"]))
    torch_rng.set_state(torch.from_numpy(state["chance"]))


def optimiser_state(optimiser: torch.optim.Optimizer) -> State:
    """What an optimiser remembers of each of its tensors."""
    remembered = optimiser.state_dict()["state"]
    return {f"adam.{i}.{name}": entry.numpy() for i, each in remembered.items() for name, entry in each.items()}


def restore_optimiser(state: State, optimiser: torch.optim.Optimizer) -> None:
    """Let an optimiser of the same tensors remember that."""
    remembered: dict[int, dict[str, Tensor]] = {}
    for name, array in state.items():
        if name.startswith("adam."):
            _, index, entry = name.split(".")
            remembered.setdefault(int(index), {})[entry] = torch.from_numpy(np.array(array))
    optimiser.load_state_dict({"state": remembered, "param_groups": optimiser.state_dict()["param_groups"]})
