"""Modules of benchmarks/, which are no package."""

from collections.abc import Generator
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import torch

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
MODULES = ("arrangement", "copies", "descriptors", "drawings", "judge", "kept", "succession", "tables_of_arrangement")


@pytest.fixture(scope="session")
def bench() -> Generator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        yield SimpleNamespace(**{name: import_module(name) for name in MODULES})


@pytest.fixture(autouse=True)
def own_number_of_threads() -> Generator[None]:
    """Give torch its threads back after a benchmark, which takes one for the whole of its process."""
    before = torch.get_num_threads()
    yield
    torch.set_num_threads(before)
