"""Planning, rendering and comparing paintings from Python."""

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image as Pillow

from maulstick.api.painting import Painting, read_painting
from maulstick.api.usual_torch import in_usual_torch
from maulstick.api.warning import warn
from maulstick.errors import InputError
from maulstick.jobs.plan.again import Again
from maulstick.jobs.plan.before import notes_on_files, picture_near, planned_before
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.request import PlanRequest
from maulstick.jobs.plan.results import notes_on
from maulstick.kinds import check_names, checked
from maulstick.painting import painting as records
from maulstick.painting.brush import Brush, in_painting_order, load_brush, names_of
from maulstick.painting.edit import PictureEdit
from maulstick.painting.metrics import Metrics
from maulstick.painting.picture import READ_PX, Picture, image_of
from maulstick.planning.result import PlanProgress
from maulstick.rendering.likeness import likeness
from maulstick.rendering.preview import preview_of_height
from maulstick.style import Style

Progress = Callable[[PlanProgress], bool | None]

_NAMES = {each.name for each in fields(PlanOptions)}


@checked
@in_usual_torch
def plan(
    picture: Picture | None = None,
    *,
    style: str | Path | Style | None = None,
    brush: str | Path | Brush | Sequence[str | Path | Brush] | None = None,
    again: records.Painting | str | Path | None = None,
    options: PlanOptions | None = None,
    progress: Progress | None = None,
    workers: int | None = None,
    **changes: Any,
) -> Painting:
    """Plan a painting of a picture, or of the `text` among the options.

    picture: a path, a Pillow image, or an array (H, W, 3) or (H, W), uint8 or float in [0, 1], sRGB.
    style, brush: names, paths of JSON files, or what `load_style`, `fit_style` and `load_brush` return. Several brushes
    paint one after another in colours, the broadest first.
    again: a painting, or the path of its painting.json, whose locked strokes, sheet and paints stay as they are; its
    other strokes are planned on from where they are, with its options and, by a path, its picture. By a path and with a
    `background`, the strokes that its journal says are painted are left out.
    options: defaults for everything else; changes: fields of `PlanOptions` that differ from them.
    progress: called after every step with a `PlanProgress` (done in [0, 1], loss, parts of the loss by name, canvas
    (3, H, W)); once it returns False, planning finishes what it has in some sixty steps.
    workers: processes that plan windows of a large canvas at the same time, by default one per core and 32 at
    most; `progress` then hears of each every two seconds, and the plan is the same with any number.

    Raises InputError for a picture, an option or a file that cannot be used. Warns of what may be other than expected,
    as of a sheet that is larger than the machine of `robot` reaches.

        >>> painting = plan(demo_picture, style="hatching", brush="marker", paints=1, strokes=5, steps=2, px=16)
        >>> len(painting.paints)
        1
    """
    check_names(changes, _NAMES)
    if style is not None:
        changes["style"] = style.name if isinstance(style, Style) else str(style)
    if again is None and options is not None:
        again = options.again
    background = changes.get("background", options.background if options else None)
    before = None if again is None else _before(again, background)
    brushes: tuple[Brush, ...] = ()
    if isinstance(brush, str | Path):
        changes["brush"] = str(brush)
    elif brush is not None:
        own = {} if before is None else before.painting.brushes
        several = [brush] if isinstance(brush, Brush) else brush
        brushes = in_painting_order(
            each if isinstance(each, Brush) else own.get(str(each)) or load_brush(each) for each in several
        )
        changes["brush"] = names_of(brushes)
    path = Path(picture) if isinstance(picture, str | Path) else None
    if before is not None:
        options, changes = options or planned_before(before.painting, changes), changes if options else {}
        if picture is None and isinstance(again, str | Path):
            picture = path = picture_near(before.painting, Path(again))
    if picture is None and changes.get("text") is None and (options is None or options.text is None):
        raise InputError("there is nothing to paint; give a picture, or a text")
    asked = replace(options or PlanOptions(), **changes)
    image = None if picture is None or path is not None else image_of(picture, asked.read_px, asked.least_px)
    prepared = prepare(
        PlanRequest(path, asked, workers=workers),
        image,
        brushes=brushes,
        style=style if isinstance(style, Style) else None,
        again=before,
    )
    for note in (*prepared.notes, *(() if before is None else notes_on_files(before.painting, asked))):
        warn(note)

    def watch(step: PlanProgress) -> bool:
        return progress is None or progress(step) is not False

    painting = Painting.of(prepared.painting(prepared.plan(watch, None)))
    for note in notes_on(painting):
        warn(note)
    return painting


@checked
@in_usual_torch
def render(painting: records.Painting | str | Path, px: int = 1024) -> Pillow.Image:
    """Draw a painting, or the painting.json or SVG at a path, as a Pillow image (RGB) that is `px` pixels high.

    Raises InputError where there is no painting, or a side of the image would be longer than 8192 pixels. Warns of what
    of an SVG is not drawn as it says.

        >>> render(painting, px=64).size
        (80, 64)
    """
    pixels = preview_of_height(_read(painting), px)
    return Pillow.fromarray(np.round(255 * pixels).astype(np.uint8))


@checked
@in_usual_torch
def compare(painting: records.Painting | str | Path, picture: Picture) -> Metrics:
    """Measure how near a painting, or the painting.json at a path, comes to a picture, over the picture's area.

    Returns `Metrics`: mse, psnr in dB, ssim, and the mse after a blur of 4 pixels, of the sheet 512 pixels high, each
    the mean of 4 by 4 finer ones.
    Raises InputError where the painting or the picture cannot be used.

        >>> 0 < compare(painting, demo_picture).psnr < 100
        True
    """
    compared = _read(painting)
    edit = PictureEdit.of(compared.provenance.options)
    return likeness(compared, image_of(picture, longest_px=edit.read_px(READ_PX)))


def _before(again: records.Painting | str | Path, background: str | Path | None) -> Again:
    if isinstance(again, records.Painting) or background is None:
        return Again(_read(again))
    return Again.on_paper(Path(again))


def _read(painting: records.Painting | str | Path) -> records.Painting:
    return painting if isinstance(painting, records.Painting) else read_painting(painting)
