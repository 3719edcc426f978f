"""Curve of a plan's loss, one line per term, on a logarithmic scale."""

from collections.abc import Mapping, Sequence
from math import log

from nicegui import html, ui

from maulstick.studio.state.weighing import TERM_LABELS

_COLOURS = ("var(--mark)", "var(--focus)", "#5f8a3a", "#b98220", "#7a4f95", "#6a6257")
_WIDE, _HIGH = 300, 60  # units of the drawing, which is stretched to the width of its card


class LossCurve:
    """Picture of the curve, with a legend."""

    def __init__(self) -> None:
        self._figure = html.figure().classes("curve")
        with self._figure:
            self._lines = ui.element("svg").props(f'viewBox="0 -2 {_WIDE} {_HIGH + 4}" preserveAspectRatio="none"')
            self._lines.props('role="img" aria-label="How the loss falls, term by term"')
            self._names = html.figcaption()
        self._terms: dict[str, ui.element] = {}

    def show(self, curve: Sequence[tuple[float, Mapping[str, float]]]) -> None:
        """Show the terms of the loss over the progress of planning, in [0, 1]."""
        self._figure.visible = len(curve) > 1
        names = sorted({name for _, parts in curve for name in parts})
        for name in names:
            if name not in self._terms:
                self._add(name)
        logs = [[(done, log(max(parts[name], 1e-9))) for done, parts in curve if name in parts] for name in names]
        heights = [height for line in logs for _, height in line]
        if not heights:
            return
        low, high = min(heights), max(heights)
        for name, line in zip(names, logs, strict=True):
            points = (
                f"{_WIDE * done:.1f},{_HIGH * (high - height) / ((high - low) or 1.0):.1f}" for done, height in line
            )
            self._terms[name].props["points"] = " ".join(points)

    def _add(self, name: str) -> None:
        colour = _COLOURS[len(self._terms) % len(_COLOURS)]
        with self._lines:
            line = ui.element("polyline").props('fill="none" stroke-width="2" vector-effect="non-scaling-stroke"')
        line.props["stroke"] = colour
        self._terms[name] = line
        with self._names, html.span():
            html.span("▬ ").style(f"color: {colour}").props("aria-hidden=true")
            html.span(TERM_LABELS.get(name, name))
