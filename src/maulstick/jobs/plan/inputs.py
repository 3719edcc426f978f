"""Inputs of a plan: the picture, the sheet, brushes, settings and the network that options ask for."""

import numpy as np

from maulstick.colour.palette import parse_colour
from maulstick.colour.tubes import NamedPaint
from maulstick.errors import InputError, option
from maulstick.jobs.plan.options import AUTO, MOST_AUTO, PlanOptions, no_ink_to_count
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.brush import Brush
from maulstick.painting.edit import NO_EDIT
from maulstick.painting.painting import Sheet, hex_colour
from maulstick.painting.picture import canvas_photograph, encode_png, read_picture
from maulstick.painting.raster import Canvas, parse_sheet
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.layout import LONGEST_PX, canvas_for
from maulstick.planning.mural.windows import Mural
from maulstick.planning.problem import Colour, PlannerSettings
from maulstick.planning.tones import InkSupply
from maulstick.storage.arrays import Image
from maulstick.storage.text import counted

SHEET_PX = 1024
"""Pixels over the height of a sheet's photograph, and of the picture of a look: finer than plans need."""

_WIDEST_SHEET_PX = 2048  # over its width, for sheets that are much wider than high


def picture_of(request: PlanRequest, image: Image | None) -> Image | None:
    """Return the picture as the options correct it, or None where there is only a text."""
    options = request.options
    picture = image
    if request.picture is not None:
        picture = read_picture(request.picture, options.read_px, options.least_px)
    if picture is not None:
        return options.edit.applied(picture)
    for name, value in vars(options.edit).items():
        if value != getattr(NO_EDIT, name):
            raise InputError(f"{option(name)} corrects a picture, and there is none; name one, or leave it out")
    return None


def held(brush: Brush, options: PlanOptions) -> Brush:
    """Return the brush, held where the options or their machine say so. Raises InputError where it leaves no mark."""
    pressure = options.held_pressure
    if pressure is None or (options.pressure is None and not brush.pressure_matters):
        return brush
    return brush.held_at(pressure)


def mural_of(options: PlanOptions, picture: Image | None, sheet: Sheet, brush: Brush, margin: float) -> Mural | None:
    """Return the mural of a canvas that is too large to be planned in one piece, or None."""
    canvas = canvas_for(picture, sheet, brush, options.fit, options.px, margin)
    if max(canvas.width_px, canvas.height_px) <= LONGEST_PX:
        return None
    if picture is None or options.text is not None:
        px = option("px")
        raise InputError(f"a text is planned in one piece, of at most {LONGEST_PX} pixels; choose a smaller {px}")
    return Mural(picture, sheet, canvas, options.fit, margin)


def settings_of(
    options: PlanOptions,
    tubes: tuple[NamedPaint, ...],
    of_regions: tuple[Colour, ...] = (),
    of_guides: tuple[Colour, ...] = (),
    *,
    are_mixed: bool = False,
) -> PlannerSettings:
    """Return the planner's settings by the options, with these tubes of paint.

    of_regions, of_guides: colours that regions and lines to be painted name, which are mixed as they are.
    are_mixed: whether the paints are those of a painting that is planned again.

    Raises InputError for colours that are to be pinned, or named by regions, among paints that are not mixed, and for
    more of them than paints.
    """
    palette = tuple(tube.colour for tube in tubes) or tuple(parse_colour(ink) for ink in options.inks or ("black",))
    paints, pinned = options.mixed_paints, tuple(parse_colour(colour) for colour in options.pin)
    if paints is None and pinned:
        raise InputError(f"{option('pin')} names colours among paints to mix, and none are mixed; leave it out")
    for colour in of_regions if paints is None else ():
        if hex_colour(colour) not in map(hex_colour, palette):
            raise not_a_paint(colour)
    pinned = () if paints is None or are_mixed else tuple(dict.fromkeys((*pinned, *of_regions, *of_guides)))
    if paints is not None and len(pinned) > paints:
        raise InputError(
            f"{option('pin')}, {option('regions')} and {option('guides')} name {len(pinned)} colours that are used as "
            f"they are, among {counted(paints, 'paint')}; give more {option('paints')}, or name fewer colours"
        )
    strokes = MOST_AUTO if options.strokes == AUTO else options.strokes
    return PlannerSettings(
        strokes,
        options.exact,
        paints,
        palette,
        options.steps,
        options.ask_every,
        options.seed,
        options.arrange,
        pinned,
        in_colours=len(tubes) > 1,
    )


def not_a_paint(colour: Colour) -> InputError:
    """Return the fault of a colour that a region names among paints that are not mixed for it."""
    return InputError(f"a region is to be painted in {hex_colour(colour)}, which is none of the paints")


def enough(supply: InkSupply | None) -> int:
    """Return the number of strokes that give the ink of a picture, at most `MOST_AUTO`."""
    if supply is None:
        raise no_ink_to_count()
    return min(supply.enough, MOST_AUTO)


def sheet_of(options: PlanOptions, picture: Image | None) -> Sheet:
    """Return the sheet by the options, turned as the picture where they say so."""
    width, height = parse_sheet(options.size, None if picture is None else picture.shape)
    if options.background is None:
        return Sheet(width=width, height=height, paper=parse_colour(options.paper))
    canvas = Canvas(width, height, min(SHEET_PX / height, _WIDEST_SHEET_PX / width))
    photograph = canvas_photograph(options.background, canvas)
    edge = np.concatenate([photograph[0], photograph[-1], photograph[:, 0], photograph[:, -1]])
    paper = tuple(np.median(edge, axis=0).tolist())
    return Sheet(width=width, height=height, paper=paper, picture=encode_png(photograph))


def network_of(options: PlanOptions) -> Network:
    """Return the network that the options name, or else the one for looks alone."""
    if not options.names_clip and options.text is None:
        return EfficientNetLite0()
    from maulstick.planning.features.clip import Clip  # takes seconds to load

    return Clip.load(options.clip or "RN101", options.clip_weights, layers=options.clip_layers)
