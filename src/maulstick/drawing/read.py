"""Reading of an SVG as a painting: a stroke per line, a paint per pen."""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from shapely.geometry.base import BaseGeometry

from maulstick.drawing.document import parsed_svg
from maulstick.drawing.hand import HatchingHand, hatched_by_hand
from maulstick.drawing.layout import Layout
from maulstick.drawing.lines import lengths
from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.order import in_quick_order, joined, without_repeats
from maulstick.drawing.pens import Pen, pens_of
from maulstick.drawing.placed import Placed
from maulstick.drawing.regions import hatched
from maulstick.drawing.shapes import Shape, Walk
from maulstick.errors import InputError, option
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.painting.svg import AXIDRAW_SPEED
from maulstick.recording.files.css import Rgb
from maulstick.recording.files.svg_paths import check_uses
from maulstick.storage.arrays import Floats
from maulstick.storage.files import read_whole

Read = TypeVar("Read")

_LARGEST_FILE = 64 * 2**20  # bytes: more than pens draw in a week
_LARGEST = 64 * 2**20  # characters, after every <use> is replaced
_HATCH_ANGLE = np.pi / 4  # radians
_PRESSURE = 0.5  # of a pen, whose pressure changes nothing
_WIDTHS = (5e-5, 2e-2)  # metres: of pens that there are


@dataclass(frozen=True)
class Drawing:
    """Drawing as it was read; notes: sentences about what of the file is not drawn as it says."""

    painting: Painting
    notes: tuple[str, ...] = ()


def read_drawing(path: str | Path, options: DrawingOptions | None = None, hand: HatchingHand | None = None) -> Drawing:
    """Read an SVG as a painting: a stroke per subpath, and a paint per layer, else per group, else per colour.

    hand: whose strokes hatch the fills, if they are to be hatched; by default lines do.
    Raises InputError where there is none, it has text or pictures, or nothing of it lies on the sheet.
    """
    options = options or DrawingOptions()
    options.check()
    return _read(Path(path), lambda walk: _drawing(walk, list(walk.shapes()), options, hand))


def read_fills(path: str | Path) -> tuple[list[tuple[Rgb, BaseGeometry]], tuple[float, float]]:
    """Return the fills of an SVG, as colours and where they lie, metres, the topmost last, and the size of its page.

    Raises InputError as `read_drawing` does.
    """

    def fills(walk: Walk) -> tuple[list[tuple[Rgb, BaseGeometry]], tuple[float, float]]:
        placed, size = _on_its_page(walk)
        return [(shape.fill, placed.filled(i)) for i, shape in enumerate(placed.shapes) if shape.fill is not None], size

    return _read(Path(path), fills)


def read_lines(path: str | Path) -> tuple[list[tuple[str | None, Rgb, Floats]], tuple[float, float]]:
    """Return the lines of an SVG, each with its layer's or group's name, its colour and its points (k, 2), metres.

    Beside them the size of the page. Raises InputError as `read_drawing` does.
    """

    def drawn(walk: Walk) -> tuple[list[tuple[str | None, Rgb, Floats]], tuple[float, float]]:
        placed, size = _on_its_page(walk)
        found = [
            (None if shape.group is None else shape.group.label, shape.stroke, line)
            for shape, lines in zip(placed.shapes, placed.lines, strict=True)
            if shape.stroke is not None
            for line in lines
        ]
        return found, size

    return _read(Path(path), drawn)


def _on_its_page(walk: Walk) -> tuple[Placed, tuple[float, float]]:
    """Return the shapes of an SVG as they lie on its own page, and the size of that, metres."""
    placed = Placed(list(walk.shapes()), Layout.of(walk.page, DrawingOptions()))
    return placed, (float(placed.layout.sheet[0]), float(placed.layout.sheet[1]))


def _read(path: Path, of: Callable[[Walk], Read]) -> Read:
    """Return what `of` makes of a walk through an SVG."""
    root = parsed_svg(read_whole(path, "drawing", _LARGEST_FILE), path)
    try:
        check_uses(root, _LARGEST)
        with np.errstate(all="ignore"):  # what is not finite is refused with a message
            return of(Walk(root))
    except RecursionError as error:
        raise InputError(f"cannot draw {path}: it is nested too deeply, or refers to itself") from error
    except InputError as error:
        raise InputError(f"cannot draw {path}: {error.fault}", error.remedy, **error.values) from error


def _drawing(walk: Walk, shapes: Sequence[Shape], options: DrawingOptions, hand: HatchingHand | None) -> Drawing:
    if not shapes:
        raise InputError("there is no path or shape in it that can be seen; draw one, or show its layers")
    placed = Placed(shapes, Layout.of(walk.page, options))
    if options.margin is not None and (drawn := [line for lines in placed.lines for line in lines]):
        placed = Placed(shapes, placed.layout.fitted(drawn, options.margin))
    pens = pens_of(shapes, options.hatch is not None)
    hatch = _hatching(options, hand)
    wanted = [_lines(pen, placed, hatch) for pen in pens]
    lines = [placed.on_sheet(each) for each in wanted]
    sheet = Sheet(width=placed.layout.sheet[0], height=placed.layout.sheet[1])
    if not any(lines):
        told = f"{option('margin')} 0 scales it to the sheet"
        raise InputError(f"nothing of it lies on its sheet of {sheet.millimetres}; {told}")
    if options.no_repeats:
        lines = [without_repeats(each) for each in lines]
    if options.join:
        lines = [joined(each, options.join) for each in lines]
    if options.shortest:
        lines = [_without_specks(each, options.shortest) for each in lines]
        if not any(lines):
            raise InputError(
                f"all of it is shorter than {1e3 * options.shortest:g} mm; {option('shortest')} must be less"
            )
    if not options.keep_order:
        lines = _in_quick_order(lines)
    painting = _painting(pens, lines, sheet, _brush(placed), options)
    return Drawing(painting, tuple(_notes(walk, pens, placed, sheet)))


