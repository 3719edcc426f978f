"""Reading an SVG's XML, safely, and the lengths in it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self
from xml.etree.ElementTree import Element, ParseError

from defusedxml import DefusedXmlException  # type: ignore[import-untyped]
from svgelements import Matrix  # type: ignore[import-untyped]

from maulstick.errors import InputError
from maulstick.recording.files.css import Style
from maulstick.recording.files.lengths import Viewport, page_side
from maulstick.recording.files.markup import parsed
from maulstick.recording.files.svg_paths import PAGE, view_box, viewed
from maulstick.recording.files.transforms import transform_of

SVG_SPACE: Final = "http://www.w3.org/2000/svg"
INKSCAPE: Final = "{http://www.inkscape.org/namespaces/inkscape}"

NO_PLACE: Final = "a point in it has no place: it is no number, or too large; mend or delete that path"
"""Fault of a drawing whose numbers are damaged."""

_SMALLEST, _LARGEST = 1e-2, 1e7  # pixels of a page's side: above the micrometre that lengths are rounded to; 2.6 km


def parsed_svg(content: bytes, path: Path) -> Element:
    """Return the outermost element of an SVG.

    Raises InputError where it is none, is compressed, or declares entities, which could grow without bound.
    """
    if content[:2] == b"\x1f\x8b":
        raise InputError(f"{path} is a compressed SVG; save it as plain SVG")
    try:
        return parsed(content, "svg")
    except DefusedXmlException as error:
        raise InputError(f"{path} declares entities, which may hide anything; save it as plain SVG") from error
    except InputError as error:
        raise InputError(f"{path} is not an SVG: {error}") from error
    except (ParseError, ValueError, LookupError) as error:
        raise InputError(f"{path} is not an SVG that can be read: {error}; save it again as plain SVG") from error


@dataclass(frozen=True)
class Page:
    """Page of a drawing.

    width, height: pixels, 96 per inch.  matrix: from the outermost user units to these pixels.
    viewport: what percentages on it are taken of.  said: whether the file says how large it is.
    """

    width: float
    height: float
    matrix: Matrix
    viewport: Viewport
    said: bool

    @classmethod
    def of(cls, root: Element, style: Style) -> Self:
        """Return the page of a document, whose outermost element has a style.

        A side that is a percentage, or left out, is that of the viewBox in pixels.
        """
        view = view_box(root)
        width, height = (page_side(style.get(name)) or page_side(root.get(name)) for name in ("width", "height"))
        said = view is not None or (width is not None and height is not None)
        if view is not None:
            if width is None and height is None:
                width, height = view[2:]
            width = view[2] * (height or 0) / view[3] if width is None else width
            height = view[3] * width / view[2] if height is None else height
        width, height = (PAGE if side is None else side for side in (width, height))
        if not all(_SMALLEST <= side <= _LARGEST for side in (width, height)):
            sides = f"a width and a height from {_SMALLEST:g} to {_LARGEST:g}"
            raise InputError(f"its page is {width:g} x {height:g} pixels; give it {sides}")
        matrix, viewport = viewed(root, (0.0, 0.0, width, height))
        moved = transform_of(style, width, height, "center")
        return cls(width, height, matrix * moved, viewport, said)
