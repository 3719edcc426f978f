"""Plot of a brush: a mark from the lightest pressure to the deepest, its width, its profile, and its numbers."""

from textwrap import wrap

import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from maulstick.painting.brush import Brush
from maulstick.plots.sheet import FAINT, INK, PAPER, QUIET, Plot, length_text, round_length
from maulstick.rendering.traj2stroke import Traj2Stroke, paint
from maulstick.storage.arrays import Floats

_PROPORTION = 1.4  # width of the plot over its height
_POINTS = 32  # samples of the mark, as many as a stroke of a painting has
_LENGTH = 14  # of the mark, in times its greatest width
_COLOUR = (0.13, 0.12, 0.11)  # of the mark, sRGB: a near-black
_MARK, _WIDTHS, _PROFILE, _END = 22.0, 25.0, 39.5, 50.5  # lines: where the mark ends, and the charts begin and end
_WIDTHS_HIGH = 9.0  # lines: height of the chart of widths
_PROFILE_WIDE = 22.0  # lines: width of the chart of profiles
_COLUMNS = 4  # of the table of numbers
_ROW = 3.5  # lines: height of a row of that table
_SHARES = (0.0, 0.5, 1.0)  # of an axis, where it has a tick
_PRESSURES = ((0.0, "#b9b4aa"), (0.5, QUIET), (1.0, INK))


def brush_plot(brush: Brush, title: str, px: int) -> bytes:
    """Draw a brush as a PNG, `px` pixels high. Its mark is rendered as in a painting, above the chart of its widths."""
    plot = Plot(_PROPORTION * px, px)
    margin, line = plot.margin, plot.line
    right = plot.width - margin
    plot.text(margin, margin + 1.2 * line, brush.name, INK, 1.7, room=right - margin)
    source = _shortened(brush.source, round((right - margin) / line * 2.2))
    for number, part in enumerate(source):
        plot.text(margin, margin + (2.9 + 1.3 * number) * line, part, room=right - margin)
    top = margin + (3.2 + 1.3 * len(source)) * line
    wide = plot.width - 2 * margin
    scale = _mark(plot, brush, margin, top, wide, _MARK * line - top)
    inset = (wide - _LENGTH * 2 * brush.widest * scale) / 2
    width_chart(plot, brush, margin + inset, _WIDTHS * line, wide - 2 * inset, _WIDTHS_HIGH * line)
    high = (_END - _PROFILE) * line
    profile_chart(plot, brush, margin + inset, _PROFILE * line, _PROFILE_WIDE * line, high)
    left = margin + inset + (_PROFILE_WIDE + 4) * line
    _numbers(plot, brush, left, (_PROFILE - 0.8) * line, right - left)
    base = plot.height - margin
    plot.text(margin, base, title, room=0.7 * (right - margin))
    bar = round_length(plot.width / 5 / scale)
    plot.rule(right - bar * scale, base, bar * scale, INK)
    plot.text(right, base - 0.5 * line, f"{length_text(bar)} of the mark", ha="right")
    return plot.png()


def width_chart(plot: Plot, brush: Brush, x: float, y: float, wide: float, high: float) -> None:
    """Draw width over pressure with its upper left corner at (x, y), pixels; labels lie above, below and left of it."""
    line, widest = plot.line, 2e3 * brush.widest
    axes = plot.axes(x, y, wide, high, 1.0)
    pressure = np.linspace(0, 1, 201)
    width = 2e3 * brush.half_width(pressure).clip(min=0)
    axes.fill_between(pressure * wide, high - width / widest * high, high, color=PAPER, lw=0)
    axes.plot(pressure * wide, high - width / widest * high, color=INK, lw=plot.points(0.1 * line), clip_on=False)
    for share in _SHARES:
        _level(plot, axes, high * (1 - share), FAINT if share else QUIET)
        plot.text(x - 0.6 * line, y + high * (1 - share) + 0.3 * line, f"{widest * share:.3g}", ha="right")
        plot.text(x + share * wide, y + high + 1.4 * line, f"{share:g}", ha="center")
    plot.text(x, y - 0.8 * line, "width, mm")
    plot.text(x + wide - 1.2 * line, y + high + 1.4 * line, "pressure", ha="right")


