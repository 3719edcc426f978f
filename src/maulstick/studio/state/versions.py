"""Versions of a plan: planned again around what a person has changed, or kept as it is, each a plan of its own."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from maulstick.errors import InputError
from maulstick.jobs.plan.options import MOST_STROKES, PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.robot.journal import Journal, journal_of, latest_journal
from maulstick.storage.files import atomic_write
from maulstick.storage.records import read_record, write_record
from maulstick.studio.state.titles import MOST_LETTERS, clean_title
from maulstick.studio.state.weighing import weights_in_words
from maulstick.studio.workers.planner import KEPT
from maulstick.studio.workers.said_files import GUIDES, MAP, SAY

_AGAIN = "again.json"  # file in a plan's folder: the painting that it is planned around, where there is one
_RECORD = "version.json"  # in a version's folder
_PLACES = {"regions": MAP, "say": SAY, "guides": GUIDES}  # files in a plan's folder, by the options that name them
_VERSION = re.compile(r", version ([0-9]{1,6})$")


class _Version(BaseModel):
    """Content of version.json.

    changes: sentence on what differs from the plan that the version came from.  weights: of all terms of that plan,
    where others are to matter.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    changes: str
    weights: dict[str, float] | None = None


@dataclass(frozen=True)
class Around:
    """Painting that a version is planned around, or that it keeps as it is.

    frame: a JPEG of it, to look at until there are others.  files: others of the version's folder, by name.
    changes: sentence on what differs from the plan that it came from.  is_kept: whether nothing is planned.
    photograph: of the sheet, with strokes of these ids that are `painted`, over which the rest is planned.
    weights: of all terms of the plan that it came from, where others are to matter.
    strokes: number that it has in all, those locked counted, as its file says; None where it says none.
    """

    painting: Path
    frame: bytes
    files: Mapping[str, bytes] = field(default_factory=dict)
    changes: str = ""
    is_kept: bool = False
    photograph: Path | None = None
    painted: frozenset[int] = frozenset()
    weights: dict[str, float] | None = None
    strokes: int | None = None

    def move_to(self, folder: Path, request: PlanRequest) -> PlanRequest:
        """Move the painting and the files into a plan's folder; return its request, once, for the rest around them."""
        again = self.painting.replace(folder / (KEPT if self.is_kept else _AGAIN))
        for name, content in self.files.items():
            atomic_write(folder / name, content)
        write_record(_Version(changes=self.changes, weights=self.weights), folder / _RECORD)
        own: dict[str, Any] = {name: folder / file for name, file in _PLACES.items() if file in self.files}
        if self.photograph is not None:
            own |= {"background": self.photograph, "paper": PlanOptions.paper}
            with Journal.open(journal_of(again)) as journal:
                journal.revise(again, sorted(self.painted))
        if self.strokes is not None:  # guides that are painted came beside those asked for, and painted ones are gone
            own["strokes"] = strokes = min(self.strokes, MOST_STROKES)
            own["paints"] = None if request.options.paints is None else min(request.options.paints, strokes)
        return replace(request, options=replace(request.options, again=again, **own), tries=1)


def without_own_places(request: PlanRequest, folder: Path) -> PlanRequest:
    """Return the request of the plan in a folder without the regions and guides that are that folder's own."""
    options = request.options
    own = [name for name, file in _PLACES.items() if getattr(options, name) == folder / file]
    none: dict[str, Any] = dict.fromkeys(own)
    return replace(request, options=replace(options, **none))


def painted_of(painting: Path) -> frozenset[int]:
    """Return the ids of the strokes of a plan's painting that are on its latest sheet.

    Raises InputError where a camera's looks have planned it again since, so that its strokes are others.
    """
    if (latest := latest_journal(painting)) is None:
        return frozenset()
    journal = Journal.read(latest)
    if journal.painting() != painting:
        raise InputError(
            "the camera has had this planned again while it was painted, so other strokes are on the sheet; plan the "
            "picture anew, with the photograph under “More”"
        )
    return frozenset(journal.painted)


def changes_in(folder: Path, weights: Mapping[str, float]) -> str:
    """Return the sentence on what differs in the version in a plan's folder; "" where it is none.

    weights: of all its terms, by name.
    """
    try:
        version = read_record(_Version, folder / _RECORD, "version")
    except InputError:
        return ""
    changed = "" if version.weights is None else weights_in_words(version.weights, weights)
    return f"{version.changes.removesuffix('.')}, {changed}." if changed else version.changes


def version_title(title: str, others: Iterable[str]) -> str:
    """Return the title of a further version of the plan of that title: "Cat, version 2". others: all plans' titles."""
    first = _first(title)
    found = [int(number[1]) for other in others if _first(other) == first for number in _VERSION.finditer(other)]
    return f"{first}, version {1 + max(found, default=1)}"


def _first(title: str) -> str:
    """Return the title of the plan that a version came from at first, so short that a number has room behind it."""
    return clean_title(_VERSION.sub("", title), MOST_LETTERS - len(", version 999999"))
