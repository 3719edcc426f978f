"""Brushes: the numbers of Traj2Stroke (paper), their file, and the place where a commanded path leaves its mark."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.kinds import checked
from maulstick.painting.pens import PENS, PenModel, Printable, PrintableName, load_pen
from maulstick.storage.arrays import Floats
from maulstick.storage.files import atomic_write, read_whole
from maulstick.storage.library import Library

_LARGEST = 1e6  # far more than any number of a brush; the renderer squares lengths in single precision
_LEAST = 1e-6  # of a share, a scale, an exponent, and a half-width in metres: the renderer must tell it from 0


def _told_from_0(number: float) -> float:
    if number < _LEAST:
        raise ValueError(f"it must be at least {_LEAST:f}")
    return number


def _told_from_1(number: float) -> float:
    if number > 1 - _LEAST:
        raise ValueError(f"it must be at most {1 - _LEAST:f}")
    return number


_Number = Annotated[float, Field(allow_inf_nan=False, ge=-_LARGEST, le=_LARGEST)]
_Positive = Annotated[_Number, Field(gt=0), AfterValidator(_told_from_0)]
_Share = Annotated[_Number, Field(gt=0, le=1), AfterValidator(_told_from_0)]

Name = PrintableName
"""Name of one printable character or more."""

BRUSHES = Library("brush", "brushes", Path(__file__).with_name("built_in_brushes"))
"""Library of the brushes that come with Maulstick and of the user's own."""

CURVE_PRESSURES = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)
"""Pressures at which a brush's curve is given; between them it is interpolated linearly."""

_SHORTEST = 1e-12  # metres: keeps lengths and lags of 0 out of the denominators
_TOUCHING = 1e-6  # metres: the least known depth, because a depth of 0 means that it is unknown
_MARK_OF_PENS = "fineliner"  # the brush whose mark, across a line, all pens of the catalogue have
_BROADEST = 0.1  # metres: half-width of a broom; more is millimetres that were taken for metres
_LARGEST_FILE = 2**20  # bytes: far more than a brush takes; a larger file is something else


