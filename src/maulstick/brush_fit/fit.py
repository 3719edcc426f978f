"""Fit of a brush to trials: the paper's seven numbers, and additions that predict held-out strokes better."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
import torch
from scipy.stats import median_abs_deviation
from torch import Tensor

from maulstick.brush_fit import certainty, descent
from maulstick.brush_fit.descent import Unknowns, descend, stamped
from maulstick.brush_fit.doubts import doubts
from maulstick.brush_fit.evidence import ENOUGH, read_windows
from maulstick.brush_fit.flow import Flow, fit_flow
from maulstick.brush_fit.initialise import first_guess, has_pressures
from maulstick.brush_fit.mosaic import Mosaic
from maulstick.brush_fit.trials import Trial, Trials
from maulstick.brush_fit.window import Window, crosses
from maulstick.painting.brush import Brush
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Floats, Pixels
from maulstick.strokes.strokes import POINTS, resample

ADDITIONS = (*descent.ADDITIONS, "faint")
"""Names of what may be added to the paper's brush."""

_HELD_OUT = 0.3  # share of the strokes
_STEPS, _STEPS_ALL = 200, 150  # of descent for each candidate, and for the last fit to all strokes
_BETTER, _SIGMAS = 0.99, 2.0  # an addition stays if it lowers the held-out error to that share, by so many std. errors
_LEAST_RISE = 0.01  # alpha / beta: below it pressure changes the width too little to matter, and alpha becomes 0
_VIEWS = 12  # held-out strokes that are kept for a plot
_MEDIAN = 1.25  # standard error of a median, relative to that of a mean


@dataclass(frozen=True)
class HeldOutStroke:
    """A stroke that was held out: its photograph and the brush's prediction of it, (h, w, C) in [0, 1]."""

    name: str
    after: Pixels
    predicted: Pixels


@dataclass(frozen=True)
class Fit:
    """A fitted brush and measures of how far it can be trusted.

    errors: standard error of each fitted number, in the number's own unit.
    warnings: what the trials cannot determine.  left_out: trials that were not used, and why.  strokes: number used.
    ink: sRGB of full ink in [0, 1], or (1,) for darkness images.
    place_scatter, ink_scatter: standard deviation of the strokes' own offsets, metres, and of their opacity, a share.
    l1, l1_paper: mean error per pixel in held-out windows, with each stroke's own place and ink fitted, of this brush
        and of the paper's seven numbers; in all windows where there were too few strokes to hold some out.
    kept: additions that were accepted.
    pixels_per_metre: of the views, which may be coarser than the photographs.
    """

    brush: Brush
    errors: dict[str, float]
    warnings: tuple[str, ...]
    left_out: tuple[str, ...]
    strokes: int
    ink: tuple[float, ...]
    place_scatter: float
    ink_scatter: float
    l1: float
    l1_paper: float
    kept: tuple[str, ...]
    views: tuple[HeldOutStroke, ...]
    pixels_per_metre: float


def _nothing(stage: str, done: int, total: int) -> None:
    """Ignore the progress."""


def fit_brush(
    trials: Sequence[Trial] | Trials,
    pixels_per_metre: float,
    name: str,
    *,
    source: str,
    depth: tuple[float, float] = (0.0, 0.0),
    additions: Collection[str] = ADDITIONS,
    seed: int = 0,
    progress: Callable[[str, int, int], None] = _nothing,
) -> Fit:
    """Fit the brush that drew these trials (paper: Traj2Stroke Model; docs/equations.md, docs/brushes.md).

    Each predicted stroke is stamped onto the photograph before it and compared with the one after it by a weighted L1.
    Each stroke's own offset and darkness are fitted too, so that their scatter does not widen the brush.
    trials: read one at a time, so they may be larger than memory; those that cannot be used are left out.
    depth: see `Brush`, metres.  additions: those of `ADDITIONS` that may be tried; none for the paper's numbers alone.
    progress: called with a stage, steps done and steps in all.
    Raises InputError where fewer than five trials can be used.
    """
    with one_torch_thread():
        windows, left_out, scale = read_windows(trials, pixels_per_metre, progress)
        paths = [resample(window.path, POINTS) for window in windows]
        mosaic = Mosaic.of_windows(windows, paths, scale)
        taught = _split(len(windows), seed)
        tried = [name for name in descent.ADDITIONS if name in additions and (name != "curve" or has_pressures(paths))]
        tried = [] if taught.all() else tried
        chosen = _choose(mosaic, first_guess(windows, paths, scale), taught, tried, progress)
        tick = _ticking(progress, "all strokes", _STEPS_ALL)
        found = descend(mosaic, chosen.unknowns, torch.ones_like(taught), _STEPS_ALL, tick)
        tick = _ticking(progress, "standard errors", certainty.GROUPS * certainty.STEPS)
        errors = certainty.standard_errors(mosaic, found, tick)
    flow = fit_flow(
        np.array([path[:, 2].mean() for path in paths]),
        found.ink.clamp(max=0).exp().double().numpy(),
        "faint" in additions,
    )
    ink = found.ink_colour().double().numpy()
    opaque = found.colour is not None and not crosses(windows)
    if opaque:  # without crossings a pale opaque ink explains the photographs as well
        paper = np.median([np.median(window.before, axis=(0, 1)) for window in windows], axis=0)
        ink, flow = paper + (ink - paper) * flow.opacity, replace(flow, opacity=1.0)
        del errors["opacity"]
    places = (found.unit * found.place).double().numpy()
    middle = np.median(places, axis=0)
    scatter = median_abs_deviation(places, axis=0, scale="normal")
    return Fit(
        brush=_brush(found, middle, flow, name, source, depth),
        errors=_named(errors, _MEDIAN * scatter / np.sqrt(len(windows))),
        warnings=doubts(paths, found, errors, opaque),
        left_out=tuple(left_out),
        strokes=len(windows),
        ink=tuple(ink.tolist()),
        place_scatter=float(np.sqrt((scatter**2).mean())),
        ink_scatter=flow.scatter,
        l1=chosen.l1,
        l1_paper=chosen.l1_paper,
        kept=(*chosen.kept, *(["faint"] if flow.faint < 1 else [])),
        views=_views(mosaic, windows, chosen.unknowns, taught),
        pixels_per_metre=scale,
    )


