"""What a person says of places on the sheet of a plan: acts among those on its strokes, undone and redone with them."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, final

from pydantic import ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.jobs.plan.region_descriptions import ALONG_GUIDES, names_strokes
from maulstick.jobs.plan.request import PlanRequest
from maulstick.studio.state.acts import Acts
from maulstick.studio.state.titles import clean_title, numbered
from maulstick.studio.state.typed_numbers import number
from maulstick.studio.workers.areas import brushed, enclosed, guide
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.said import (
    SAID_ACT,
    Area,
    PutGuide,
    PutRegion,
    Said,
    SaidAct,
    SaidGuide,
    SaidRegion,
    Spot,
    TakeOut,
)
from maulstick.studio.workers.said_files import GUIDES, SAY, read_said, said_files

SAID: Final = "said"
"""Kind of these acts in the file of acts."""

THINNEST: Final = 1e-4
BROADEST: Final = 1.0
"""Bounds of the width of the brush of importance, metres."""

_REGION, _BARE, _IMPORTANT = "Region", "Bare paper", "Important"  # names until others are typed
_MOST_POINTS = 20_000  # of a line that is drawn: minutes of a pen


@final
class Saying:
    """Regions and guides of one plan. Raises InputError where those that it was made with cannot be read."""

    def __init__(self, painting: Path, desk: Desk, acts: Acts) -> None:
        self._painting, self._desk, self._acts = painting, desk, acts
        self.at_first = read_said(painting.parent)

    @property
    def now(self) -> Said:
        """What is said, with what was said when the plan was made, and is not taken out since."""
        said = self.at_first
        for act in self._acts.done(SAID):
            said = said.after(SAID_ACT.validate_json(act))
        return said

    async def enclose(self, points: Sequence[float], *, bare: bool) -> int:
        """Say a region that a line encloses; return its id. points: x, y in metres of each; raises as `enclosed`."""
        async with self._acts.turn:  # or what is undone meanwhile would be the act before
            area = await self._desk.do(enclosed, self._painting, _spots(points))
            return self._put(_region(self.now, _BARE if bare else _REGION, area, bare=bare))

    async def emphasise(self, points: Sequence[float], width: float, importance: float) -> int:
        """Say that what a round brush of a width covers along a line counts so many times; return the region's id.

        What is brushed with one importance is one region. points: x, y in metres of each; raises as `brushed`.
        """
        number(1e3 * width, "the width of the brush", 1e3 * THINNEST, 1e3 * BROADEST, "mm")
        async with self._acts.turn:
            before = next((region for region in self.now.regions if region.is_only(importance)), None)
            area = await self._desk.do(brushed, self._painting, _spots(points), width, before.area if before else ())
            if before is None:
                return self._put(_region(self.now, _IMPORTANT, area, importance=importance, brushed=True))
            self._say_of(before, area=area)
            return before.id

    async def guide(self, points: Sequence[float]) -> int:
        """Say a guide along a line; return its id. points: x, y in metres of each; raises as `guide`."""
        async with self._acts.turn:
            line = await self._desk.do(guide, self._painting, _spots(points))
            return self._put(PutGuide(guide=SaidGuide(id=self.now.free_id, line=line)))

    async def change(self, id: int, **fields: Any) -> None:
        """Say something else of the region with this id. fields: those of `SaidRegion`; a name is cleaned.

        Raises InputError for values that cannot be, and where it is taken out.
        """
        if "name" in fields:
            fields["name"] = name = clean_title(str(fields["name"]))
            if names_strokes(name):
                raise InputError(f"strokes are named as {name} is; give the region another name, such as “part {name}”")
        async with self._acts.turn:
            region = next((each for each in self.now.regions if each.id == id), None)
            if region is None:
                raise InputError("that region is taken out; look at the list once more")
            self._say_of(region, **fields)

    async def take_out(self, id: int) -> None:
        """Take out the region or the guide with this id. Raises InputError where it is taken out already."""
        async with self._acts.turn:
            self._put(TakeOut(id=id))

    async def files(self, request: PlanRequest) -> dict[str, bytes]:
        """Return `said_files` of what is said now, for planning that request."""
        return await self._desk.do(said_files, self._painting, self.now.model_dump_json(), request)

    def unseen(self, files: Mapping[str, bytes]) -> list[str]:
        """Return the names of regions that are not among the files of `files`: nothing of them is on the picture."""
        seen = tomllib.loads(files.get(SAY, b"").decode())
        return [region.name for region in self.now.regions if region.name not in seen]

    def check_guides(self, files: Mapping[str, bytes]) -> None:
        """Raise InputError where strokes of a region are to follow guides, and none is among the files of `files`."""
        lost = [region.name for region in self.now.regions if region.direction == ALONG_GUIDES and not region.bare]
        if lost and GUIDES not in files:
            raise InputError(
                f"strokes of “{lost[0]}” are to follow guides, and there is none on the picture; draw one, or choose "
                "another direction"
            )

    def _say_of(self, region: SaidRegion, **fields: Any) -> None:
        """Say something else of a region in its turn; what is said already is no act."""
        if (changed := _checked({**dict(region), **fields})) != region:
            self._put(PutRegion(region=changed))

    def _put(self, act: SaidAct) -> int:
        """Do an act in its turn; return the id of what it is about."""
        self.now.after(act)
        self._acts.add(SAID, SAID_ACT.dump_json(act).decode())
        match act:
            case PutRegion(region=region):
                return region.id
            case PutGuide(guide=added):
                return added.id
            case TakeOut(id=id):
                return id


def _region(said: Said, name: str, area: Area, **fields: Any) -> PutRegion:
    free = numbered(name, [region.name for region in said.regions])
    region = {"id": said.free_id, "name": free, "colour": said.free_colour, "area": area, **fields}
    return PutRegion(region=_checked(region))


def _checked(fields: dict[str, Any]) -> SaidRegion:
    try:
        return SaidRegion.model_validate(fields)
    except ValidationError as error:
        raise InputError(f"that cannot be said of a region: {validation_fault(error)}") from error


def _spots(points: Sequence[float]) -> list[Spot]:
    """Return points as pairs. Raises InputError where there are none, or too many."""
    if len(points) < 2 or len(points) > 2 * _MOST_POINTS or len(points) % 2:
        raise InputError(f"a line has {len(points) // 2} points; draw one with 1 to {_MOST_POINTS}")
    return list(zip(points[::2], points[1::2], strict=True))
