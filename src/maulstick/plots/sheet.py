"""Base of all plots: colours, text, captions, and writing a PNG."""

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

TABLE, PAPER, INK, QUIET, FAINT, ACCENT = "#f4f2ed", "#ffffff", "#211f1c", "#7d786f", "#dcd8cf", "#c4452c"

_DPI = 128  # a power of two: pixels / dpi * dpi is then exact
_TYPE = ["STIXGeneral", "DejaVu Sans"]  # both come with matplotlib; the second has the letters the first lacks

LINES = 56
"""Number of lines of text in the height of a plot."""

MARGIN = 2.0
"""Margin around a plot, lines."""

FOOT = 2 * MARGIN + 5.4
"""Height of a caption with its margins, lines."""


@contextmanager
def _missing_glyphs() -> Iterator[None]:
    """Silence warnings about letters that no font here has, as in a name of another script."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        yield


class Plot:
    """Figure measured in pixels from its upper left corner.

    width, height: pixels.  line: height of a line of text, pixels.  margin: space left free around it, pixels.
    foot: height of a caption with its margins, pixels.
    """

    def __init__(self, width: float, height: int, lines: float = LINES) -> None:
        self.width, self.height = round(width), height
        self.line = height / lines
        self.margin, self.foot = MARGIN * self.line, FOOT * self.line
        self.figure = Figure(figsize=(self.width / _DPI, height / _DPI), dpi=_DPI, facecolor=TABLE)

    def axes(self, x: float, y: float, width: float, height: float, scale: float) -> Axes:
        """Add axes without frame or ticks, their upper left corner at (x, y), y down, in units of `scale` pixels."""
        place = (x / self.width, 1 - (y + height) / self.height, width / self.width, height / self.height)
        axes = self.figure.add_axes(place, frameon=False, xticks=[], yticks=[])
        axes.set_xlim(0, width / scale)
        axes.set_ylim(height / scale, 0)
        return axes

    def paper(self, x: float, y: float, width: float, height: float, scale: float) -> Axes:
        """Add a white sheet with a fine edge, and return its axes, as `axes` does."""
        axes = self.axes(x, y, width, height, scale)
        axes.add_patch(
            Rectangle((0, 0), 1, 1, transform=axes.transAxes, fc=PAPER, ec=FAINT, lw=self.points(1), clip_on=False)
        )
        return axes

    def text(
        self,
        x: float,
        y: float,
        text: str,
        colour: str = QUIET,
        size: float = 1.0,
        room: float = np.inf,
        ha: str = "left",
    ) -> None:
        """Draw text with its baseline at (x, y), pixels; `size` in lines, less where it would be wider than `room`."""
        options: dict[str, Any] = {"color": colour, "family": _TYPE, "parse_math": False, "ha": ha}
        drawn = self.figure.text(
            x / self.width, 1 - y / self.height, text, size=self.points(size * self.line), **options
        )
        if np.isfinite(room):
            renderer = FigureCanvasAgg(self.figure).get_renderer()  # type: ignore[no-untyped-call]
            with _missing_glyphs():
                wide = drawn.get_window_extent(renderer).width
            drawn.set_fontsize(self.points(size * self.line) * min(1, room / max(wide, 1)))

    def rule(self, x: float, y: float, width: float, colour: str = QUIET, weight: float = 0.08) -> None:
        """Draw a horizontal rule from (x, y), pixels; `weight` in lines."""
        xs, ys = np.array([x, x + width]) / self.width, [1 - y / self.height] * 2
        self.figure.add_artist(Line2D(xs, ys, color=colour, lw=self.points(weight * self.line), solid_capstyle="butt"))

    def caption(self, title: str, caption: str, note: str, scale: float) -> None:
        """Draw a title, two lines about it, and a scale bar for `scale` pixels per metre at the foot of the plot."""
        left, right, base = self.margin, self.width - self.margin, self.height - self.margin
        bar = round_length(self.width / 5 / scale)
        y = base - 2.75 * self.line
        self.text(left, y, title, INK, 1.2, room=right - left - bar * scale - self.margin)
        self.text(left, base - 1.3 * self.line, caption, room=right - left)
        self.text(left, base, note, room=right - left)
        self.rule(right - bar * scale, y, bar * scale, INK)
        self.text(right, y - 0.5 * self.line, length_text(bar), ha="right")

    def points(self, pixels: float) -> float:
        """Convert pixels to points, in which matplotlib measures text and lines."""
        return pixels * 72 / _DPI

    def png(self) -> bytes:
        """Encode the plot as a PNG."""
        file = io.BytesIO()
        with _missing_glyphs():
            self.figure.savefig(file, format="png", dpi=_DPI, metadata={"Software": None})
        return file.getvalue()


def round_length(most: float) -> float:
    """Largest of 1, 2, 5, 10, ..., times a power of ten, that is at most `most`, metres."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(power * max(step for step in (1, 2, 5) if step * power <= most * (1 + 1e-9)))


def length_text(metres: float) -> str:
    """Format a length, metres, for people."""
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"