def profile_chart(plot: Plot, brush: Brush, x: float, y: float, wide: float, high: float) -> None:
    """Draw darkness across the mark at three pressures, its upper left corner at (x, y), pixels; labels lie around."""
    line, widest = plot.line, brush.widest
    axes = plot.axes(x, y, wide, high, 1.0)
    for pressure, colour in _PRESSURES:
        across = np.linspace(-1, 1, 401) * max(float(brush.half_width(np.array(pressure))), 0.0)
        places, darkness = (1 + across / widest) / 2 * wide, profile(brush, pressure, across)
        axes.fill_between(places, high * (1 - darkness), high, color=PAPER, lw=0)
        axes.plot(places, high * (1 - darkness), color=colour, lw=plot.points(0.1 * line), clip_on=False)
    for share in _SHARES:
        _level(plot, axes, high * (1 - share), FAINT if share else QUIET)
        plot.text(x - 0.6 * line, y + high * (1 - share) + 0.3 * line, f"{share:g}", ha="right")
        distance = 1e3 * widest * abs(2 * share - 1)
        plot.text(x + share * wide, y + high + 1.4 * line, f"{distance:.3g}", ha="center")
    plot.text(x, y - 0.8 * line, "darkness over distance, mm, at pressure 0, 0.5 and 1", room=wide)


def _level(plot: Plot, axes: Axes, y: float, colour: str) -> None:
    """Draw a horizontal rule above the filled areas and below the curves."""
    axes.axhline(y, color=colour, lw=plot.points(0.08 * plot.line), zorder=1.5, clip_on=False)


def profile(brush: Brush, pressure: float, distance: Floats) -> Floats:
    """Darkness (n,), in [0, 1], at distances (n,), metres, from the centre line of a stroke of this pressure."""
    half_width = max(float(brush.half_width(np.array(pressure))), 1e-12)
    shape = np.clip((1 - np.abs(distance) / half_width) / (1 - brush.plateau), 0, 1)
    darkness: Floats = brush.opacity_at(pressure) * shape**brush.falloff
    return darkness


def _shortened(text: str, letters: int) -> list[str]:
    """Wrap the text to three lines at most."""
    lines = wrap(text, letters)
    return lines if len(lines) <= 3 else [*lines[:2], lines[2][: letters - 2] + " …"]


def _mark(plot: Plot, brush: Brush, x: float, y: float, wide: float, high: float) -> float:
    """Draw the mark in the middle of a white rectangle, given in pixels; return pixels per metre."""
    in_place = brush.model_copy(update={"m_x": 1.0, "m_y": 1.0, "b_x": 0.0, "b_y": 0.0})
    length = _LENGTH * 2 * brush.widest
    scale = min(0.6 * high / (2 * brush.widest), 0.88 * wide / length)
    pressure = torch.linspace(0, 1, _POINTS)
    along = (wide / scale - length) / 2 + length * pressure
    path = torch.stack([along, torch.full_like(pressure, high / scale / 2), pressure], dim=1)
    paper = torch.ones(3, max(1, round(high)), max(1, round(wide)))
    with torch.no_grad():
        image = paint(paper, path[None], torch.tensor([_COLOUR]), Traj2Stroke.of([in_place]), scale)
    axes = plot.axes(x, y, wide, high, 1.0)
    axes.imshow(
        image.clamp(0, 1).permute(1, 2, 0).numpy(), extent=(0, wide, high, 0), aspect="auto", interpolation="nearest"
    )
    axes.add_patch(Rectangle((0, 0), wide, high, fill=False, ec=FAINT, lw=plot.points(1), clip_on=False))
    return scale


def _numbers(plot: Plot, brush: Brush, x: float, y: float, wide: float) -> None:
    """Write the numbers of the brush, lengths in mm, without its curve and without extensions that have no effect."""

    def mm(*lengths: float) -> str:
        return ", ".join(f"{1e3 * length:.3g}" for length in lengths) + " mm"

    numbers = [
        ("alpha", mm(brush.alpha)),
        ("beta", mm(brush.beta)),
        ("falloff", f"{brush.falloff:.3g}"),
        ("plateau", f"{brush.plateau:.3g}"),
        ("opacity", f"{brush.opacity:.3g}"),
        ("m", f"{brush.m_x:.4g}, {brush.m_y:.4g}"),
        ("b", mm(brush.b_x, brush.b_y)),
        ("depth", mm(*brush.depth)),
    ]
    beyond = {
        "nib": ", ".join(f"{share:.2g}" for share in brush.nib),
        "lag": mm(brush.lag),
        "touch": mm(*brush.touch),
        "faint": f"{brush.faint:.3g}",
        "solid": f"{brush.solid:.3g}",
        "lightest": f"{brush.lightest:.3g}",
    }
    fields = Brush.model_fields
    numbers += [(name, value) for name, value in beyond.items() if getattr(brush, name) != fields[name].default]
    line, column = plot.line, wide / _COLUMNS
    for number, (name, value) in enumerate(numbers):
        left, top = x + number % _COLUMNS * column, y + number // _COLUMNS * _ROW * line
        plot.text(left, top, name, room=column)
        plot.text(left, top + 1.5 * line, value, INK, 1.1, room=column - 0.5 * line)
