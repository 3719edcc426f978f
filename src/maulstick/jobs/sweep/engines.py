"""Engines by name: this machine, a Ray cluster, or Slurm."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from pydantic import JsonValue

from maulstick.errors import InputError
from maulstick.jobs.sweep.sweep import Engine
from maulstick.kinds import check_whole

NAMES: Final = ("local", "ray", "ray:ADDRESS", "slurm")
"""Names of all engines."""


_MOST = 1024  # cells at a time


def check_engine(on: str, at_once: int | None) -> None:
    """Raise InputError for the name of no engine, and for a number of cells that is out of its range."""
    if on not in ("local", "ray", "slurm") and not re.fullmatch("ray:.+", on):
        raise InputError.of_choice("place to plan on", on, NAMES)
    if at_once is not None:
        check_whole("at_once", at_once, 1, _MOST)


def make_engine(on: str, at_once: int | None, out: Path, slurm: Mapping[str, JsonValue]) -> Engine:
    """Return the engine of a name that `check_engine` knows. Raises InputError where it is not there.

    at_once: most cells at a time.  out: the sweep's folder.  slurm: parameters of submitit.
    """
    name, _, address = on.partition(":")
    if name == "ray":
        from maulstick.jobs.sweep.on_ray import OnRay  # loads Ray

        return OnRay(address or None, at_once)
    if name == "slurm":
        from maulstick.jobs.sweep.on_slurm import OnSlurm  # loads submitit

        return OnSlurm(out, at_once, slurm)
    from maulstick.jobs.sweep.local import Local

    return Local(at_once)
