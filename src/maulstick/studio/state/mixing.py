"""The paints of a plan: how to mix them from the tubes at hand, where they go, and which of them are mixed."""

import asyncio
import csv
import io
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, final

import numpy as np
from nicegui import Event
from pydantic import BaseModel, ConfigDict, ValidationError

from maulstick.colour.mixing import Recipe, mixing_advice
from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint, read_paints
from maulstick.errors import InputError, validation_fault
from maulstick.painting.painting import hex_colour
from maulstick.robot.tray import Tray, read_tray
from maulstick.storage.files import atomic_write
from maulstick.storage.records import read_record, write_record
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.planned_paints import PlannedPaint, planned_paints
from maulstick.studio.workers.uploads import read_brought

_Tubes = tuple[NamedPaint, ...]

_RINSES = 3  # turns in the water


class Mixed(BaseModel):
    """A plan's file of what is mixed: paints by their labels, so that one of another colour is not mixed yet."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    paints: tuple[str, ...] = ()


@dataclass(frozen=True)
class RowOfWells:
    """Wells one below the other beside the sheet; all in metres.

    x, y: the first one, in the canvas frame.  step: to the next.  height, clearance, reach: as in `Tray`.
    """

    x: float
    y: float
    step: float
    height: float
    clearance: float
    reach: float


@final
class Mixing:
    """All about paints in the studio's folder. changed: when a paint is mixed, or the tubes or the tray are others."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._tubes, self._tray = folder.root / "tubes.csv", folder.root / "tray.json"
        self._ticking = asyncio.Lock()  # or of two ticks at once one would be lost
        self._looking = asyncio.Lock()  # or two pages would have the same worked out twice
        self._seen: dict[str, tuple[object, tuple[PlannedPaint, ...]]] = {}
        self._advised: dict[str, tuple[object, tuple[Recipe, ...]]] = {}

    def plans(self) -> list[str]:
        """The plans that have paints, newest first."""
        plans = self._folder.names("plans")
        return [name for name in reversed(plans) if (self._folder.of("plans", name) / "painting.json").is_file()]

    async def paints(self, plan: str) -> tuple[PlannedPaint, ...]:
        """The paints of a plan. Raises InputError where there is no such plan."""
        painting = self._folder.of("plans", plan) / "painting.json"
        tray = self._tray if self.has_tray else None
        stamp = (_stamp(painting), _stamp(self._tray))
        async with self._looking:
            if plan not in self._seen or self._seen[plan][0] != stamp:
                self._seen[plan] = stamp, await self._desk.do(planned_paints, painting, tray)
        return self._seen[plan][1]

    async def advice(self, plan: str) -> tuple[Recipe, ...]:
        """A recipe from the tubes for each paint of a plan."""
        paints = await self.paints(plan)
        tubes, wanted = self.tubes(), tuple(paint.colour for paint in paints)
        async with self._looking:
            if plan not in self._advised or self._advised[plan][0] != (wanted, tubes):
                self._advised[plan] = (wanted, tubes), await self._desk.do(mixing_advice, np.array(wanted), tubes)
        return self._advised[plan][1]

    async def missing(self, plan: str) -> list[PlannedPaint]:
        """The paints that must still be mixed before the plan can be painted."""
        paints, mixed = await self.paints(plan), self.mixed(plan)
        return [paint for paint in paints if paint.strokes and paint.label not in mixed]

    def mixed(self, plan: str) -> frozenset[str]:
        """The labels of the paints that are mixed; there may be others that the plan no longer has."""
        path = self._folder.of("plans", plan) / "mixed.json"
        return frozenset(read_record(Mixed, path, "list of mixed paints").paints if path.is_file() else ())

    async def tick(self, plan: str, label: str, mixed: bool) -> None:
        """The paint is mixed, or is not. Raises InputError where the plan has none of that label."""
        labels = {paint.label for paint in await self.paints(plan)}
        if label not in labels:
            raise InputError.of_choice("paint", label, labels)
        async with self._ticking:
            before = self.mixed(plan)
            await self._write(plan, labels & (before | {label} if mixed else before - {label}))

    async def tick_all(self, plan: str) -> None:
        """All paints of the plan are mixed."""
        labels = {paint.label for paint in await self.paints(plan)}
        async with self._ticking:
            await self._write(plan, labels)

    def tubes(self) -> _Tubes:
        """The paints in tubes that one has; a dozen usual ones until one says otherwise."""
        return read_paints(self._tubes) if self.has_own_tubes else USUAL_PAINTS

    @property
    def has_own_tubes(self) -> bool:
        """Whether one has said which tubes one has."""
        return self._tubes.is_file()

    async def own(self, tubes: bytes) -> None:
        """One has these tubes: a file as `read_paints` takes it. Raises InputError as it does."""
        await asyncio.to_thread(self._keep_tubes, tubes)
        self.changed.emit()

    @property
    def has_tray(self) -> bool:
        """Whether paints stand in a tray; else the pen or the brush is put into the holder when it is asked for."""
        return self._tray.is_file()

    async def use_tray(self, content: bytes) -> None:
        """Paints stand in this tray. Raises InputError where that is not the file of one."""
        await asyncio.to_thread(lambda: self._keep_tray(read_brought(content, read_tray, "that file")))
        self.changed.emit()

    async def lay_tray(self, plan: str, row: RowOfWells) -> None:
        """The paints of a plan stand in a row, then water, then a cloth. Raises InputError where no row can be so."""
        colours = dict.fromkeys(paint.hex for paint in await self.paints(plan))
        places = [{"x": row.x, "y": row.y + number * row.step} for number in range(len(colours) + 2)]
        wells = [place | {"height": row.height} for place in places[:-1]]
        words = {
            "schema_version": 1,
            "reach": row.reach,
            "clearance": row.clearance,
            "paints": dict(zip(colours, wells, strict=False)),
            "water": wells[-1] | {"turns": _RINSES},
            "cloth": places[-1] | {"height": 0.0},
        }
        try:
            tray = Tray.model_validate(words)
        except ValidationError as error:
            raise InputError(f"the wells cannot be so: {validation_fault(error)}") from error
        await asyncio.to_thread(self._keep_tray, tray)
        self.changed.emit()

    def remove_tray(self) -> Path:
        """There is no tray any more; where its file is in the trash."""
        grave = self._folder.throw_away(self._tray)
        self.changed.emit()
        return grave

    def take_back_tray(self, grave: Path) -> None:
        """Use the tray again that was removed."""
        self._folder.take_back(grave, self._folder.root)
        self.changed.emit()

    async def _write(self, plan: str, labels: set[str] | frozenset[str]) -> None:
        if labels != self.mixed(plan):
            path = self._folder.of("plans", plan) / "mixed.json"
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
    """The file of tubes: the name and the colour of each."""
    file = io.StringIO(newline="")
    csv.writer(file, lineterminator="\n").writerows([("name", "colour"), *tubes])
    return file.getvalue().encode()


def _stamp(path: Path) -> tuple[int, int] | None:
    """What is another one when the file is."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
