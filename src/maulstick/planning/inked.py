"""What inks are asked to draw of a picture: its tones, the lines over them, and what counts beside both."""

from collections.abc import Callable
from functools import cache, partial

import torch
from torch import Tensor

from maulstick.painting.brush import Brush
from maulstick.planning.layout import Layout
from maulstick.planning.lines import lines_on
from maulstick.planning.objectives import towards_contours
from maulstick.planning.problem import Colour, PlannerSettings
from maulstick.planning.separation import separated
from maulstick.planning.tones import Tones, draw_light, strongest_of
from maulstick.storage.arrays import Image

_PALEST = 0.01  # grey whose lines are the furthest apart that is reckoned with


def lines_of(layout: Layout, pen: Brush, inks: tuple[Colour, ...]) -> Callable[[], Image]:
    """Return a function that returns how dark lines of the strongest ink are, (H, W), once they are asked for."""
    return cache(partial(lines_on, layout, pen, light=draw_light(inks, layout.sheet.paper)))


def inked(
    target: Tensor,
    picture: Tensor,
    paper: Tensor,
    sheet: Colour,
    tones: Tones | None,
    lines: Callable[[], Image] | None,
) -> tuple[Tensor, Tensor | None]:
    """Return the target in tones with lines over it, and the slope of what counts beside, as `Halftone` takes it.

    sheet: colour of the paper, sRGB in [0, 1].  lines: as `lines_of` returns them; without them no contours count.
    """
    pulls = [] if lines is None else [towards_contours(picture)]
    if tones is not None and tones.lines and lines is not None:
        ink = torch.tensor(strongest_of(tones.inks, sheet)).to(target)[:, None, None]
        dark = torch.from_numpy(lines()).to(target)
        target = tones.with_lines(target, dark, ink)
        pulls.append(tones.towards_lines(dark, ink, paper))
    if tones is not None and (lights := tones.away_from_lights(target, picture, paper)) is not None:
        pulls.append(lights)
    return target, sum(pulls[1:], pulls[0]) if pulls else None


def spacing_of(target: Tensor | None, paper: Tensor, brush: Brush, layout: Layout, options: PlannerSettings) -> float:
    """Return the pixels between thinnest lines in the usual grey of a target (C, H, W)."""
    width = 2 * brush.finest * layout.canvas.pixels_per_metre
    if target is None:
        return width
    amounts = separated(target.double(), paper.double(), options.palette).sum(dim=0).cpu().numpy()
    shown = amounts[amounts > 0]
    return width / max(float(shown.mean()), _PALEST) if len(shown) else width
