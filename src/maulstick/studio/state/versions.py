"""Versions of a plan: planned again around what a person has changed, each a plan of its own."""

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Final

from maulstick.jobs.plan.request import PlanRequest

AGAIN: Final = "again.json"
"""File in a plan's folder: the painting that it is planned around, where there is one."""

_VERSION = re.compile(r", version ([0-9]{1,6})$")


def planned_around(request: PlanRequest, painting: Path) -> PlanRequest:
    """Return a plan's request, once, for the rest around a painting's locked strokes."""
    return replace(request, options=replace(request.options, again=painting), tries=1)


def version_title(title: str, others: Iterable[str]) -> str:
    """Return the title of a further version of the plan of that title: "Cat, version 2". others: all plans' titles."""
    first = _VERSION.sub("", title)
    found = [
        int(number[1]) for other in others if _VERSION.sub("", other) == first for number in _VERSION.finditer(other)
    ]
    return f"{first}, version {1 + max(found, default=1)}"
