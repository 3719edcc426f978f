"""Pictures of a plan: the first one, a larger one, and one for each time that a run planned the rest of it again."""

import re
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Final

from PIL import Image

from maulstick.storage.files import atomic_write

if TYPE_CHECKING:
    from maulstick.painting.painting import Painting

FIRST: Final = "preview.png"
"""Name of the picture of a plan as it was planned."""

LARGE: Final = "large.png"
"""Name of the larger picture of a plan, which is made once somebody looks closely."""

AGAIN: Final = re.compile(r"painting\.r([0-9]{1,6})\.plan\.png")
"""Name of the picture of a plan whose rest was planned again."""

_LONGEST_PX = 1280  # longest side of a picture that a page shows
_LARGE_PX = 3072  # longest side of the larger one: three times that of the first one
_MOST_PAINTED_PX = 2e8  # pixels that all strokes of it cover together, one over the other: some 20 s


def plan_picture(painting: Path) -> Path:
    """Return the picture of the plan or the drawing in that file as a machine now paints it, existing or not."""
    files = painting.parent.glob("painting.r*.plan.png")
    again = {int(found[1]): file for file in files if (found := AGAIN.fullmatch(file.name))}
    return again[max(again)] if again else painting.with_name(FIRST)


def rehearsed_sheet(painting: Path) -> Path:
    """Return the picture of the simulated easel's sheet after a rehearsal of that file, existing or not."""
    return painting.with_name(f"{painting.stem}-painted.png")


def keep_plan_picture(painting: "Painting", photograph: Path) -> None:
    """Write the picture of a painting whose rest was planned again by that photograph, beside it."""
    from maulstick.painting.picture import encode_png
    from maulstick.rendering.preview import preview_of_height  # loads torch, as planning did

    size = painting.sheet.width, painting.sheet.height
    picture = preview_of_height(painting, max(1, round(_LONGEST_PX * size[1] / max(size))))
    atomic_write(photograph.with_suffix(".plan.png"), encode_png(picture))


def keep_large_picture(folder: Path) -> bool:
    """Write the larger picture of the plan in its folder, unless it is there; return whether there is one now.

    There is none of a plan whose strokes would take too long to draw so large. Raises OutputError where no room is.
    """
    from maulstick.painting.painting_file import read_painting
    from maulstick.painting.picture import encode_png
    from maulstick.rendering.preview import preview_of_height  # loads torch

    first, large, file = folder / FIRST, folder / LARGE, folder / "painting.json"
    if large.is_file() and large.stat().st_mtime_ns >= file.stat().st_mtime_ns:
        return True
    painting = read_painting(file)
    metres = zip(painting.metres_of_paints().tolist(), painting.paints, strict=True)
    painted = sum(length * 2 * painting.brushes[paint.brush].widest for length, paint in metres)  # square metres
    per_metre = _LARGE_PX / max(painting.sheet.width, painting.sheet.height)
    if painted:
        per_metre = min(per_metre, sqrt(_MOST_PAINTED_PX / painted))
    height = int(per_metre * painting.sheet.height)
    with Image.open(first) as picture:
        if height <= picture.height:
            return False
    atomic_write(large, encode_png(preview_of_height(painting, height)))
    return True
