"""Fit of a brush to trials: the paper's seven numbers, and additions that draw held-out strokes better."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import median_abs_deviation
from torch import Tensor

from maulstick.brush_fit import certainty
from maulstick.brush_fit.descent import descend
from maulstick.brush_fit.doubts import doubts
from maulstick.brush_fit.evidence import Evidence, read_evidence
from maulstick.brush_fit.executed import Executed
from maulstick.brush_fit.initialise import first_guess, has_pressures
from maulstick.brush_fit.selection import ADDITIONS, FAINT, STEPS, Split, choose, shape_of, ticking
from maulstick.brush_fit.trials import Trial, Trials
from maulstick.brush_fit.window import crosses
from maulstick.painting.brush import Brush
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Floats, Pixels

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
    l1, l1_paper: mean error per pixel around strokes that neither taught nor chose anything, drawn as a machine would
        draw them, of a brush with these additions and of the paper's seven numbers; around all strokes where there
        were too few to hold some out.
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
        evidence, left_out = read_evidence(trials, pixels_per_metre, progress)
        windows, paths = evidence.windows, evidence.paths
        split = Split.of(paths, seed)
        tried = [name for name in ADDITIONS if name in additions and (name != "curve" or has_pressures(paths))]
        choice = choose(evidence, split, tried, progress)
        start = first_guess(evidence).adding(shape_of(choice.additions))
        found = descend(evidence.mosaic(), start, STEPS, ticking(progress, "all strokes", STEPS))
        tick = ticking(progress, "standard errors", certainty.GROUPS * certainty.STEPS)
        errors = certainty.standard_errors(evidence, found, tick)
    executed = Executed.of(found, evidence, FAINT in choice.additions)
    shown = np.unique(np.linspace(0, len(split.opened) - 1, _VIEWS).round().astype(int))  # bending little and much
    ink = found.ink_colour().double().numpy()
    opaque = found.colour is not None and not crosses(windows)
    if opaque:  # without crossings a pale opaque ink explains the photographs as well
        paper = np.median([np.median(window.before, axis=(0, 1)) for window in windows], axis=0)
        ink = paper + (ink - paper) * executed.flow.opacity
        executed = replace(executed, flow=replace(executed.flow, opacity=1.0))
        del errors["opacity"]
    places = (found.unit * found.place).double().numpy()
    scatter = median_abs_deviation(places, axis=0, scale="normal")
    return Fit(
        brush=_brush(executed, name, source, depth, lightest=float(evidence.pressures().min())),
        errors=_named(errors, _MEDIAN * scatter / np.sqrt(len(windows))),
        warnings=doubts(evidence, found, errors, opaque),
        left_out=tuple(left_out),
        strokes=len(windows),
        ink=tuple(ink.tolist()),
        place_scatter=float(np.sqrt((scatter**2).mean())),
        ink_scatter=executed.flow.scatter,
        l1=choice.l1,
        l1_paper=choice.l1_paper,
        kept=choice.additions,
        views=_views(choice.executed, evidence.pick(split.opened[shown])),
        pixels_per_metre=evidence.pixels_per_metre,
    )


def _views(executed: Executed, shown: Evidence) -> tuple[HeldOutStroke, ...]:
    predicted = executed.stamped(shown, mosaic := shown.mosaic())
    return tuple(HeldOutStroke(w.name, w.after, mosaic.window(predicted, i)) for i, w in enumerate(shown.windows))


def _brush(executed: Executed, name: str, source: str, depth: tuple[float, float], lightest: float) -> Brush:
    numbers = {key: value.double().tolist() for key, value in executed.unknowns.numbers().items()}
    flow = executed.flow
    alpha = numbers["alpha"][0]
    return Brush(
        name=name,
        source=source,
        m_x=numbers["scale"][0],
        m_y=numbers["scale"][1],
        b_x=float(executed.shift[0]),
        b_y=float(executed.shift[1]),
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
        lightest=lightest,
    )


def _named(errors: Mapping[str, Tensor], of_place: Floats) -> dict[str, float]:
    """Return standard errors by the names of `Brush`'s fields, with an index for several values, as in ``curve[0]``.

    A scale that no stroke tells has none.
    """
    named = {"b_x": float(of_place[0]), "b_y": float(of_place[1])}
    for name, each in errors.items():
        values = each.tolist()
        if name == "scale":
            named.update({f"m_{axis}": error for axis, error in zip("xy", values, strict=True) if error > 0})
        elif len(values) == 1:
            named[name] = values[0]
        else:
            named.update({f"{name}[{i}]": value for i, value in enumerate(values)})
    return named
