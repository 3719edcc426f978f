"""Planning problems out of pictures and texts, and paintings out of plans."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from functools import cache
from importlib.metadata import version
from math import isfinite

import numpy as np
import torch

from maulstick.painting.brush import Brush
from maulstick.painting.metrics import PlanMetrics, blurred_psnr, compare, psnr
from maulstick.painting.painting import OFF_SHEET, Paint, Painting, Provenance, Stroke, StyleUse
from maulstick.planning.attention import attention
from maulstick.planning.drawn_pixels import finest
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.inked import inked, lines_of, spacing_of
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions, Reference, losses_of
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.regions import Regions
from maulstick.planning.result import PlanResult
from maulstick.planning.room import kept_in
from maulstick.planning.stroke_canvas import as_array
from maulstick.planning.tones import Tones
from maulstick.rendering.preview import truth
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Floats, Image
from maulstick.style import Style
from maulstick.style.regional import RegionalStyle

_DEFAULT_LOSSES = LossOptions()
_CPU = torch.device("cpu")
_BLUR = 2e-3  # metres: standard deviation of what an eye blurs that stands two metres away
_METRIC_VIEWS = 8  # views per network loss in the metrics of a finished plan: more than a call while planning


def problem_of(
    layout: Layout,
    brushes: tuple[Brush, ...],
    style: Style,
    options: PlannerSettings,
    loss_options: LossOptions = _DEFAULT_LOSSES,
    network: Callable[[], Network] = EfficientNetLite0,
    importance: Image | None = None,
    device: torch.device = _CPU,
    tones: Tones | None = None,
    bare: Image | None = None,
    regions: Regions | None = None,
) -> PlanningProblem:
    """Return the planning problem of a layout with these losses; `network` is called where a loss needs one.

    brushes: the broadest first; inks have one.
    importance: (H, W), how much each pixel counts; when left out, as `importance_of` says of the layout.
    device: renders, and compares with the picture.  tones: those of inks that the picture is planned in, if any.
    regions: of the layout's canvas, whose hands then draw instead of the `style`.
    bare: (H, W, 3), the sheet without what is painted, on which tones are made; when left out, the layout's.
    Raises InputError for losses that cannot be had.
    """
    importance = importance_of(layout, loss_options.faces) if importance is None else importance
    weights_of = {}
    if regions is not None:
        weights_of = {
            name: torch.from_numpy(regions.emphasis(importance, name)).to(device) for name in ("tone", "edges")
        }
        importance, style = regions.emphasis(importance), regions.style
    paper, weights = _channels_first(layout.under).to(device), torch.from_numpy(importance).to(device)
    target = picture = None if layout.target is None else _channels_first(layout.target).to(device)
    if picture is not None and tones is not None:
        target = tones.apply(picture, paper if bare is None else _channels_first(bare).to(device))
    lines = pull = None
    if picture is not None and target is not None and options.in_ink:
        lines = lines_of(layout, brushes[0], options.palette) if loss_options.contours else None
        target, pull = inked(target, picture, paper, layout.sheet.paper, tones, lines)
    spacing = spacing_of(target, paper, brushes[0], layout, options) if options.in_ink else None
    sheet, grey = torch.tensor(layout.sheet.paper, device=device), options.in_ink and len(options.palette) == 1
    reference = Reference(target, weights, sheet, spacing, pull, weights_of, grey)
    return PlanningProblem(
        target,
        paper,
        weights,
        layout.canvas,
        brushes,
        style,
        *losses_of(loss_options, reference, network),
        room=layout.room,
        regions=regions,
        pull=pull,
        lines=lines,
    )


def importance_of(layout: Layout, faces: float = 1.0) -> Image:
    """Return how much each pixel of the canvas counts, (H, W): within the picture as `attention` says, else 1."""
    importance = np.ones(layout.under.shape[:2], dtype=np.float32)
    if layout.target is not None:
        part = layout.crop(importance)
        part[:] = attention(part.shape[0], part.shape[1], layout.faces if faces else (), faces)
    return importance


def _channels_first(image: Image) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(image.transpose(2, 0, 1)))


def provenance_of(
    options: PlannerSettings, image: str | None = None, sha256: str | None = None, more: Mapping[str, object] = {}
) -> Provenance:
    """Return how a painting is made, for its file: all options, with `more` that the planner itself does not use."""
    colours = {name: [list(colour) for colour in getattr(options, name)] for name in ("palette", "pinned")}
    return Provenance.model_validate(
        {
            "version": version("maulstick"),
            "image": image,
            "image_sha256": sha256,
            "seed": options.seed,
            "options": {**more, **asdict(options), **colours},
        }
    )


def metrics_of(painting: Painting, layout: Layout) -> PlanMetrics | None:
    """Return how near the painting, in the order of its file, comes to the picture in its area; None without one."""
    return _compared(truth(painting, layout.canvas), _as_planned(painting, layout), layout)


@one_torch_thread()
def with_metrics(painting: Painting, layout: Layout, problem: PlanningProblem, tones: Tones | None = None) -> Painting:
    """Return the painting with its metrics in its provenance: likeness, the `loss`, and each term of the loss.

    The likeness is taken at the truth; the terms are those of the pixels that a plan ends on, as `psnr_planned` is.
    tones: those that it was planned in, whose L* are kept: `lightest` and `darkest`, and `psnr_blurred` beside what
    the ink can show of them.
    """
    true, planned = truth(painting, layout.canvas), _as_planned(painting, layout)
    canvas = _channels_first(planned).to(problem.paper)
    with torch.no_grad():
        terms = {each.term.name: each.weight * each.term.loss(canvas, 1.0).item() for each in problem.objectives}
        for network_loss in problem.network_losses:
            losses = network_loss.term.losses(canvas, range(min(_METRIC_VIEWS, network_loss.term.views)))
            terms[network_loss.term.name] = network_loss.weight * losses.mean().item()
    likeness = _compared(true, planned, layout)
    metrics = {**({} if likeness is None else asdict(likeness)), **terms, "loss": sum(terms.values())}
    if tones is not None and problem.target is not None:
        asked = layout.crop(tones.in_ink(problem.target, problem.paper).permute(1, 2, 0).cpu().numpy())
        blurred = blurred_psnr(layout.crop(true), asked, _BLUR * layout.canvas.pixels_per_metre)
        metrics |= {"psnr_blurred": blurred, "lightest": tones.lightest, "darkest": tones.darkest}
    finite = {name: x for name, x in metrics.items() if isfinite(x)}
    provenance = painting.provenance.model_copy(update={"metrics": finite})
    return painting.model_copy(update={"provenance": provenance})


def _as_planned(painting: Painting, layout: Layout) -> Image:
    """Return what the painting looks like on the pixels that a plan of it ends on."""

    @cache
    def rendered(side: float) -> torch.Tensor:
        return _channels_first(truth(painting, layout.canvas, finer=round(1 / side)))

    target = None if layout.target is None else _channels_first(layout.target)
    return rendered(finest(target, rendered)).permute(1, 2, 0).numpy()


def _compared(true: Image, planned: Image, layout: Layout) -> PlanMetrics | None:
    """Return the metrics of what a painting looks like; planned: the same on the planner's pixels."""
    if layout.target is None:
        return None
    target = layout.crop(layout.target)
    seen = compare(layout.crop(true), target)
    return PlanMetrics(**asdict(seen), psnr_planned=psnr(layout.crop(planned), target))


