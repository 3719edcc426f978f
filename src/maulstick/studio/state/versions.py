"""Versions of a plan: planned again around what a person has changed, each a plan of its own."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from maulstick.jobs.plan.request import PlanRequest

_AGAIN = "again.json"  # file in a plan's folder: the painting that it is planned around, where there is one
_VERSION = re.compile(r", version ([0-9]{1,6})$")


@dataclass(frozen=True)
class Around:
    """Painting that a version is planned around. frame: a JPEG of it, to look at until there are others."""

    painting: Path
    frame: bytes

    def move_to(self, folder: Path, request: PlanRequest) -> PlanRequest:
        """Move the painting into a plan's folder; return its request, once, for the rest around the locked strokes."""
        again = self.painting.replace(folder / _AGAIN)
        return replace(request, options=replace(request.options, again=again), tries=1)


def version_title(title: str, others: Iterable[str]) -> str:
    """Return the title of a further version of the plan of that title: "Cat, version 2". others: all plans' titles."""
    first = _VERSION.sub("", title)
    found = [
        int(number[1]) for other in others if _VERSION.sub("", other) == first for number in _VERSION.finditer(other)
    ]
    return f"{first}, version {1 + max(found, default=1)}"
