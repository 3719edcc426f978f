"""Files of regions: a map of the picture in colours, and a TOML file that says what holds in each."""

from collections.abc import Sequence
from math import fsum, radians
from pathlib import Path

import numpy as np
import shapely

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError
from maulstick.jobs.plan.region_descriptions import (
    ALONG_GUIDES,
    REST,
    RegionDescription,
    names_strokes,
    read_descriptions,
)
from maulstick.painting.brush import Brush, in_painting_order, load_brushes
from maulstick.painting.fit import place_of
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import Canvas, parse_length
from maulstick.planning.regions import Region, Regions
from maulstick.planning.soft_edges import softened
from maulstick.storage.arrays import Floats, Ints
from maulstick.style import Style, load_style

_SAME = 60 / 255  # of sRGB: what is further from the colours of all regions, and from white, is none of them
_WHITE = (1.0, 1.0, 1.0)


class RegionFiles:
    """Regions as two files say them. Raises InputError where they cannot be read, or do not agree."""

    def __init__(self, regions: Path, say: Path) -> None:
        self._map, self._say = regions, say
        self._said = {REST: RegionDescription(), **read_descriptions(say)}
        named: dict[tuple[float, float, float], str] = {}
        for name, said in self._said.items():
            if name == REST:
                continue
            if names_strokes(name):
                raise InputError(f"{say}: a region is called {name}, as strokes are named; call it otherwise")
            if said.soft is not None:
                try:
                    parse_length(said.soft)
                except InputError as error:
                    raise InputError(f"{say}: the soft edge of {name}: {error.fault}", error.remedy) from error
                if said.bare:
                    raise InputError(f"{say}: {name} is bare, and bare paper has sharp edges; leave out soft")
            if said.colour is None:
                raise InputError(f"{say}: {name} has no colour on the map; give it one, as in colour = '#ff0000'")
            if (same := named.setdefault(parse_colour(said.colour), name)) != name:
                raise InputError(f"{say}: {same} and {name} have the same colour, {said.colour}; give each its own")
        self._colours = dict(named)
        self._brushes = {text: load_brushes(text) for said in self._said.values() if (text := said.brush)}

    def brushes(self, usual: Sequence[Brush]) -> tuple[Brush, ...]:
        """Return the usual brushes, and those that regions use beside them, the broadest first."""
        more = {brush.name: brush for brushes in self._brushes.values() for brush in brushes}
        return in_painting_order({**more, **{brush.name: brush for brush in usual}}.values())

    @property
    def colours(self) -> tuple[tuple[float, float, float], ...]:
        """All colours that regions are painted in alone, sRGB in [0, 1]."""
        every = [parse_colour(colour) for said in self._said.values() for colour in said.colours or ()]
        return tuple(dict.fromkeys(every))

    def on(
        self,
        canvas: Canvas,
        shape: tuple[int, ...],
        fit: str,
        margin: float,
        hand: Style,
        hand_size: float,
        brushes: Sequence[Brush],
        usual: Sequence[Brush],
    ) -> Regions:
        """Return the regions on a canvas, for a picture of this shape (h, w) that is laid out so.

        hand: as large as it was learned, where no style is said.  hand_size: where none is said.
        brushes: of the plan.  usual: those used where none is said.
        Raises InputError for a region that the map does not show, and where all of the sheet is to be bare.
        """
        labels = self._labels(canvas, shape, fit, margin)
        for number, (name, one) in enumerate(self._said.items()):
            if name != REST and not (labels == number).any():
                raise InputError(
                    f"{self._map} shows nothing in {one.colour}, the colour of {name}, where the plan has its pixels; "
                    "paint more of it, or leave it out"
                )
        regions = tuple(
            self._region(name, one, canvas, hand, hand_size, brushes, usual) for name, one in self._said.items()
        )
        there = [regions[number] for number in np.unique(labels).tolist()]
        if all(region.bare for region in there):
            raise InputError(f"{self._say} leaves all of the sheet bare; leave some of it to be painted")
        if fsum(region.share or 0 for region in there) > 1:
            raise InputError(f"{self._say}: the shares of all regions are more than 1; lower some")
        return Regions(self._softened(labels, list(self._said.values()), canvas), regions, canvas)

    def _softened(self, labels: Ints, said: Sequence[RegionDescription], canvas: Canvas) -> Ints:
        """Return labels (H, W) with the edges soft that are said to be, but never towards bare paper."""
        open_to, noise = np.array([not one.bare for one in said]), np.random.default_rng(0).random(labels.shape)
        for number, one in enumerate(said):
            if one.soft is not None:
                width = parse_length(one.soft) * canvas.pixels_per_metre
                labels = softened(labels, number, width, open_to, noise)
        return labels

    def _region(
        self,
        name: str,
        said: RegionDescription,
        canvas: Canvas,
        hand: Style,
        hand_size: float,
        brushes: Sequence[Brush],
        usual: Sequence[Brush],
    ) -> Region:
        own = hand if said.style is None else load_style(said.style, canvas)
        names = {brush.name for brush in (usual if said.brush is None else self._brushes[said.brush])}
        return Region(
            name,
            own.scaled(said.hand_size or hand_size),
            tuple(brush.name in names for brush in brushes),
            None if said.colours is None else tuple(parse_colour(colour) for colour in said.colours),
            said.share,
            said.bare,
            radians(said.direction) if isinstance(said.direction, float) else None,
            said.direction == ALONG_GUIDES,
            said.importance,
            tuple(said.weights.items()),
        )

    def _labels(self, canvas: Canvas, shape: tuple[int, ...], fit: str, margin: float) -> Ints:
        """Return the index of each pixel's region, (H, W); the map is stretched over the picture, and its edges on."""
        left, top, right, bottom = place_of(shape[:2], canvas, fit, margin)
        x = (np.arange(canvas.width_px) + 0.5 - left) / (right - left)
        y = (np.arange(canvas.height_px) + 0.5 - top) / (bottom - top)
        u, v = x.clip(0, 1 - 1e-9), y.clip(0, 1 - 1e-9)
        colours = _of_svg(self._map, u, v) if self._map.suffix.lower() == ".svg" else _of_picture(self._map, u, v)
        known, names = np.array([_WHITE, *self._colours]), list(self._said)
        numbers = np.array([names.index(REST), *(names.index(name) for name in self._colours.values())])
        if _WHITE in self._colours:
            known, numbers = known[1:], numbers[1:]
        away = np.stack([np.abs(colours - colour).max(axis=2) for colour in known])
        return np.where(away.min(axis=0) <= _SAME, numbers[away.argmin(axis=0)], names.index(REST))


def _of_picture(path: Path, u: Floats, v: Floats) -> Floats:
    """Return the colours of a picture, (H, W, 3), at shares u (W,) of its width and v (H,) of its height."""
    pixels = read_picture(path)
    rows, columns = (v * pixels.shape[0]).astype(int), (u * pixels.shape[1]).astype(int)
    return np.asarray(pixels[rows[:, None], columns[None]], dtype=np.float64)


def _of_svg(path: Path, u: Floats, v: Floats) -> Floats:
    """Return the colours that shapes of an SVG fill, (H, W, 3), at shares u (W,) and v (H,) of its page."""
    from maulstick.drawing.read import read_fills  # loads parsers

    fills, (width, height) = read_fills(path)
    x, y = np.meshgrid(u * width, v * height)
    colours = np.ones((*x.shape, 3))
    for colour, region in fills:
        shapely.prepare(region)
        colours[shapely.contains_xy(region, x, y)] = colour
    return colours
