"""Paths within a studio's files, written so that its folder may be moved, or copied to another machine."""

import json
import os
from pathlib import Path
from typing import Any, Final

from maulstick.jobs.plan.request import PlanRequest

REQUEST: Final = "request.json"
"""Name of the file of a plan's request, in its folder."""

_ROOT = "studio:/"  # stands for the studio's folder in its files


def carried_off(plain: Any, root: Path) -> Any:
    """Return JSON in which all paths within the studio's folder `root` are written as its own."""
    return _replaced(plain, f"{root}{os.sep}", _ROOT)


def carried_here(plain: Any, root: Path) -> Any:
    """Return JSON in which what `carried_off` wrote are paths within the folder `root` again."""
    return _replaced(plain, _ROOT, f"{root}{os.sep}")


def read_request(path: Path, root: Path) -> PlanRequest:
    """Return a plan's request out of its file; `root` is the studio's folder.

    Raises OSError where it cannot be read, and ValueError where it is none of this version.
    """
    return PlanRequest.from_json(carried_here(json.loads(path.read_bytes()), root), path)


def _replaced(plain: Any, before: str, now: str) -> Any:
    """Return JSON whose texts, names of fields included, begin with `now` where they began with `before`."""
    match plain:
        case str():
            return now + plain.removeprefix(before) if plain.startswith(before) else plain
        case list():
            return [_replaced(each, before, now) for each in plain]
        case dict():
            return {_replaced(name, before, now): _replaced(each, before, now) for name, each in plain.items()}
        case _:
            return plain
