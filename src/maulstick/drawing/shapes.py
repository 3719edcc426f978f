"""Shapes of an SVG, as they lie on its page: transforms, nested viewports, <use>, styles, layers and clips resolved.

svgelements reads paths, transforms and colours. Its own walk through a document loses clips and layers, takes
percentages after a nested <svg> of the wrong viewport, and knows neither <symbol>'s viewBox nor <switch>.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Final
from xml.etree.ElementTree import Element

import numpy as np
from svgelements import Matrix  # type: ignore[import-untyped]

from maulstick.drawing.document import INKSCAPE, SVG_SPACE, Page
from maulstick.drawing.geometry import is_shape, outline
from maulstick.drawing.lines import bounds_of
from maulstick.errors import InputError
from maulstick.painting.svg import OWN_LAYER
from maulstick.recording.files.css import GEOMETRY, MOVES, Rgb, Style, colour_of, inherited, is_zero, referred, unread
from maulstick.recording.files.lengths import Viewport
from maulstick.recording.files.markup import local_name
from maulstick.recording.files.style_sheet import StyleSheet
from maulstick.recording.files.svg_paths import link_of, numbers, viewed
from maulstick.recording.files.transforms import moved, transform_of
from maulstick.storage.arrays import Floats

NEVER: Final = "%"
"""First character of the label of a layer that is not plotted."""

_SOURCE = "{http://purl.org/dc/elements/1.1/}source"  # element in which a program says how it made a file
_MOST_ELEMENTS = 1_000_000  # with every <use> and clip replaced: ten times a large drawing
_DEEPEST = 100  # of groups within groups: more than programs write, and less than Python's stack allows
_GROUPS = ("svg", "g", "a", "switch")
_TRANSFORMS = MOVES | {"transform"}
_HIDDEN = ("hidden", "collapse")
_TEXTS = ("text", "flowRoot", "foreignObject")
_TEXT = "it has text{where}; a pen draws paths: make them in Inkscape by Path > Object to Path, and save it again"
_IMAGE = "it has a picture{where}; a pen draws paths: trace it in Inkscape by Path > Trace Bitmap, or delete it"


@dataclass(frozen=True)
class Clip:
    """Region in which shapes are drawn: that within any of these shapes, by their rules."""

    shapes: tuple["Shape", ...]


@dataclass(frozen=True, eq=False)
class Group:
    """Group that may be a pen of its own: an Inkscape layer, or a group at the top.

    label: None where it has none.  is_own: whether a painting was written as it, as far as is known.
    """

    label: str | None
    is_layer: bool
    is_own: bool


@dataclass(frozen=True)
class Shape:
    """Shape on the page.

    chains: its subpaths, each of cubic Béziers (m, 4, 2), pixels of the page.  width: of its stroke, in pixels.
    stroke, fill: colours, None where there is none.  rule: of its fill, ``nonzero`` or ``evenodd``.
    """

    chains: list[Floats]
    stroke: Rgb | None
    fill: Rgb | None
    rule: str
    width: float
    group: Group | None
    clips: tuple[Clip, ...]


@dataclass(frozen=True)
class _Place:
    """Where an element stands in the document."""

    matrix: Matrix
    viewport: Viewport
    style: Style
    clips: tuple[Clip, ...] = ()
    group: Group | None = None
    depth: int = 0
    used: tuple[str, ...] = ()


@dataclass
class Walk:
    """Walk through a document.

    passed_over: names of what it has, and is not drawn.  faulty: number of paths with faulty data.
    unread: the first colour of a form that is not read, None where all are.
    """

    root: Element
    sheet: StyleSheet = field(init=False)
    page: Page = field(init=False)
    passed_over: set[str] = field(default_factory=set)
    faulty: int = 0
    unread: str | None = None

    def __post_init__(self) -> None:
        self.sheet = StyleSheet(self.root)
        self.page = Page.of(self.root, self.sheet.of(self.root))
        self._named = {
            name: element for element in reversed(list(self.root.iter())) if (name := element.get("id")) is not None
        }
        self._clips: dict[tuple[str, str, Viewport, tuple[int, ...]], Clip] = {}
        sources = (element.text or "" for element in self.root.iter(_SOURCE))
        self._is_by_vpype = any(source.lstrip().startswith("vpype") for source in sources)
        self._count = 0
        self._clipping = self._measuring = False

    def shapes(self) -> Iterator[Shape]:
        """Yield all shapes that can be seen, in their order.

        Raises InputError for text, pictures, references to other files, and what is too large or refers to itself.
        """
        own = self.sheet.of(self.root)
        if self._is_shown(own):
            yield from self._children(self.root, _Place(self.page.matrix, self.page.viewport, inherited({}, own)))

    def _is_shown(self, own: Style) -> bool:
        """Return whether what lies in an element with these properties can be seen."""
        return own.get("display") != "none" and (self._clipping or not is_zero(own.get("opacity")))

    def _children(self, parent: Element, place: _Place) -> Iterator[Shape]:
        inside = replace(place, depth=place.depth + 1)
        children = iter(parent)
        if local_name(parent) == "switch":
            children = iter([child for child in parent if local_name(child) != "foreignObject"][:1])
        for child in children:
            yield from self._element(child, inside)

    def _element(self, element: Element, place: _Place) -> Iterator[Shape]:
        space, _, tag = element.tag.rpartition("}")
        if space.lstrip("{") not in ("", SVG_SPACE):
            return
        own = self.sheet.of(element)
        if not self._is_shown(own):
            return
        if place.depth > _DEEPEST:
            raise InputError(f"its groups and uses lie more than {_DEEPEST} deep within each other; ungroup some")
        self._count += 1
        if self._count > _MOST_ELEMENTS:
            raise InputError(f"it has over {_MOST_ELEMENTS} elements, counting every <use> of them; split it")
        style = inherited(place.style, own)
        if tag in _GROUPS or tag == "use":
            yield from self._group(element, tag, own, replace(place, style=style))
        elif style.get("visibility", "visible") not in _HIDDEN:
            if tag in _TEXTS and "".join(element.itertext()).strip():
                raise InputError(_TEXT.format(where=_named(element)))
            if tag == "image":
                raise InputError(_IMAGE.format(where=_named(element)))
            if is_shape(tag):
                yield from self._shape(element, own, replace(place, style=style))

    def _shape(self, element: Element, own: Style, place: _Place) -> Iterator[Shape]:
        place = self._clipped(element, own, self._transformed(own, place))
        chains, whole = outline(element, place.viewport)
        self.faulty += not whole
        m = place.matrix
        style = place.style
        self.passed_over.update(
            "markers" for name in ("marker-start", "marker-mid", "marker-end") if referred(own.get(name))
        )
        stroke = colour_of(style, "stroke", "none")
        if not self._clipping:
            self.unread = self.unread or unread(style, "stroke") or unread(style, "fill")
        if stroke is not None and any(numbers(style.get("stroke-dasharray"))):
            self.passed_over.add("dashes")
        if chains and m.determinant != 0:
            yield Shape(
                [moved(chain, m) for chain in chains],
                stroke,
                colour_of(style, "fill", "black"),
                style.get("clip-rule" if self._clipping else "fill-rule", "nonzero"),
                place.viewport.other(style.get("stroke-width", "1")) * abs(m.determinant) ** 0.5,
                place.group,
                place.clips,
            )

    def _group(self, element: Element, tag: str, own: Style, place: _Place) -> Iterator[Shape]:
        group = self._group_of(element, tag, place)
        if group is not None and (group.label or "").lstrip().startswith(NEVER):
            return
        if place.group is None or not place.group.is_layer:
            place = replace(place, group=group or place.group)
        place, view = self._transformed(own, place), place.viewport
        if tag == "use":
            matrix = Matrix.translate(view.x(element, "x"), view.y(element, "y")) * place.matrix
            yield from self._used(element, self._clipped(element, own, replace(place, matrix=matrix)))
            return
        place = self._within(element, own, place) if tag == "svg" else self._clipped(element, own, place)
        yield from self._children(element, place)

    def _group_of(self, element: Element, tag: str, place: _Place) -> Group | None:
        """Return the group that an element is, if it is a layer or a group at the top."""
        is_layer = element.get(f"{INKSCAPE}groupmode") == "layer"
        if self._clipping or tag != "g" or not (is_layer or place.depth == 1):
            return None
        name = element.get("id")
        # vpype keeps labels as they were, and gives ids of its own
        is_own = is_layer and (self._is_by_vpype or OWN_LAYER.fullmatch(name or "") is not None)
        return Group(element.get(f"{INKSCAPE}label") or name, is_layer, is_own)

    def _used(self, element: Element, place: _Place) -> Iterator[Shape]:
        link = link_of(element)
        if link and not link.startswith("#"):
            raise InputError(f"it uses {link[:60]!r} of another file; copy that into the drawing")
        target = self._named.get(link[1:])
        if target is None:
            return
        if link in place.used:
            raise InputError(f"a <use> in it uses itself, by {link[:60]!r}; take that out")
        place = replace(place, used=(*place.used, link), depth=place.depth + 1)
        if local_name(target) not in ("symbol", "svg"):
            yield from self._element(target, place)
            return
        own = self.sheet.of(target)
        if self._is_shown(own):
            place = self._transformed(own, replace(place, style=inherited(place.style, own)))
            yield from self._children(target, self._within(target, own, place, element))

    def _within(self, element: Element, own: Style, place: _Place, use: Element | None = None) -> _Place:
        """Return the place inside an element with a viewport of its own, whose size its <use> may say instead."""
        view, clips = place.viewport, place.clips
        across, down = (element if use is None or use.get(name) is None else use for name in ("width", "height"))
        corner = view.x(element, "x"), view.y(element, "y")
        box = (*corner, view.x(across, "width", "100%"), view.y(down, "height", "100%"))
        if own.get("overflow", "hidden") not in ("visible", "auto"):
            frame = Element(
                "rect", {name: f"{side!r}" for name, side in zip(("x", "y", "width", "height"), box, strict=True)}
            )
            clips = (*clips, Clip(tuple(self._shape(frame, {}, replace(place, clips=())))))
        matrix, viewport = viewed(element, box)
        inside = replace(place, matrix=matrix * place.matrix, viewport=viewport, clips=clips)
        return self._clipped(element, own, inside)

    def _transformed(self, own: Style, place: _Place) -> _Place:
        """Return the place after the transform that an element, or a clip of it, has of its own."""
        if not own.keys() & _TRANSFORMS:
            return place
        if own.get("transform-box", "view-box") != "view-box":
            self.passed_over.add("transform-box")
        matrix = transform_of(own, place.viewport.width, place.viewport.height)
        return replace(place, matrix=matrix * place.matrix)

    def _clipped(self, element: Element, own: Style, place: _Place) -> _Place:
        """Return the place within the clip that an element, or a clip of it, has of its own."""
        if own.keys() & GEOMETRY:
            self.passed_over.add("sizes and places in styles")
        if referred(own.get("mask")):
            self.passed_over.add("masks")
        name = referred(own.get("clip-path"))
        if name is None and own.get("clip-path", "none").lower() not in ("none", "initial", "revert", ""):
            self.passed_over.add("clips by CSS's basic shapes")
        if name is not None and name in self._named and not self._measuring:
            place = replace(place, clips=(*place.clips, *self._clips_of(element, name, place)))
        return place

    def _clips_of(self, element: Element, name: str, place: _Place) -> tuple[Clip, ...]:
        clip = self._named[name]
        if local_name(clip) != "clipPath":
            return ()
        key = f"clip {name}"
        if key in place.used:
            raise InputError(f"the clip {name!r} in it clips itself; take that out")
        own, style = self.sheet.of(clip), self.sheet.where_it_stands(clip)
        outside = self._clipped(element, own, replace(place, style=style, clips=(), used=(*place.used, key)))
        inside = self._transformed(own, outside)
        if clip.get("clipPathUnits") == "objectBoundingBox":
            inside = replace(inside, matrix=self._box_of(element, place) * inside.matrix)
        at = name, repr(inside.matrix), inside.viewport, tuple(map(id, inside.clips))
        if at not in self._clips:
            before, self._clipping = self._clipping, True
            self._clips[at] = Clip(tuple(self._children(clip, inside)))
            self._clipping = before
        return (self._clips[at],)

    def _box_of(self, element: Element, place: _Place) -> Matrix:
        """Return what takes the unit square to the box around an element's unclipped shapes, in its coordinates."""
        own = {name: each for name, each in self.sheet.of(element).items() if name not in _TRANSFORMS}
        place, tag = replace(place, matrix=Matrix(), clips=()), local_name(element)
        faulty, before, self._clipping, self._measuring = self.faulty, self._clipping, False, True
        if tag == "use":
            shapes = self._used(element, place)
        else:
            shapes = self._shape(element, own, place) if is_shape(tag) else self._children(element, place)
        chains = [chain for shape in shapes for chain in shape.chains]
        self.faulty, self._clipping, self._measuring = faulty, before, False  # paths are counted where they are drawn
        (left, top), (right, bottom) = bounds_of(chains) if chains else np.zeros((2, 2))
        return Matrix(right - left, 0, 0, bottom - top, left, top)


def _named(element: Element) -> str:
    name = element.get(f"{INKSCAPE}label") or element.get("id")
    return "" if name is None else f" ({name[:40]!r})"
