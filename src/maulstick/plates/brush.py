"""The plate of a brush: a mark from the lightest press to the deepest, its width, and its numbers."""

from textwrap import wrap

import numpy as np
import torch
from matplotlib.patches import Rectangle

from maulstick.brush.traj2stroke import Traj2Stroke, paint
from maulstick.medium import Brush
from maulstick.plates.sheet import FAINT, INK, PAPER, QUIET, Plate, length_text, round_length

_PROPORTION = 1.4
_POINTS = 32
_LENGTH = 14  # times the widest mark
_COLOUR = (0.13, 0.12, 0.11)


def brush_plate(brush: Brush, title: str, px: int) -> bytes:
    """A PNG, `px` pixels high. The mark is drawn by the same renderer as paintings, on the axis of the chart below."""
    plate = Plate(_PROPORTION * px, px)
    margin, line = plate.margin, plate.line
    right = plate.width - margin
    plate.text(margin, margin + 1.2 * line, brush.name, INK, 1.7, room=right - margin)
    source = _shortened(brush.source, round((right - margin) / line * 2.2))
    for number, part in enumerate(source):
        plate.text(margin, margin + (2.9 + 1.3 * number) * line, part, room=right - margin)
    top = margin + (3.2 + 1.3 * len(source)) * line
    wide, high = plate.width - 2 * margin, 0.45 * px - top
    scale = _mark(plate, brush, margin, top, wide, high)
    inset = (wide - _LENGTH * 2 * brush.widest * scale) / 2
    bottom = _chart(plate, brush, margin + inset, top + high + 2.2 * line, wide - 2 * inset, 0.26 * px)
    numbers = _numbers(brush)
    column = (right - margin) / len(numbers)
    for number, (name, value) in enumerate(numbers):
        plate.text(margin + number * column, bottom + 3.6 * line, name, room=column)
        plate.text(margin + number * column, bottom + 5.1 * line, value, INK, 1.1, room=column - 0.5 * line)
    base = plate.height - margin
    plate.text(margin, base, title, room=0.7 * (right - margin))
    bar = round_length(plate.width / 5 / scale)
    plate.rule(right - bar * scale, base, bar * scale, INK)
    plate.text(right, base - 0.5 * line, f"{length_text(bar)} of the mark", ha="right")
    return plate.png()


def _shortened(text: str, letters: int) -> list[str]:
    """The text on three lines at most."""
    lines = wrap(text, letters)
    return lines if len(lines) <= 3 else [*lines[:2], lines[2][: letters - 2] + " …"]


def _mark(plate: Plate, brush: Brush, x: float, y: float, wide: float, high: float) -> float:
    """Draw the mark in the middle of a piece of paper, pixels; returns pixels a metre."""
    length = _LENGTH * 2 * brush.widest
    scale = min(0.6 * high / (2 * brush.widest), 0.88 * wide / length)
    press = torch.linspace(0, 1, _POINTS)
    along = (wide / scale - length) / 2 + length * press
    path = torch.stack([along, torch.full_like(press, high / scale / 2), press], dim=1)
    paper = torch.ones(3, max(1, round(high)), max(1, round(wide)))
    with torch.no_grad():
        image = paint(paper, path[None], torch.tensor([_COLOUR]), Traj2Stroke.of([brush]), scale)
    axes = plate.axes(x, y, wide, high, 1.0)
    axes.imshow(
        image.clamp(0, 1).permute(1, 2, 0).numpy(), extent=(0, wide, high, 0), aspect="auto", interpolation="nearest"
    )
    axes.add_patch(Rectangle((0, 0), wide, high, fill=False, ec=FAINT, lw=plate.points(1), clip_on=False))
    return scale


def _chart(plate: Plate, brush: Brush, x: float, y: float, wide: float, high: float) -> float:
    """Width over press, its upper left corner at (x, y), pixels; returns where it ends below."""
    line, widest = plate.line, 2e3 * brush.widest
    axes = plate.axes(x, y, wide, high, 1.0)
    press = np.linspace(0, 1, 200)
    width = 2e3 * brush.half_width(press).clip(min=0)
    axes.fill_between(press * wide, high - width / widest * high, high, color=PAPER, lw=0)
    axes.plot(press * wide, high - width / widest * high, color=INK, lw=plate.points(0.1 * line), clip_on=False)
    for share in (0.0, 0.5, 1.0):
        plate.rule(x, y + high * (1 - share), wide, FAINT if share else QUIET)
        plate.text(x - 0.6 * line, y + high * (1 - share) + 0.3 * line, f"{widest * share:.3g}", ha="right")
        plate.text(x + share * wide, y + high + 1.4 * line, f"{share:g}", ha="center")
    plate.text(x, y - 0.8 * line, "width, mm")
    plate.text(x + wide - 1.2 * line, y + high + 1.4 * line, "press", ha="right")
    return y + high + 1.4 * line


def _numbers(brush: Brush) -> list[tuple[str, str]]:
    """What the file of the brush says, lengths in millimetres."""

    def mm(*lengths: float) -> str:
        return ", ".join(f"{1e3 * length:.3g}" for length in lengths) + " mm"

    return [
        ("alpha", mm(brush.alpha)),
        ("beta", mm(brush.beta)),
        ("c", f"{brush.c:.3g}"),
        ("plateau", f"{brush.plateau:.3g}"),
        ("opacity", f"{brush.opacity:.3g}"),
        ("m", f"{brush.m_x:.4g}, {brush.m_y:.4g}"),
        ("b", mm(brush.b_x, brush.b_y)),
        ("depth", mm(*brush.depth)),
    ]
