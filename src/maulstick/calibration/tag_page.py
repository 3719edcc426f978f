"""A page with the tags, to print at their true size."""

import io
from math import ceil
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from maulstick.errors import InputError
from maulstick.robot.camera.tag_frame import TAGS, TagFrame
from maulstick.storage.files import atomic_write

_DPI = 600  # dots per inch, as most printers have
_PIXELS_PER_METRE = _DPI / 25.4e-3
_WHITE_EDGE = 8e-3  # metres that printers leave white
_LINE = 4e-3  # metres from one line of text to the next
_CUT = 160  # grey of the lines to cut along
_PLACES = ("upper left", "upper right", "lower right", "lower left")
_FORMATS = {".png": "PNG", ".pdf": "PDF"}
_BETWEEN = 6e-3  # metres between cards
_LARGEST = 1.2  # metres: the longer side of A0; a page is held in memory dot by dot, and A0 is 560 MB


def write_tag_page(path: str | Path, frame: TagFrame, paper: tuple[float, float] = (0.210, 0.297)) -> None:
    """Write the page of `tag_page` as a PNG or PDF that prints at its true size.

    Raises InputError for another ending, or where the cards do not fit, and OutputError where it cannot be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in _FORMATS:
        raise InputError.of_choice("kind of page", ending or str(path), _FORMATS)
    file = io.BytesIO()
    tag_page(frame, paper).save(file, format=_FORMATS[ending], dpi=(_DPI, _DPI), resolution=_DPI)
    atomic_write(path, file.getvalue())


def tag_page(frame: TagFrame, paper: tuple[float, float] = (0.210, 0.297)) -> Image.Image:
    """Draw the tags on one sheet of paper (width, height), metres, at 600 dots per inch.

    They are in their places around the outline of the sheet, where that fits; otherwise on four cards to cut out.
    Raises InputError where not even those fit, and for paper larger than A0.
    """
    came = f"{1e3 * paper[0]:g} x {1e3 * paper[1]:g} mm"
    if max(paper) > _LARGEST:
        raise InputError.of_range("the paper to print on", came, f"at most {1e3 * _LARGEST:g} mm a side")
    page = Image.new("L", (_dots(paper[0]), _dots(paper[1])), 255)
    draw = ImageDraw.Draw(page)
    size = 1e3 * frame.side
    text = [f"Print at 100 %, not fitted to the page: each black square must measure {size:g} mm."]
    whole = (frame.width + 2 * frame.card, frame.height + 2 * frame.card)
    room = (paper[0] - 2 * _WHITE_EDGE, paper[1] - 2 * _WHITE_EDGE)
    if _fits(whole, (room[0], room[1] - 6 * _LINE)):
        text.append("Lay the sheet on the outline.")
        origin = ((paper[0] - frame.width) / 2, (paper[1] - frame.height) / 2)
        outline = (*origin, origin[0] + frame.width, origin[1] + frame.height)
        draw.rectangle([_dots(x) for x in outline], outline=_CUT, width=5)
        corners = [tuple(frame.card_corners(tag)[0] + origin) for tag in TAGS]
    elif _fits(cards := (2 * frame.card + _BETWEEN, 2 * frame.card + _BETWEEN + 6 * _LINE), room):
        text.append("Cut along the grey lines. Put each card where it says and fix it to the table, not to the sheet:")
        text.append("the corner with the dot touches the sheet's corner, and the card's edges go on from the sheet's.")
        top = _WHITE_EDGE + (len(text) + 1) * _LINE
        step = frame.card + _BETWEEN
        corners = [(_WHITE_EDGE + x * step, top + y * step) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    else:
        width, height = (ceil(1e3 * (side + 2 * _WHITE_EDGE)) for side in cards)
        allowed = f"at least {width} x {height} mm, or the tags smaller"
        raise InputError.of_range("the paper to print on", came, allowed)
    for tag, corner in zip(TAGS, corners, strict=True):
        _draw_card(page, frame, tag, corner)
    font = _font(text, room[0])
    for line, sentence in enumerate(text):
        draw.text((_dots(_WHITE_EDGE), _dots(_WHITE_EDGE + line * _LINE)), sentence, fill=0, font=font)
    return page


def _draw_card(page: Image.Image, frame: TagFrame, tag: int, corner: tuple[float, float]) -> None:
    """Draw a card: its tag and outline, a dot at the sheet's corner, and its number and place in the gap."""
    picture = Image.fromarray(frame.card_picture(tag, _PIXELS_PER_METRE))
    at = (_dots(corner[0]), _dots(corner[1]))
    page.paste(picture, at)
    draw = ImageDraw.Draw(page)
    side = picture.width
    draw.rectangle((*at, at[0] + side, at[1] + side), outline=_CUT, width=3)
    x, y = at[0] + side * (tag in (0, 3)), at[1] + side * (tag in (0, 1))
    dot = _dots(0.8e-3)
    draw.ellipse((x - dot, y - dot, x + dot, y + dot), fill=0)
    font = ImageFont.load_default(_dots(min(0.6 * _LINE, frame.gap / 3)))
    middle = at[1] + side * (tag in (0, 1)) + _dots(frame.gap / 2) * (-1 if tag in (0, 1) else 1)
    draw.text((at[0] + side // 2, middle), f"{tag}  {_PLACES[tag]}", fill=0, font=font, anchor="mm")


def _font(lines: list[str], room: float) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """Return the font of lines of text, smaller than usual where the longest is wider than the room, metres."""
    size = _dots(0.7 * _LINE)
    longest = max(ImageFont.load_default(size).getlength(line) for line in lines)
    return ImageFont.load_default(size * min(1.0, _dots(room) / longest))


def _fits(size: tuple[float, float], room: tuple[float, float]) -> bool:
    return size[0] <= room[0] and size[1] <= room[1]


def _dots(metres: float) -> int:
    return round(metres * _PIXELS_PER_METRE)
