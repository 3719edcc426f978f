"""From a picture or a text to a painting: plan it, and write down the result."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from importlib.metadata import version
from math import isfinite

import numpy as np
import torch

from maulstick.painting.brush import Brush
from maulstick.painting.metrics import Metrics, compare
from maulstick.painting.painting import Paint, Painting, Provenance, Stroke, StyleUse, hex_colour
from maulstick.planning.attention import attention
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.layout import Layout
from maulstick.planning.losses import LossOptions, Reference, losses_of
from maulstick.planning.planner import PlanResult
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.rendering.preview import preview
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Image
from maulstick.style import Style

_DEFAULT_LOSSES = LossOptions()
_LOOKS = 8  # views through which network losses look at what became of a plan


def problem_of(
    layout: Layout,
    brush: Brush,
    style: Style,
    options: PlannerSettings,
    loss_options: LossOptions = _DEFAULT_LOSSES,
    network: Callable[[], Network] = EfficientNetLite0,
    importance: Image | None = None,
) -> PlanningProblem:
    """What a laid out sheet asks of the planner, with those loss options; `network` is called where it is needed.

    importance: (H, W), how much each pixel counts; when left out, as `attention` says of the picture.
    Rendered on a GPU where there is one. Raises InputError for options that cannot be.
    """
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    counts = importance_of(layout) if importance is None else importance
    paper, weights = _channels_first(layout.under).to(device), torch.from_numpy(counts).to(device)
    target = None if layout.target is None else _channels_first(layout.target).to(device)
    reference = Reference(target, weights, torch.tensor(layout.sheet.paper, device=device), options.one_ink)
    return PlanningProblem(
        target, paper, weights, layout.canvas, brush, style, *losses_of(loss_options, reference, network)
    )


def importance_of(layout: Layout) -> Image:
    """How much each pixel of the canvas counts, (H, W): faces more than the rest of the picture."""
    importance = np.ones(layout.under.shape[:2], dtype=np.float32)
    if layout.target is not None:
        layout.crop(importance)[:] = attention(layout.crop(layout.target))
    return importance


def _channels_first(image: Image) -> torch.Tensor:
    return torch.from_numpy(np.ascontiguousarray(image.transpose(2, 0, 1)))


def provenance_of(
    options: PlannerSettings, image: str | None = None, sha256: str | None = None, more: Mapping[str, object] = {}
) -> Provenance:
    """How a painting is made, for its file: all options, with `more` that the planner itself does not see."""
    return Provenance.model_validate(
        {
            "version": version("maulstick"),
            "image": image,
            "image_sha256": sha256,
            "seed": options.seed,
            "options": {**more, **asdict(options), "palette": [list(colour) for colour in options.palette]},
        }
    )


def metrics_of(painting: Painting, layout: Layout) -> Metrics | None:
    """How near the painting, as its file orders it, comes to the picture over the picture's area, if there is one."""
    return _beside_the_picture(preview(painting, layout.canvas), layout)


@one_torch_thread()
def with_metrics(painting: Painting, layout: Layout, problem: PlanningProblem) -> Painting:
    """The painting with what became of it in its file: likeness, the `loss`, and what each term of it comes to."""
    painted = preview(painting, layout.canvas)
    canvas = _channels_first(painted).to(problem.paper)
    with torch.no_grad():
        terms = {each.term.name: each.weight * each.term.loss(canvas, 1.0).item() for each in problem.objectives}
        for network_loss in problem.network_losses:
            losses = network_loss.term.losses(canvas, range(min(_LOOKS, network_loss.term.views)))
            terms[network_loss.term.name] = network_loss.weight * losses.mean().item()
    likeness = _beside_the_picture(painted, layout)
    found = {} if likeness is None else {name: x for name, x in asdict(likeness).items() if isfinite(x)}
    made = painting.provenance.model_copy(update={"metrics": {**found, **terms, "loss": sum(terms.values())}})
    return painting.model_copy(update={"provenance": made})


def _beside_the_picture(painted: Image, layout: Layout) -> Metrics | None:
    return None if layout.target is None else compare(layout.crop(painted), layout.crop(layout.target))


def as_painting(
    planned: PlanResult, layout: Layout, brush: Brush, style: Style, made: Provenance, names: Mapping[str, str] = {}
) -> Painting:
    """A plan as a painting, whose file says all that planning it again needs.

    names: of paints, by their colours as ``#rrggbb``.
    """
    codes = planned.strokes.codes
    poses = planned.strokes.poses(style.decode(codes))
    trajectories = planned.strokes.trajectories(style)
    trajectories[..., 2].clamp_(0, 1)
    speeds = style.speeds(codes)
    timed = [None] * len(codes) if speeds is None else speeds.tolist()
    used = torch.unique(planned.paint_of)
    paint_of = torch.searchsorted(used, planned.paint_of)
    strokes = [
        Stroke.model_validate(
            {
                "id": number,
                "paint": paint,
                "trajectory": trajectory,
                "speed": speed,
                "style": StyleUse(name=style.name, hash=style.hash, code=tuple(code), pose=tuple(pose)),
            }
        )
        for number, (paint, trajectory, speed, code, pose) in enumerate(
            zip(paint_of.tolist(), trajectories.tolist(), timed, codes.tolist(), poses.tolist(), strict=True)
        )
    ]
    colours = [tuple(colour) for colour in planned.paints[used].tolist()]
    paints = [Paint(colour=colour, brush=brush.name, name=names.get(hex_colour(colour))) for colour in colours]
    return Painting(
        sheet=layout.sheet,
        area=layout.area,
        provenance=made,
        brushes={brush.name: brush},
        paints=tuple(paints),
        strokes=tuple(strokes),
    )
