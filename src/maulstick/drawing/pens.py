"""Pens of a drawing: its layers, else its groups, else its colours; and the codes in the names of layers."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Self

from maulstick.drawing.shapes import Group, Shape
from maulstick.painting.painting import hex_colour
from maulstick.recording.files.css import Rgb

_BLACK: Rgb = (0.0, 0.0, 0.0)
_WHITE: Rgb = (1.0, 1.0, 1.0)  # the paper's: hatching it shows nothing
_MOST_GROUPS = 16  # that are taken for pens: nobody changes pens more often, where no layer asks for it
_LABEL = re.compile(r"\s*(!?)\s*(\d{0,9})((?:\s*\+[a-z]\s*\d{1,9})*)(.*)", re.IGNORECASE | re.DOTALL)
_CODE = re.compile(r"\+([a-z])\s*(\d{1,9})", re.IGNORECASE)
_SLOWEST, _FASTEST = 1, 100  # per cent of speed: AxiDraw's own range


@dataclass(frozen=True)
class LayerName:
    """Name of a layer, taken apart at AxiDraw's codes (https://wiki.evilmadscientist.com/AxiDraw_Layer_Control).

    number: by which layers are drawn in order, None where there is none.  pauses: whether a ``!`` asks for a pause.
    speed: share of the plotter's highest, in per cent.  delay: seconds before the layer.  height: whether the height
    of the pen is given.  name: what is left for people, with a number that is a part of its first word.
    """

    number: int | None = None
    pauses: bool = False
    speed: int | None = None
    delay: float = 0.0
    height: bool = False
    name: str | None = None

    @classmethod
    def of(cls, label: str | None) -> Self:
        """Take a label apart; one without codes is a name."""
        match = _LABEL.fullmatch(label or "")
        if match is None:
            return cls()
        codes = {letter.upper(): int(number) for letter, number in _CODE.findall(match[3])}
        speed = codes.get("S")
        is_word = not match[3] and not match[4][:1].isspace()  # as in 0.5 mm and 2B, which the number is a part of
        said = match[2] + match[4] if is_word else match[4]
        plain = "".join(each if each.isprintable() else " " for each in said).strip()
        return cls(
            number=int(match[2]) if match[2] else None,
            pauses=bool(match[1]),
            speed=None if speed is None else min(max(speed, _SLOWEST), _FASTEST),
            delay=codes.get("D", 0) * 1e-3,
            height="H" in codes,
            name=plain or match[2] or None,
        )


@dataclass(eq=False)
class Pen:
    """Pen: its colour (sRGB in [0, 1]), the layer it draws, and the indices of its shapes.

    is_own: whether that layer is one that a painting was written as.
    filled: indices of the shapes whose fill it hatches.
    """

    colour: Rgb
    layer: LayerName
    is_own: bool
    drawn: list[int] = field(default_factory=list)
    filled: list[int] = field(default_factory=list)

    @property
    def name(self) -> str | None:
        """Name of the layer without what a painting's own layers have after theirs: the colour, and the brush."""
        if self.layer.name is None or not self.is_own:
            return self.layer.name
        name, has_colour, _ = f" {self.layer.name} ".rpartition(f" {hex_colour(self.colour)} ")
        return name.strip() or None if has_colour else self.layer.name


def pens_of(shapes: Sequence[Shape], hatches: bool) -> list[Pen]:
    """Return the pens of the shapes in the order of drawing: by the layers' numbers, then by first appearance.

    hatches: whether fills are drawn: in a layer, a fill of another colour than the layer's lines has a pen of its own.
    """
    by_group = _are_pens([shape.group for shape in shapes])
    inks = [shape.stroke or shape.fill or _BLACK for shape in shapes]
    if by_group:
        inks = _common([shape.group for shape in shapes], inks)
    layers: dict[Group | None, LayerName] = {}
    pens: dict[tuple[Group | None, Rgb], Pen] = {}
    for index, (shape, ink) in enumerate(zip(shapes, inks, strict=True)):
        group = shape.group if by_group else None
        layer = layers.setdefault(group, LayerName.of(None if group is None else group.label))
        is_own = group is not None and group.is_own
        if hatches and shape.fill is not None and shape.fill != _WHITE:
            pens.setdefault((group, shape.fill), Pen(shape.fill, layer, is_own)).filled.append(index)
        pens.setdefault((group, ink), Pen(ink, layer, is_own)).drawn.append(index)
    return sorted(pens.values(), key=lambda pen: (pen.layer.number is None, pen.layer.number or 0))


def _are_pens(groups: Sequence[Group | None]) -> bool:
    """Return whether groups are pens: where there are layers, or a few groups that have names."""
    found = [group for group in set(groups) if group is not None]
    named = [group for group in found if group.label is not None]
    return any(group.is_layer for group in found) or 1 < len(named) == len(found) <= _MOST_GROUPS


def _common(groups: Sequence[Group | None], inks: Sequence[Rgb]) -> list[Rgb]:
    """Return for each shape the ink that most shapes of its group have."""
    counts: dict[Group | None, Counter[Rgb]] = {}
    for group, ink in zip(groups, inks, strict=True):
        counts.setdefault(group, Counter())[ink] += 1
    common = {group: count.most_common(1)[0][0] for group, count in counts.items()}
    return [common[group] for group in groups]
