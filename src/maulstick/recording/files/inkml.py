"""Reader of InkML, the W3C's ink markup language (Recommendation of 20 September 2011), as far as it is in common use.

A stroke is a <trace>, or several that continue each other; pen-up traces are left out, and traces within
<definitions> count only where there are no others. Not read are views, mappings, canvas transforms, and channels other
than X, Y, T and F.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from maulstick.errors import InputError
from maulstick.recording.files.markup import METRES, local_name, parsed
from maulstick.recording.files.page import Page
from maulstick.recording.files.traces import points_of
from maulstick.storage.arrays import Floats

_METRES = {**METRES, "m": 1.0, "um": 1e-6, "himetric": 1e-5}  # per unit of length
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}  # per unit of time
_ID = "{http://www.w3.org/XML/1998/namespace}id"  # the attribute xml:id


class _Channel(NamedTuple):
    """Column of the points. units: "dev" where the file states none.  least, most: its range, where stated."""

    name: str
    integer: bool = False
    units: str = "dev"
    least: float = 0.0
    most: float | None = None
    falling: bool = False


@dataclass(frozen=True)
class _Context:
    """Settings that apply to a trace. resolution: by channel, steps per unit, and that unit."""

    channels: tuple[_Channel, ...] = (_Channel("X"), _Channel("Y"))
    resolution: dict[str, tuple[float, str]] = field(default_factory=dict)

    def scale(self, name: str, units: dict[str, float]) -> float | None:
        """Size of one step of a channel in the common unit of `units`, or None where the file does not state it."""
        channel = next(channel for channel in self.channels if channel.name == name)
        steps, per = self.resolution.get(name, (0.0, ""))
        if steps > 0 and per in units and (channel.integer or channel.units == "dev"):
            return units[per] / steps
        if channel.units == "dev":
            return None
        if channel.units not in units:
            raise InputError.of_choice(f"unit of the channel {name}", channel.units, units)
        return units[channel.units]


@dataclass(frozen=True)
class _Trace:
    """Points (m, channels) as they were written, NaN where unknown. start: of the trace, seconds."""

    points: Floats
    context: _Context
    start: float

    def column(self, name: str) -> Floats:
        """Return the values (m,) of one channel, unknown ones interpolated; all NaN where none is known."""
        names = [channel.name for channel in self.context.channels]
        values = self.points[:, names.index(name)] if name in names else np.full(len(self.points), np.nan)
        known = np.flatnonzero(~np.isnan(values))
        return np.interp(np.arange(len(values)), known, values[known]) if len(known) else values


def read_inkml(content: bytes) -> Page:
    """Read the page of an InkML document.

    X and Y are in the units of their channels, or, where these are "dev" or the values are integers, in steps of their
    resolution; where neither is stated the unit is unknown. T is in milliseconds where nothing else is stated. F is
    divided by its range, or, where none is stated, by the largest F of the document if that is over 1; an F that never
    changes counts as not recorded.
    Raises InputError where the document cannot be read.
    """
    root = parsed(content, "ink")
    reader = _Reader(root)
    traces = list(reader.traces(root, _Context()))
    if not traces:
        traces = [t for part in root if local_name(part) == "definitions" for t in reader.traces(part, _Context())]
    scales = [tuple(trace.context.scale(name, _METRES) for name in "XY") for trace in traces]
    known = all(scale is not None for pair in scales for scale in pair)
    if not known and any(scale is not None for pair in scales for scale in pair):
        raise InputError("a part of its X and Y has a unit of length and a part has none; state the same for all")
    largest = _largest_force(traces)
    strokes = [_stroke(trace, largest) for trace in traces]
    if known:
        factors = np.array(scales, dtype=np.float64).reshape(-1, 2)
        strokes = [np.column_stack([s[:, :1], s[:, 1:3] * f, s[:, 3:]]) for s, f in zip(strokes, factors, strict=True)]
    return Page([stroke for stroke in strokes if len(stroke)], 1.0 if known else None, None, "InkML")


def _largest_force(traces: list[_Trace]) -> float | None:
    """Return the largest F, at least 1; None where F never changes, so that it was not recorded."""
    forces = np.concatenate([np.zeros(0), *(trace.column("F") for trace in traces)])
    known = set(forces[~np.isnan(forces)].tolist())
    return max(1.0, *known) if len(known) > 1 else None


def _stroke(trace: _Trace, largest: float | None) -> Floats:
    channels = {channel.name: channel for channel in trace.context.channels}
    t, force = trace.column("T"), trace.column("F")
    if "T" in channels:
        t = t * (trace.context.scale("T", _SECONDS) or 1e-3) + trace.start
    if largest is None:
        force = np.full(len(force), np.nan)
    elif "F" in channels:
        least, most = channels["F"].least, channels["F"].most
        span = largest if most is None or most <= least else most - least
        force = np.clip((force - least) / span, 0, 1)
    places = trace.points[:, [list(channels).index(name) for name in "XY"]]
    places = places * [-1 if channels[name].falling else 1 for name in "XY"]
    return np.column_stack([t, places, force])[~np.isnan(places).any(axis=1)]


class _Reader:
    """Reader of the traces of a document, which keeps the elements that others refer to."""

    def __init__(self, root: Element) -> None:
        self._named = {f"#{name}": element for element in root.iter() if (name := _name(element))}
        self._contexts = {"#DefaultContext": _Context()}

    def traces(self, parent: Element, context: _Context) -> Iterator[_Trace]:
        """Yield the traces below an element but not in definitions; a context applies to all that follows it."""
        found: list[tuple[_Context, float, list[Floats]]] = []
        places: dict[str, int] = {}
        for element, context_here in self._walk(parent, context):
            points = points_of(element.text or "", len(context_here.channels))
            prior = places.get(element.get("priorRef", "").removeprefix("#"))
            if prior is not None and element.get("continuation") in ("middle", "end"):
                if found[prior][0].channels != context_here.channels:
                    raise InputError("a trace continues another that has other channels")
                found[prior][2].append(points)
            else:
                prior = len(found)
                found.append((context_here, _number(element, "timeOffset", 0.0) * 1e-3, [points]))
            if name := _name(element):
                places[name] = prior
        for context_here, start, parts in found:
            yield _Trace(np.concatenate(parts), context_here, start)

    def _walk(self, parent: Element, context: _Context) -> Iterator[tuple[Element, _Context]]:
        for element in parent:
            tag = local_name(element)
            if tag in ("context", "traceFormat", "inkSource"):
                context = self._changed(context, element)
            elif tag == "traceGroup":
                yield from self._walk(element, self._referred(element, context))
            elif tag == "trace" and element.get("type") != "penUp":
                yield element, self._referred(element, context)

    def _referred(self, element: Element, context: _Context) -> _Context:
        name = element.get("contextRef", "")
        if name not in self._contexts and name in self._named:
            self._contexts[name] = self._changed(_Context(), self._named[name])
        return self._contexts.get(name, context)

    def _changed(self, context: _Context, element: Element) -> _Context:
        """Return the context as an element changes it."""
        tag = local_name(element)
        if tag == "traceFormat":
            channels = tuple(_channel(c) for c in element.iter() if local_name(c) == "channel")
            names = [channel.name for channel in channels]
            if len(set(names)) < len(names) or not {"X", "Y"} <= set(names):
                came = ", ".join(names) or "none"
                raise InputError(f"a traceFormat has the channels {came}; it must have X and Y, and none twice")
            return replace(context, channels=channels)
        if tag == "channelProperty":
            if element.get("name") != "resolution":
                return context
            steps = _number(element, "value", 0.0), element.get("units", "").rpartition("/")[2]
            return replace(context, resolution={**context.resolution, element.get("channel", ""): steps})
        if tag == "context":
            context = self._referred(element, context)
            for reference in ("inkSourceRef", "traceFormatRef"):
                if (target := self._named.get(element.get(reference, ""))) is not None:
                    context = self._changed(context, target)
        if tag in ("context", "inkSource", "channelProperties"):
            for child in element:
                context = self._changed(context, child)
        return context


def _name(element: Element) -> str | None:
    return element.get(_ID) or element.get("id")


def _channel(element: Element) -> _Channel:
    most = _number(element, "max", np.nan)
    return _Channel(
        element.get("name", ""),
        element.get("type") == "integer",
        element.get("units", "dev"),
        _number(element, "min", 0.0),
        None if np.isnan(most) else most,
        element.get("orientation") == "-ve",
    )


def _number(element: Element, name: str, default: float) -> float:
    text = element.get(name)
    try:
        number = default if text is None else float(text)
    except ValueError:
        raise InputError(f"{name} of a <{local_name(element)}> is {text!r}; it must be a number") from None
    if text is not None and not np.isfinite(number):
        raise InputError(f"{name} of a <{local_name(element)}> is {text}; it must be a finite number")
    return number
