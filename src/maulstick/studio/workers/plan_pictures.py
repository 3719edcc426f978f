"""Pictures of a plan: the first one, and one for each time that a run planned the rest of it again."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

from maulstick.storage.files import atomic_write

if TYPE_CHECKING:
    from maulstick.painting.painting import Painting

FIRST: Final = "preview.png"
"""Name of the picture of a plan as it was planned."""

AGAIN: Final = re.compile(r"painting\.r([0-9]{1,6})\.plan\.png")
"""Name of the picture of a plan whose rest was planned again."""

_LONGEST_PX = 1280  # longest side of a picture that a page shows


def plan_picture(painting: Path) -> Path:
    """Return the picture of the plan or the drawing in that file as a machine now paints it, existing or not."""
    files = painting.parent.glob("painting.r*.plan.png")
    again = {int(found[1]): file for file in files if (found := AGAIN.fullmatch(file.name))}
    return again[max(again)] if again else painting.with_name(FIRST)


def keep_plan_picture(painting: "Painting", photograph: Path) -> None:
    """Write the picture of a painting whose rest was planned again by that photograph, beside it."""
    from maulstick.painting.picture import encode_png
    from maulstick.rendering.preview import preview_of_height  # loads torch, as planning did

    size = painting.sheet.width, painting.sheet.height
    picture = preview_of_height(painting, max(1, round(_LONGEST_PX * size[1] / max(size))))
    atomic_write(photograph.with_suffix(".plan.png"), encode_png(picture))
