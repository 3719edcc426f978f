"""What a person says of places on a sheet, on the canvas of a plan: regions, and guides that strokes follow."""

from functools import cache
from itertools import product
from typing import Annotated, Final, Literal, Self, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter

from maulstick.errors import InputError
from maulstick.jobs.plan.options import LARGEST_HAND, LEAST_HAND
from maulstick.jobs.plan.region_descriptions import REST, Direction
from maulstick.painting.brush import Name
from maulstick.painting.fields import Metres

MOST_REGIONS: Final = 63
"""Regions of a plan, as many as a map has colours for beside white."""

MOST_IMPORTANCE: Final = 1000.0
MOST_DEGREES: Final = 360.0
SOFTEST: Final = 1.0
"""Bounds of what is said of a region: times, a turn either way, and metres."""

_LEVELS = (0, 64, 128, 191, 255)  # of red, green and blue: neighbours are further apart than 60, as a map needs it
_WHITE = (255, 255, 255)
_FIRST = (255, 0, 0)

Spot = tuple[Metres, Metres]
Ring = Annotated[tuple[Spot, ...], Field(min_length=3)]
Area = tuple[Annotated[tuple[Ring, ...], Field(min_length=1)], ...]
"""Polygons, each an outline and the outlines of its holes, metres from the upper left corner of the sheet."""


def _not_the_rest(name: str) -> str:
    if name.strip().casefold() == REST:
        raise ValueError(f"{name} is the name of what no region covers; choose another")
    return name


def _within_a_turn(direction: float | str | None) -> float | str | None:
    if isinstance(direction, float) and abs(direction) > MOST_DEGREES:
        raise ValueError(f"it must be from {-MOST_DEGREES:g} to {MOST_DEGREES:g} degrees")
    return direction


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _Placed(_Record):
    id: int


class SaidRegion(_Placed):
    """Region of a sheet, and what holds there; None where that is as in the rest of the plan.

    colour: on the map.  bare: whether no ink lies there.  brush: names with commas between them, as of the option.
    importance: how much more it counts than the rest.  direction: within a turn.
    soft: width of its edge, metres.  brushed: whether it was painted with the broad brush of importance.
    """

    name: Annotated[Name, Field(max_length=80), AfterValidator(_not_the_rest)]
    colour: Annotated[str, Field(pattern=r"^#[0-9a-f]{6}$")]
    area: Annotated[Area, Field(min_length=1)]
    bare: bool = False
    style: str | None = None
    hand_size: Annotated[float, Field(ge=LEAST_HAND, le=LARGEST_HAND)] | None = None
    brush: str | None = None
    importance: Annotated[float, Field(ge=0, le=MOST_IMPORTANCE)] = 1.0
    direction: Annotated[Direction, AfterValidator(_within_a_turn)] = None
    soft: Annotated[Metres, Field(ge=0, le=SOFTEST)] = 0.0
    brushed: bool = False

    def is_only(self, importance: float) -> bool:
        """Return whether it was brushed with this importance, and nothing else is said of it."""
        others = (self.style, self.hand_size, self.brush, self.direction, self.soft or None)
        is_plain = all(other is None for other in others) and not self.bare
        return self.brushed and is_plain and self.importance == importance


class SaidGuide(_Placed):
    """Guide, a line that strokes near it follow; metres from the upper left corner of the sheet."""

    line: Annotated[tuple[Spot, ...], Field(min_length=2)]


Some = TypeVar("Some", bound=_Placed)


class PutRegion(_Record):
    """Say a region, or in the place of the one with its id, something else of it."""

    kind: Literal["region"] = "region"
    region: SaidRegion


class PutGuide(_Record):
    """Say a guide."""

    kind: Literal["guide"] = "guide"
    guide: SaidGuide


class TakeOut(_Record):
    """Take out a region or a guide, by its id."""

    kind: Literal["take_out"] = "take_out"
    id: int


SaidAct = Annotated[PutRegion | PutGuide | TakeOut, Field(discriminator="kind")]
"""Act of a person on regions and guides; in JSON its `kind` says which."""

SAID_ACT: TypeAdapter[SaidAct] = TypeAdapter(SaidAct)
"""Reader and writer of such acts as JSON."""


class Said(_Record):
    """Regions, of which later ones lie over earlier ones, and guides."""

    regions: tuple[SaidRegion, ...] = ()
    guides: tuple[SaidGuide, ...] = ()

    def after(self, act: SaidAct) -> Self:
        """Return the same after an act.

        Raises InputError for a name or a colour that another region has, too many regions, and an id that is not there.
        """
        match act:
            case PutRegion(region=region):
                others = [each for each in self.regions if each.id != region.id]
                if region.name in [each.name for each in others]:
                    raise InputError(f"another region is called {region.name}; choose another name")
                if region.colour in [each.colour for each in others]:
                    raise InputError(f"another region has the colour {region.colour}; draw it anew")
                if len(others) >= MOST_REGIONS:
                    raise too_many()
                return self.model_copy(update={"regions": _with(self.regions, region)})
            case PutGuide(guide=guide):
                return self.model_copy(update={"guides": _with(self.guides, guide)})
            case TakeOut(id=id):
                if id not in self._ids:
                    raise InputError("that is taken out already; look at the list once more")
                regions, guides = (_without(some, id) for some in (self.regions, self.guides))
                return self.model_copy(update={"regions": regions, "guides": guides})

    @property
    def free_id(self) -> int:
        """Id that none of them has."""
        return 1 + max(self._ids, default=0)

    @property
    def free_colour(self) -> str:
        """Colour on the map that is none's, the clearest first. Raises InputError where there is none left."""
        taken = {each.colour for each in self.regions}
        if len(taken) >= MOST_REGIONS:
            raise too_many()
        return next(colour for colour in map_colours() if colour not in taken)

    @property
    def _ids(self) -> list[int]:
        return [each.id for each in self.regions] + [each.id for each in self.guides]


def _with(all_: tuple[Some, ...], one: Some) -> tuple[Some, ...]:
    if any(each.id == one.id for each in all_):
        return tuple(one if each.id == one.id else each for each in all_)
    return (*all_, one)


def _without(all_: tuple[_Placed, ...], id: int) -> tuple[_Placed, ...]:
    return tuple(each for each in all_ if each.id != id)


def too_many() -> InputError:
    """Return the error for one region more than a map has colours for."""
    return InputError(f"there are {MOST_REGIONS} regions, as many as can be told apart; take one out first")


@cache
def map_colours() -> tuple[str, ...]:
    """Return colours that differ from each other and from white by more than 60/255 in red, green or blue.

    Each is the one that is furthest from all before it.
    """
    left = {colour: _away(colour, _WHITE) for colour in product(_LEVELS, repeat=3)}
    order: list[tuple[int, ...]] = [_FIRST]
    while len(order) < MOST_REGIONS:
        left = {colour: min(away, _away(colour, order[-1])) for colour, away in left.items() if away}
        order.append(max(left, key=lambda colour: left[colour]))
    return tuple(f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in order)


def _away(one: tuple[int, ...], other: tuple[int, ...]) -> int:
    return sum((a - b) ** 2 for a, b in zip(one, other, strict=True))
