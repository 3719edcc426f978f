"""Modules of benchmarks/, which are no package."""

from collections.abc import Generator
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
MODULES = ("arrangement", "copies", "descriptors", "drawings", "judge", "kept", "succession", "tables_of_arrangement")


@pytest.fixture(scope="session")
def bench() -> Generator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(BENCHMARKS))
        yield SimpleNamespace(**{name: import_module(name) for name in MODULES})