def as_painting(
    planned: PlanResult,
    layout: Layout,
    brushes: tuple[Brush, ...],
    style: Style,
    provenance: Provenance,
    names: Mapping[str, str] = {},
    regions: Regions | None = None,
) -> Painting:
    """Return a plan as a painting, whose file has all that planning it again needs.

    A stroke that is longer than the sheet goes along its edge where it would leave it by more than `OFF_SHEET`; where
    the layout has a room, no mark leaves that.
    names: names of paints, by their colours as ``#rrggbb``.
    regions: those that were planned in; a stroke that cannot be kept off their bare paper is left out.
    """
    codes = planned.strokes.codes
    poses = planned.strokes.poses(style.decode(codes))
    farthest = (layout.sheet.width + OFF_SHEET, layout.sheet.height + OFF_SHEET, 1)
    trajectories = as_array(planned.strokes.trajectories(style)).clip((-OFF_SHEET, -OFF_SHEET, 0), farthest)
    brush_of = planned.strokes.brush_of
    if layout.room is not None:
        for number, brush in enumerate(brushes):
            rows = np.flatnonzero(brush_of.numpy() == number)
            trajectories[rows] = kept_in(layout.room, trajectories[rows], brush)
    if regions is not None:
        trajectories, clear = _off_bare(trajectories, brush_of, brushes, regions, layout)
        planned, codes, poses = replace(
            planned, strokes=planned.strokes[clear], paint_of=planned.paint_of[clear], before=_left(planned, clear)
        ), codes[clear], poses[clear]  # fmt: skip
        brush_of, trajectories = brush_of[clear], trajectories[clear.numpy()]
    hands = _hands(style, codes)
    loads = torch.stack([brush_of, planned.paint_of], dim=1)
    used, paint_of = torch.unique(loads, dim=0, return_inverse=True)
    strokes = [
        Stroke.model_validate(
            {
                "id": number,
                "paint": paint,
                "trajectory": trajectory,
                "speed": speed,
                "style": StyleUse(name=hand.name, hash=hand.hash, code=tuple(code), pose=tuple(pose)),
                "region": None if regions is None else regions.said[region].name,
            }
        )
        for number, (paint, trajectory, (region, hand, code, speed), pose) in enumerate(
            zip(paint_of.tolist(), trajectories.tolist(), hands, poses.tolist(), strict=True)
        )
    ]
    paints = [_paint(brushes[number], planned.paints[paint], names) for number, paint in used.tolist()]
    return Painting(
        sheet=layout.sheet,
        area=layout.area,
        provenance=provenance,
        brushes={brushes[number].name: brushes[number] for number in used[:, 0].unique().tolist()},
        paints=tuple(paints),
        strokes=tuple(strokes),
    )