def _hatching(options: DrawingOptions, hand: HatchingHand | None) -> Callable[[BaseGeometry], list[Floats]]:
    """Return what hatches a region: lines, or a hand, in its own direction unless an angle is asked for."""
    spacing, angle = options.hatch or 0.0, options.hatch_angle
    if hand is None:
        return partial(hatched, spacing=spacing, angle=_HATCH_ANGLE if angle is None else angle)
    level, rng = hand.levelled(), np.random.default_rng(0)
    angle = next(each for each in (angle, hand.angle, _HATCH_ANGLE) if each is not None)
    return partial(hatched_by_hand, level, spacing=spacing, angle=angle, rng=rng)


def _lines(pen: Pen, placed: Placed, hatch: Callable[[BaseGeometry], list[Floats]]) -> list[Floats]:
    """Return the lines of a pen, (k, 2) metres: the hatches of its fills, and its outlines."""
    hatches = [line for i in pen.filled for line in hatch(placed.filled(i))]
    return hatches + [line for i in pen.drawn for line in placed.lines[i]]


def _without_specks(lines: Sequence[Floats], shortest: float) -> list[Floats]:
    return [line for line, length in zip(lines, lengths(lines), strict=True) if length >= shortest]


def _in_quick_order(lines: Sequence[list[Floats]]) -> list[list[Floats]]:
    """Return the lines of each pen in a quick order, from where the pen before them ended."""
    place = (0.0, 0.0)
    ordered = []
    for each in lines:
        ordered.append(in_quick_order(each, place))
        if each:
            place = tuple(ordered[-1][-1][-1].tolist())
    return ordered


def _brush(placed: Placed) -> Brush:
    """Return a fineliner as wide as most of the lines are."""
    usual, scale = load_brush("fineliner"), placed.layout.scale
    drawn: defaultdict[float, float] = defaultdict(float)
    for shape, lines in zip(placed.shapes, placed.lines, strict=True):
        if shape.stroke is not None and lines:
            drawn[round(shape.width * scale, 5)] += float(lengths(lines).sum())
    width = max(drawn, key=lambda each: drawn[each], default=0.0)
    if width <= 0:
        return usual
    width = min(max(width, _WIDTHS[0]), _WIDTHS[1])
    named = {"name": f"fineliner {1e3 * width:g} mm", "source": "the drawing's lines", "beta": width / 2}
    return Brush.model_validate({**usual.model_dump(), **named})


def _painting(
    pens: Sequence[Pen], lines: Sequence[list[Floats]], sheet: Sheet, brush: Brush, options: DrawingOptions
) -> Painting:
    used = [(pen, each) for pen, each in zip(pens, lines, strict=True) if each]
    strokes: list[Stroke] = []
    for index, (pen, each) in enumerate(used):
        percent = pen.layer.speed
        for line in each:
            speed = None if percent is None else (percent / 100 * AXIDRAW_SPEED,) * len(line)
            points = tuple((x, y, _PRESSURE) for x, y in line.tolist())
            strokes.append(Stroke(id=len(strokes), paint=index, trajectory=points, speed=speed))
    said: dict[str, Any] = options.model_dump(mode="json", exclude_defaults=True)
    return Painting(
        sheet=sheet,
        provenance=Provenance(version=version("maulstick"), options=said),
        brushes={brush.name: brush},
        paints=tuple(Paint(colour=pen.colour, brush=brush.name, name=pen.name) for pen, _ in used),
        strokes=tuple(strokes),
        literal=True,
    )


def _notes(walk: Walk, pens: Sequence[Pen], placed: Placed, sheet: Sheet) -> list[str]:
    notes = []
    if not walk.page.said:
        notes.append(f"the file does not say how large its page is; it is drawn on {sheet.millimetres}")
    if placed.cropped:
        notes.append(f"lines that reach beyond the sheet of {sheet.millimetres} are cut at its edges: {placed.cropped}")
    if walk.faulty:
        notes.append(f"paths with faulty data are drawn up to the fault: {walk.faulty}")
    if walk.passed_over:
        notes.append(f"passed over: {', '.join(sorted(walk.passed_over))}")
    if walk.unread is not None:
        read = "#rrggbb, rgb(), hsl(), hwb() and names"
        notes.append(f"the colour {walk.unread[:60]!r} is taken for black, as all are but {read}; write it as #rrggbb")
    if walk.sheet.unread is not None:
        rule, read = f"rule for {walk.sheet.unread[:60]!r}", "names, classes and ids, with > or a space between,"
        notes.append(f"a style sheet's {rule} is left out: only {read} are read; give its elements a class")
    if any(pen.layer.height for pen in pens):
        notes.append("+H in the names of layers is passed over: the pen is lifted and lowered as the machine is set up")
    if len(pens) == 1 and pens[0].layer.pauses:
        notes.append("! in the name of a layer that is alone is passed over: there is no pen to change")
    if any(pen.layer.delay for pen in pens):
        notes.append("+D in the names of layers is passed over: the change of pen waits for you anyway")
    return notes
