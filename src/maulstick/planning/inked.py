"""What inks are asked to draw of a picture: its tones, the lines over them, and what counts beside both."""

import torch

from maulstick.painting.brush import Brush
from maulstick.planning.layout import Layout
from maulstick.planning.lines import lines_on
from maulstick.planning.objectives import towards_contours
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.separation import separated
from maulstick.planning.tones import Tones, is_lighter, strongest_of

_PALEST = 0.01  # grey whose lines are the furthest apart that is reckoned with


def inked(
    target: torch.Tensor,
    picture: torch.Tensor,
    paper: torch.Tensor,
    layout: Layout,
    pen: Brush,
    tones: Tones | None,
    *,
    contours: bool,
) -> tuple[torch.Tensor, torch.Tensor | None]:
    """Return the target in tones with lines over it, and the slope of what counts beside, as `Halftone` takes it."""
    pulls = [towards_contours(picture)] if contours else []
    if tones is not None and tones.lines:
        ink = strongest_of(tones.inks, layout.sheet.paper)
        lines = lines_on(layout, pen, light=is_lighter(ink, layout.sheet.paper))
        dark, full = torch.from_numpy(lines).to(target), torch.tensor(ink).to(target)[:, None, None]
        target = tones.with_lines(target, dark, full)
        pulls.append(tones.towards_lines(dark, full, paper))
    if tones is not None and (lights := tones.away_from_lights(target, picture, paper)) is not None:
        pulls.append(lights)
    return target, sum(pulls[1:], pulls[0]) if pulls else None


def spacing_of(
    target: torch.Tensor | None, paper: torch.Tensor, brush: Brush, layout: Layout, options: PlannerSettings
) -> float:
    """Return the pixels between thinnest lines in the usual grey of a target (C, H, W)."""
    width = 2 * brush.finest * layout.canvas.pixels_per_metre
    if target is None:
        return width
    amounts = separated(target.double(), paper.double(), options.palette).sum(dim=0).cpu().numpy()
    shown = amounts[amounts > 0]
    return width / max(float(shown.mean()), _PALEST) if len(shown) else width
