"""Paints of a plan: how to mix them from the tubes at hand, their wells, and which of them are mixed."""

import asyncio
import csv
import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, final

import numpy as np
from nicegui import Event
from pydantic import BaseModel, ConfigDict, ValidationError

from maulstick.colour.mixing import Recipe, mixing_advice
from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint, read_paints
from maulstick.errors import InputError, validation_fault
from maulstick.jobs.paintable import is_svg
from maulstick.painting.painting import hex_colour
from maulstick.robot.tray import Tray, read_tray
from maulstick.storage.files import atomic_write
from maulstick.storage.records import read_record, write_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.planned_paints import PlannedPaint, planned_paints
from maulstick.studio.workers.svg_work import CARD
from maulstick.studio.workers.uploads import read_brought

MIXED: Final = "mixed.json"
"""File in a plan's folder: which of its paints are mixed."""

_Tubes = tuple[NamedPaint, ...]

_RINSES = 3  # turns of the brush in the water, in a tray that the studio makes


class Mixed(BaseModel):
    """File of a plan's mixed paints, by their labels, so that a paint whose colour changes is no longer mixed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    paints: tuple[str, ...] = ()


@dataclass(frozen=True)
class RowOfWells:
    """Wells one below the other, next to the sheet; all in metres.

    x, y: of the first well, in the canvas frame.  step: from a well to the next.  height, clearance, reach: as in
    `Tray`.
    """

    x: float
    y: float
    step: float
    height: float
    clearance: float
    reach: float


@final
class Mixing:
    """Paints, tubes and tray in the studio's folder. changed: emitted after any of them has changed."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._tubes, self._tray = folder.root / "tubes.csv", folder.root / "tray.json"
        self._ticking = asyncio.Lock()  # or one of two ticks at once would be lost
        self._looking = asyncio.Lock()  # or two pages would compute the same twice
        self._seen: dict[str, tuple[object, tuple[PlannedPaint, ...]]] = {}
        self._advised: dict[str, tuple[object, tuple[Recipe, ...]]] = {}

    def plans(self) -> dict[str, str]:
        """Return the titles of the plans that have paints, by name, newest first."""
        plans = reversed(self._folder.titles("plans").items())
        return {name: title for name, title in plans if (self._folder.of("plans", name) / "painting.json").is_file()}

    async def paints(self, plan: str) -> tuple[PlannedPaint, ...]:
        """Return the paints of a plan or a drawing. Raises InputError where there is none of that name."""
        painting = self._folder.painting(plan)
        tray = self._tray if self.has_tray else None
        stamp = (_stamp(painting), _stamp(painting.with_name(CARD)), _stamp(self._tray))
        async with self._looking:
            if plan not in self._seen or self._seen[plan][0] != stamp:
                self._seen[plan] = stamp, await self._desk.do(planned_paints, painting, tray)
        return self._seen[plan][1]

    async def advice(self, plan: str) -> tuple[Recipe, ...]:
        """Compute a recipe from the tubes for each paint of a plan. Raises InputError where there is no such plan."""
        paints = await self.paints(plan)
        tubes, wanted = self.tubes(), tuple(paint.colour for paint in paints)
        async with self._looking:
            if plan not in self._advised or self._advised[plan][0] != (wanted, tubes):
                self._advised[plan] = (wanted, tubes), await self._desk.do(mixing_advice, np.array(wanted), tubes)
        return self._advised[plan][1]

    async def missing(self, plan: str) -> list[PlannedPaint]:
        """Return the paints that must still be mixed before the plan can be painted.

        Those of a drawing are pens: the machine asks for them.
        """
        if is_svg(self._folder.painting(plan)):
            return []
        paints, mixed = await self.paints(plan), self.mixed(plan)
        return [paint for paint in paints if paint.strokes and not paint.is_pen and paint.label not in mixed]

    def mixed(self, plan: str) -> frozenset[str]:
        """Read the labels of the mixed paints; some may be of paints that the plan no longer has."""
        path = self._folder.of("plans", plan) / MIXED
        return frozenset(read_record(Mixed, path, "list of mixed paints").paints if path.is_file() else ())

    async def tick(self, plan: str, label: str, mixed: bool) -> None:
        """Mark a paint as mixed, or as not mixed. Raises InputError where the plan has none of that label."""
        labels = {paint.label for paint in await self.paints(plan)}
        if label not in labels:
            raise InputError.of_choice("paint", label, labels)
        async with self._ticking:
            before = self.mixed(plan)
            await self._write(plan, labels & (before | {label} if mixed else before - {label}))

    async def tick_all(self, plan: str) -> None:
        """Mark all paints of the plan as mixed."""
        labels = {paint.label for paint in await self.paints(plan)}
        async with self._ticking:
            await self._write(plan, labels)

    def tubes(self) -> _Tubes:
        """Return the user's tubes of paint; a dozen usual ones where none were chosen."""
        return read_paints(self._tubes) if self.has_own_tubes else USUAL_PAINTS

    @property
    def has_own_tubes(self) -> bool:
        """Whether the user has chosen the tubes."""
        return self._tubes.is_file()

    @property
    def tubes_file(self) -> Path | None:
        """File of the user's tubes; None where none were chosen."""
        return self._tubes if self.has_own_tubes else None

    async def use_tubes(self, tubes: bytes) -> None:
        """Set the user's tubes. tubes: content of a file for `read_paints`. Raises InputError as that does."""
        await asyncio.to_thread(self._keep_tubes, tubes)
        self.changed.emit()

    @property
    def has_tray(self) -> bool:
        """Whether there is a tray of paints; without one, a person puts each pen or brush into the holder."""
        return self._tray.is_file()

    async def use_tray(self, content: bytes) -> None:
        """Set the tray. content: of a tray file. Raises InputError where it is none."""
        await asyncio.to_thread(lambda: self._keep_tray(read_brought(content, read_tray, "that file")))
        self.changed.emit()

    async def lay_tray(self, plan: str, row: RowOfWells) -> None:
        """Set a tray of wells in a row: a plan's paints, then water, then a cloth. Raises InputError for a bad row."""
        if not row.step:
            raise InputError("all wells would be one, water and cloth too; say how far it is from each to the next")
        colours = dict.fromkeys(paint.hex for paint in await self.paints(plan))
        places = [{"x": row.x, "y": row.y + number * row.step} for number in range(len(colours) + 2)]
        wells = [place | {"height": row.height} for place in places[:-1]]
        fields = {
            "schema_version": 1,
            "reach": row.reach,
            "clearance": row.clearance,
            "paints": dict(zip(colours, wells, strict=False)),
            "water": wells[-1] | {"turns": _RINSES},
            "cloth": places[-1] | {"height": 0.0},
        }
        try:
            tray = Tray.model_validate(fields)
        except ValidationError as error:
            raise InputError(f"the wells cannot be so: {validation_fault(error)}") from error
        await asyncio.to_thread(self._keep_tray, tray)
        self.changed.emit()

    def remove_tray(self) -> Path:
        """Move the tray's file into the trash; return its place there, for `take_back`."""
        trashed = self._folder.throw_away(self._tray)
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path) -> None:
        """Move the tray's file, or that of the tubes, back out of the trash; raises as `Folder.take_back`."""
        self._folder.take_back(trashed, self._folder.root)
        self.changed.emit()

    async def _write(self, plan: str, labels: set[str] | frozenset[str]) -> None:
        if labels != self.mixed(plan):
            path = self._folder.of("plans", plan) / MIXED
            await asyncio.to_thread(write_record, Mixed(paints=tuple(sorted(labels))), path)
            self.changed.emit()

    def _keep_tray(self, tray: Tray) -> None:
        self._folder.keep_former(self._tray)
        write_record(tray, self._tray)

    def _keep_tubes(self, content: bytes) -> None:
        read = read_brought(content, read_paints, "the list of tubes")
        self._folder.keep_former(self._tubes)
        atomic_write(self._tubes, tubes_csv((tube.name, hex_colour(tube.colour)) for tube in read))


def tubes_csv(tubes: Iterable[tuple[str, str]]) -> bytes:
    """Encode tubes, given by name and colour, as a file for `read_paints`."""
    file = io.StringIO(newline="")
    csv.writer(file, lineterminator="\n").writerows([("name", "colour"), *tubes])
    return file.getvalue().encode()


def _stamp(path: Path) -> tuple[int, int] | None:
    """Stamp of a file, which changes when the file changes; None where there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
