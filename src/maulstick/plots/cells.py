"""Contact sheet: many paintings in rows, each with its name below."""

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from maulstick.errors import InputError
from maulstick.plots.sheet import FAINT, INK, QUIET, TABLE

_LONGEST_PX = 16_000  # side of a sheet: what most programs open
_LARGEST_PX, _SMALLEST_PX = 320, 24  # side of one painting
_TEXT, _GAP = 15, 12  # pixels: height of a name, and between two paintings


@dataclass(frozen=True)
class Print:
    """One painting on the sheet. picture: a PNG; None where there is none.  lines: two, of text below it."""

    picture: Path | None
    lines: tuple[str, str]


def contact_sheet(prints: Sequence[Print], columns: int) -> bytes:
    """Draw a PNG of the paintings, so many beside each other. Raises InputError for a file that is damaged."""
    rows = ceil(len(prints) / columns)
    foot = 2 * (_TEXT + 3) + _GAP
    most = min(_LARGEST_PX, _LONGEST_PX // columns - _GAP, _LONGEST_PX // rows - foot)
    wide = max(most, _SMALLEST_PX)
    high = ceil(wide * _tallest(prints))
    sheet = Image.new("RGB", (columns * (wide + _GAP) + _GAP, rows * (high + foot) + _GAP), TABLE)
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(_TEXT)
    for number, each in enumerate(prints):
        x, y = _GAP + number % columns * (wide + _GAP), _GAP + number // columns * (high + foot)
        if each.picture is None:
            draw.rectangle((x, y, x + wide - 1, y + high - 1), outline=FAINT)
        else:
            with _opened(each.picture) as picture:
                picture.thumbnail((wide, high))
                sheet.paste(picture.convert("RGB"), (x + (wide - picture.width) // 2, y + (high - picture.height) // 2))
        for line, (text, colour) in enumerate(zip(each.lines, (INK, QUIET), strict=True)):
            draw.text((x, y + high + 4 + line * (_TEXT + 3)), _fitted(text, font, wide), fill=colour, font=font)
    file = io.BytesIO()
    sheet.save(file, format="PNG")
    return file.getvalue()


@contextmanager
def _opened(path: Path) -> Iterator[Image.Image]:
    try:
        with Image.open(path) as picture:
            yield picture
    except (OSError, SyntaxError) as error:  # as Pillow calls a broken PNG
        raise InputError(f"the picture {path} is damaged; remove that file, and sweep again") from error


def _tallest(prints: Sequence[Print]) -> float:
    """Return the largest height over width, at most 1."""
    ratios = []
    for each in prints:
        if each.picture is not None:
            with _opened(each.picture) as picture:
                ratios.append(picture.height / picture.width)
    return min(1.0, max(ratios, default=1.0))


def _fitted(text: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, room: float) -> str:
    """Return the beginning of a text that fits."""
    while text and font.getlength(text) > room:
        text = text.removesuffix("…")[:-1] + "…" if len(text) > 1 else ""
    return text