class Brush(BaseModel):
    """A fitted brush: the seven numbers of the paper, and further ones that change nothing by default. Metres.

    m_x, m_y, b_x, b_y: scale and offset from a commanded place to its mark.
    alpha, beta: half-width of the mark = alpha * pressure + beta.
    falloff: exponent c with which the mark pales from its centre line to its edge.
    plateau: share q of the half-width in which the mark is flat.  opacity: darkness o there.
    curve: share of alpha that is reached at each of `CURVE_PRESSURES`; a straight line by default.
    nib: half-width times 1 + nib[0] cos 2φ + nib[1] sin 2φ, where φ is the direction of travel.
    lag: length in d tip / d s = (commanded - tip) / lag, by which the tip is dragged along the path.
    touch: offset (x, y) at which the tip comes down; it fades over the lag.
    faint, solid: opacity times faint + (1 - faint) pressure / solid, at most 1, at the stroke's mean pressure.
    depth: distance of the tip below first touch at pressure 0 and at pressure 1; (0, 0) where unknown.
    lightest: least mean pressure of the strokes that it was fitted to; lighter strokes may leave no mark, and none is
    planned.
    Raises ValidationError where a number is out of range.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    source: Printable
    m_x: _Positive = 1.0
    m_y: _Positive = 1.0
    b_x: _Number = 0.0
    b_y: _Number = 0.0
    alpha: Annotated[_Number, Field(ge=0)]
    beta: _Number
    falloff: _Positive = 1.0
    plateau: Annotated[_Number, Field(ge=0, lt=1), AfterValidator(_told_from_1)] = 0.0
    opacity: _Share = 1.0
    curve: Annotated[tuple[_Number, ...], Field(min_length=len(CURVE_PRESSURES), max_length=len(CURVE_PRESSURES))] = (
        CURVE_PRESSURES
    )
    nib: tuple[_Number, _Number] = (0.0, 0.0)
    lag: Annotated[_Number, Field(ge=0)] = 0.0
    touch: tuple[_Number, _Number] = (0.0, 0.0)
    faint: _Share = 1.0
    solid: _Positive = 1.0
    depth: tuple[_Number, _Number] = (0.0, 0.0)
    lightest: Annotated[_Number, Field(ge=0, le=1)] = 0.0

    @model_validator(mode="after")
    def _leaves_a_mark(self) -> Self:
        if self.widest < _LEAST:
            raise ValueError(
                f"alpha + beta is the half-width of the deepest stroke and must be above 0, at least {_LEAST:f} metres"
            )
        if not np.all(np.diff((0, *self.curve, 1)) >= 0):
            raise ValueError("curve must rise from 0 to 1, as width does with pressure")
        if np.hypot(*self.nib) >= 1:
            raise ValueError("nib must be shorter than 1, so that every direction leaves a mark")
        return self

    @property
    def pressure_matters(self) -> bool:
        """True where pressure changes the mark; most plotters can only lift their pen."""
        return self.alpha > 0

    @property
    def thinnest(self) -> float:
        """Half-width at the lightest pressure, metres; 0 where that leaves no mark."""
        return max(float(self.half_width(np.array(self.lightest))), 0.0)

    @property
    def finest(self) -> float:
        """Half-width of fine lines, metres: the thinnest, or a quarter of the widest where that leaves no mark."""
        return self.thinnest or self.widest / 4

    @property
    def widest(self) -> float:
        """Half-width at pressure 1, metres."""
        return self.alpha + self.beta

    def half_width(self, pressure: Floats) -> Floats:
        """Half-width of the mark in metres at each pressure in [0, 1], any shape; the mean over all directions."""
        share = np.interp(pressure, (0, *CURVE_PRESSURES, 1), (0, *self.curve, 1))
        return np.asarray(self.alpha * share + self.beta)

    def opacity_at(self, pressure: float) -> float:
        """Opacity of a stroke of this mean pressure in [0, 1]."""
        return self.opacity * (self.faint + (1 - self.faint) * min(pressure / self.solid, 1.0))

    def held_at(self, pressure: float) -> "Brush":
        """Return the same brush held at one pressure in [0, 1], as a machine does that can only lift it.

        Raises InputError where that leaves no mark.
        """
        width = float(self.half_width(np.array(pressure)))
        if width < _LEAST:
            raise InputError(f"the brush {self.name} leaves no mark at pressure {pressure:g}; hold it deeper")
        touch, deepest = self.depth
        held = {
            "source": f"{self.source}; held at pressure {pressure:g}",
            "alpha": 0.0,
            "beta": width,
            "opacity": self.opacity_at(pressure),
            "faint": 1.0,
            "depth": (max(touch + pressure * (deepest - touch), _TOUCHING) if any(self.depth) else 0.0,) * 2,
            "lightest": 0.0,
        }
        return Brush.model_validate({**self.model_dump(), **held})

    def pressure_for(self, half_width: Floats) -> Floats:
        """Pressure that draws nearest to each half-width in metres, any shape; the lightest where it has no effect."""
        pressures = np.array((0, *CURVE_PRESSURES, 1))
        nearest = np.interp(half_width, self.half_width(pressures), pressures) * self.pressure_matters
        return np.asarray(np.maximum(nearest, self.lightest))

    def mark(self, path: Floats) -> Floats:
        """Return where a commanded path (..., n, 2 or more), metres, leaves its mark; further columns are kept.

        A standardised stroke starts at its origin, so the first commanded point is the offset (Δx, Δy), and
        (m_x x + b_x + Δx, m_y y + b_y + Δy) scales about it (docs/equations.md).
        """
        marked = np.array(path, dtype=np.float64)
        start = marked[..., :1, :2]
        marked[..., :2] = start + (self.m_x, self.m_y) * (self._dragged(marked[..., :2]) - start) + (self.b_x, self.b_y)
        return marked

    def bare_mark(self, trajectory: Floats) -> tuple[Floats, Floats, float]:
        """Return what a commanded trajectory (n, 3) of x, y in metres and pressure in [0, 1] leaves on paper.

        The centre line (n, 2) and the half-widths (n,), metres, and the opacity: `Traj2Stroke.marks` for one stroke.
        """
        points, pressure = self.mark(trajectory[:, :2]), trajectory[:, 2]
        return points, self.half_width(pressure) * self._broadening(points), self.opacity_at(float(pressure.mean()))

    def _broadening(self, points: Floats) -> Floats:
        """How much broader than its mean the mark is at each point (n,), for the direction of travel there."""
        if len(points) < 2 or not any(self.nib):
            return np.ones(len(points))
        along = np.concatenate([points[1:2] - points[:1], points[2:] - points[:-2], points[-1:] - points[-2:-1]])
        moving = np.maximum.accumulate(np.where(along.any(axis=1), np.arange(len(along)), 0))
        x, y = along[moving].T  # a repeated end goes on as before
        squared = x * x + y * y + _SHORTEST**2
        return np.asarray(1 + (self.nib[0] * (x * x - y * y) + self.nib[1] * 2 * x * y) / squared)

    def _dragged(self, path: Floats) -> Floats:
        """Positions of the tip at the commanded points (..., n, 2): the exact solution along straight segments."""
        if not (self.lag or any(self.touch)):
            return path
        tips = [path[..., 0, :] + self.touch]
        for start, end in zip(np.moveaxis(path, -2, 0)[:-1], np.moveaxis(path, -2, 0)[1:], strict=True):
            length = np.linalg.norm(end - start, axis=-1, keepdims=True)
            behind = self.lag * (end - start) / np.maximum(length, _SHORTEST)
            fading = np.exp(-length / max(self.lag, _SHORTEST))
            tips.append(end - behind + (tips[-1] - start + behind) * fading)
        return np.stack(tips, axis=-2)


def built_in_brushes() -> list[str]:
    """Names of the brushes that come with Maulstick."""
    return [name for name, path in BRUSHES.paths().items() if BRUSHES.is_built_in(path)]


@checked
def load_brush(name: str | Path) -> Brush:
    """Return a built-in brush or one of the user's own by its name, or any brush by the path of its JSON file.

    A name of the catalogue of pens is that pen's brush, unless a brush has it.
    Raises InputError where there is no such brush, or the file is not one.

        >>> load_brush("fineliner").pressure_matters
        False
    """
    name, paths = str(name), BRUSHES.paths()
    if name not in paths and name in PENS.paths():
        return pen_brush(name, load_pen(name))
    if name not in paths and Path(name).suffix != ".json":
        raise InputError.of_choice("brush", name, [*paths, "FILE.json"])
    path = paths.get(name, Path(name))
    try:
        brush = Brush.model_validate_json(read_whole(path, "brush", _LARGEST_FILE))
    except ValidationError as error:
        raise InputError(f"{path} is not a brush: {validation_fault(error)}") from error
    if brush.widest > _BROADEST:
        came = f"alpha + beta is {brush.widest:g} metres"
        raise InputError(
            f"{path} is not a brush: {came}; it must be at most {_BROADEST}, so divide millimetres by 1000"
        )
    return brush


def load_brushes(names: str, own: Mapping[str, Brush] | None = None) -> tuple[Brush, ...]:
    """Return the brushes of names as `load_brush` takes them, with commas between them, the broadest first.

    own: those of a painting by their names, which come first.
    Raises InputError as `load_brush` does, and for two brushes of one name.

        >>> [brush.name for brush in load_brushes("marker,wash")]
        ['wash', 'marker']
    """
    named = [name.strip() for name in names.split(",")]
    return in_painting_order((own or {}).get(name) or load_brush(name) for name in named)


def in_painting_order(brushes: Iterable[Brush]) -> tuple[Brush, ...]:
    """Return brushes in the order in which one painting uses them, the broadest first.

    Raises InputError for none, and for two brushes of one name.
    """
    ordered = tuple(sorted(brushes, key=lambda brush: -brush.widest))
    if not ordered:
        raise InputError("there is no brush to paint with; name at least one")
    for brush in ordered:
        if sum(brush.name == other.name for other in ordered) > 1:
            raise InputError(f"the brush {brush.name} is named twice; a painting has each brush once")
    return ordered


def finest_of(brushes: Iterable[Brush]) -> Brush:
    """Return the brush that draws the finest lines."""
    return min(brushes, key=lambda brush: brush.finest)


def names_of(brushes: Iterable[Brush]) -> str:
    """Return the names of brushes as `load_brushes` takes them."""
    return ",".join(brush.name for brush in brushes)


def pen_brush(name: str, pen: PenModel) -> Brush:
    """Return the brush of a pen: a fineliner's mark, which is half as dark as its middle where the pen's line ends."""
    mark = load_brush(_MARK_OF_PENS)
    half_dark = 1 - (1 - mark.plateau) * 0.5 ** (1 / mark.falloff)  # of the half-width
    source = f"{pen.label}, {pen.kind}, {1e3 * pen.width:g} mm as its maker states it"
    return mark.model_copy(update={"name": name, "source": source, "beta": pen.width / 2 / half_dark})


def load_pen_brush(name: str) -> tuple[Brush, str | None]:
    """Return the brush of a pen by its name, and its colour, ``#rrggbb`` or None where that is not known.

    A pen is in the catalogue, or a brush whose width is constant, as one that was fitted to photographs of a pen; that
    comes first where both have the name, as in `load_brush`.
    Raises InputError where there is no such pen.
    """
    pens = PENS.paths()
    if name not in pens and name not in BRUSHES.paths():
        raise InputError.of_choice("pen", name, [*pens, "a brush of constant width"])
    brush = load_brush(name)
    if brush.pressure_matters:
        raise InputError(
            f"the width of the brush {name} varies with pressure, so it is no pen; plan with it as a brush"
        )
    return brush, load_pen(name).colour if name in pens else None


def write_brush(brush: Brush, path: Path, overwrite: bool = True) -> None:
    """Write a brush as JSON; its folder is made where missing.

    overwrite: replace what is at `path`.  Raises OutputError where something is there that is not to be replaced, or
    writing fails, which leaves it as it was, and InputError where another process goes on writing into the folder.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder of brushes {path.parent}: {error.strerror}") from error
    with BRUSHES.writing_into(path.parent):
        if not overwrite:  # asked while nobody else writes, or two that fit one name would both keep it
            BRUSHES.check_unused(path.stem, path.parent)
        atomic_write(path, f"{brush.model_dump_json(indent=2)}\n".encode())
