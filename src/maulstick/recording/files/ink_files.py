"""Files of ink that other programs write; the format is recognised by the content."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from defusedxml import DefusedXmlException  # type: ignore[import-untyped]

from maulstick.errors import InputError, Remedy
from maulstick.recording.files.inkml import read_inkml
from maulstick.recording.files.page import LONGEST, Page, on_sheet
from maulstick.recording.files.pointer_events import read_pointer_events
from maulstick.recording.files.svg_ink import read_svg
from maulstick.recording.files.wacom import read_uim, read_will
from maulstick.recording.mocap.take import KIND as TAKE
from maulstick.storage.arrays import kind_of
from maulstick.storage.files import file_to_read, read_whole
from maulstick.storage.text import counted
from maulstick.strokes.ink import Ink

FORMATS = "InkML, SVG, Wacom's UIM and WILL 2, and JSON of pointer events"
"""Formats that can be read, for people."""

_LARGEST = 64 * 2**20  # bytes: no drawing is larger, and parsers need many times that in memory
_UNTOLD = (
    AttributeError,
    IndexError,
    KeyError,
    TypeError,
)  # of parsers that stumble: their texts say nothing of a drawing
_COMMENT = re.compile(rb"<!--.*?(?:-->|$)", re.DOTALL)
_START = 64 * 2**10  # bytes in which the outermost element of XML must begin


def read_ink_file(
    path: str | Path,
    size: tuple[float, float] | None = None,
    longest: float | None = None,
    note: Callable[[str], None] = lambda _: None,
    remedy: str = "",
) -> tuple[Ink, str]:
    """Return the ink in a file of one of the `FORMATS`, and the name of its format.

    size, longest: metres, see `page.on_sheet`.  note: is told a sentence for people where the scale is not known, which
    ends in the remedy, and where data is faulty.
    Raises InputError where the file is of another format, or damaged.
    """
    path = file_to_read(path, "drawing")
    if (kind := kind_of(path)) is not None:
        if kind == TAKE:
            raise InputError(f"{path} holds a take", Remedy.READ_TAKE)
        raise InputError(f"{path} holds {kind} already; there is nothing to record; look at it with maulstick show")
    content = read_whole(path, "drawing", _LARGEST)
    name, reader = _reader(content, path)
    try:
        with np.errstate(all="ignore"):  # `on_sheet` refuses infinite and very large numbers with a message
            page = reader(content)
            ink = on_sheet(page, size, longest, path.name)
    except DefusedXmlException as error:
        raise InputError(f"cannot read {path} as {name}: it declares entities; save it as plain {name}") from error
    except RecursionError as error:
        raise InputError(f"cannot read {path} as {name}: it is nested too deeply, or refers to itself") from error
    except Exception as error:  # the parsers raise nearly anything
        said = "" if isinstance(error, _UNTOLD) else " ".join(str(error).split())
        fault = said or f"it is damaged; save it again as plain {name}"
        raise InputError(f"cannot read {path} as {name}: {fault[:200]}") from error
    if page.unit is None and size is None and longest is None:
        note(
            f"{path.name} does not say how large it was drawn: its longer side is taken to be {LONGEST * 1e3:g} mm"
            + remedy
        )
    if page.faulty:
        note(f"{counted(page.faulty, 'path')} of {path.name} with faulty data: drawn up to the fault")
    return ink, page.kind


def _reader(content: bytes, path: Path) -> tuple[str, Callable[[bytes], Page]]:
    start = content[:_START].removeprefix(b"\xef\xbb\xbf").lstrip()
    if content[:4] == b"RIFF" and content[8:12] == b"UINK":
        return "UIM", read_uim
    if content[:4] == b"PK\x03\x04":
        return "WILL", read_will
    if content[:2] == b"\x1f\x8b":
        raise InputError(f"{path} is compressed, as an SVG may be; save it as plain SVG")
    if start[:1] == b"{":
        return "pointer events", read_pointer_events
    told = _COMMENT.sub(b"", start.replace(b"\0", b""))  # UTF-16 is ASCII with zeros
    outermost = re.search(rb"<(?:[\w.-]+:)?(svg|ink)[\s/>]", told)
    if outermost is not None:
        return ("SVG", read_svg) if outermost[1] == b"svg" else ("InkML", read_inkml)
    raise InputError(f"{path} is none of the drawings that can be read; there are: {FORMATS}")