def _hands(style: Style, codes: torch.Tensor) -> list[tuple[int, Style, list[float], list[float] | None]]:
    """Return the region of each code, its hand, and the code and the speeds of that hand."""
    if not isinstance(style, RegionalStyle):
        speeds = style.speeds(codes)
        speed_of = [None] * len(codes) if speeds is None else speeds.tolist()
        return [(0, style, code, speed) for code, speed in zip(codes.tolist(), speed_of, strict=True)]
    found = []
    for region, code in zip(style.regions_of(codes).tolist(), codes, strict=True):
        hand, own = style.hands[region], style.own_codes(code[None], region)
        speeds = hand.speeds(own)
        found.append((region, hand, own[0].tolist(), None if speeds is None else speeds[0].tolist()))
    return found


def _off_bare(
    trajectories: Floats, brush_of: torch.Tensor, brushes: tuple[Brush, ...], regions: Regions, layout: Layout
) -> tuple[Floats, torch.Tensor]:
    """Return the trajectories (N, n, 3) moved off bare paper, and of which no mark lies on it, (N,)."""
    sheet, clear = layout.sheet, np.ones(len(trajectories), dtype=bool)
    for number, brush in enumerate(brushes):
        rows = np.flatnonzero(brush_of.numpy() == number)
        moved = regions.bare_paper.kept_off(trajectories[rows], brush).clip(0, (sheet.width, sheet.height, 1))
        if layout.room is not None:
            moved = kept_in(layout.room, moved, brush)
        trajectories[rows] = moved.round(6)
        clear[rows] = [regions.bare_paper.is_off(trajectory, brush) for trajectory in trajectories[rows]]
    return trajectories, torch.from_numpy(clear)


def _left(planned: PlanResult, kept: torch.Tensor) -> torch.Tensor:
    """Return how many of the strokes that are kept, (N,), are painted before each neighbour, (M,)."""
    return torch.cat([torch.zeros(1, dtype=torch.long), kept.long().cumsum(dim=0)])[planned.before]


def _paint(brush: Brush, colour: torch.Tensor, names: Mapping[str, str]) -> Paint:
    paint = Paint.model_validate({"colour": colour.tolist(), "brush": brush.name})
    return paint.model_copy(update={"name": names.get(paint.hex)})