@dataclass(frozen=True)
class _Choice:
    unknowns: Unknowns
    kept: tuple[str, ...]
    l1: float
    l1_paper: float


def _choose(
    mosaic: Mosaic, start: Unknowns, taught: Tensor, tried: Sequence[str], progress: Callable[[str, int, int], None]
) -> _Choice:
    """Fit the paper's numbers, then accept one addition after another that clearly lowers the held-out error."""
    found = descend(mosaic, start, taught, _STEPS, _ticking(progress, "the paper's numbers", _STEPS))
    paper = best = _held_out(mosaic, found, taught)
    kept: list[str] = []
    refused: dict[str, int] = {}  # number of additions that had been kept then
    for addition in (*tried, *tried):  # twice, since an addition may only help once another one is there
        if addition in kept or refused.get(addition) == len(kept):
            continue
        tick = _ticking(progress, addition, _STEPS)
        restart = start.adding([*kept, addition])  # from `found`, a local minimum, it would not get away
        candidate = descend(mosaic, restart, taught, _STEPS, tick)
        error = _held_out(mosaic, candidate, taught)
        gain = (best / error).log()  # a logarithm, so that a few very bad strokes do not dominate
        certain = gain.mean() > _SIGMAS * gain.std() / len(gain) ** 0.5
        if error.mean() < _BETTER * best.mean() and certain:
            found, best = candidate, error
            kept.append(addition)
        else:
            refused[addition] = len(kept)
    return _Choice(found, tuple(kept), float(best.mean()), float(paper.mean()))


def _held_out(mosaic: Mosaic, found: Unknowns, taught: Tensor) -> Tensor:
    """Mean error per pixel of each held-out window, or of each window where none is held out."""
    with torch.no_grad():
        each = mosaic.l1(stamped(mosaic, found, taught))
    return each if taught.all() else each[~taught]


def _ticking(progress: Callable[[str, int, int], None], stage: str, total: int) -> Callable[[], None]:
    done = count(1)
    return lambda: progress(stage, next(done), total)


def _split(count: int, seed: int) -> Tensor:
    """Return a mask (count,) of the strokes that the brush is fitted to; the others are held out."""
    taught = torch.ones(count, dtype=torch.bool)
    if count >= ENOUGH:
        held_out = torch.randperm(count, generator=torch.Generator().manual_seed(seed))[: round(_HELD_OUT * count)]
        taught[held_out] = False
    return taught


def _views(mosaic: Mosaic, windows: Sequence[Window], found: Unknowns, taught: Tensor) -> tuple[HeldOutStroke, ...]:
    shown = (taught if taught.all() else ~taught).nonzero()[:_VIEWS, 0].tolist()
    with torch.no_grad():
        predicted = stamped(mosaic, found, taught)
    return tuple(HeldOutStroke(windows[i].name, windows[i].after, mosaic.window(predicted, i)) for i in shown)


def _brush(found: Unknowns, middle: Floats, flow: Flow, name: str, source: str, depth: tuple[float, float]) -> Brush:
    numbers = {key: value.double().tolist() for key, value in found.numbers().items()}
    alpha = numbers["alpha"][0]
    return Brush(
        name=name,
        source=source,
        m_x=numbers["scale"][0],
        m_y=numbers["scale"][1],
        b_x=float(middle[0]),
        b_y=float(middle[1]),
        alpha=alpha if alpha > _LEAST_RISE * numbers["beta"][0] else 0.0,
        beta=numbers["beta"][0],
        falloff=numbers["falloff"][0],
        plateau=numbers["plateau"][0],
        curve=tuple(numbers["curve"]),
        nib=tuple(numbers["nib"]),
        lag=numbers["lag"][0],
        touch=tuple(numbers["touch"]),
        opacity=flow.opacity,
        faint=flow.faint,
        solid=flow.solid,
        depth=depth,
    )


def _named(errors: Mapping[str, Tensor], of_place: Floats) -> dict[str, float]:
    """Return standard errors by the names of `Brush`'s fields, with an index for several values, as in ``curve[0]``."""
    named = {"b_x": float(of_place[0]), "b_y": float(of_place[1])}
    for name, each in errors.items():
        values = each.tolist()
        if name == "scale":
            named["m_x"], named["m_y"] = values
        elif len(values) == 1:
            named[name] = values[0]
        else:
            named.update({f"{name}[{i}]": value for i, value in enumerate(values)})
    return named
