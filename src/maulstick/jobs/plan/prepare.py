"""From what was asked to what the planner is asked: files are read, and nothing is planned yet."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib.metadata import version
from pathlib import Path

import numpy as np

from maulstick.colour.palette import parse_colour
from maulstick.colour.tubes import NamedPaint, read_paints
from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanRequest, sum_of
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Provenance, Sheet, hex_colour
from maulstick.painting.picture import canvas_photograph, encode_png, read_picture
from maulstick.painting.raster import Canvas, parse_size
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import making, problem_of
from maulstick.planning.layout import LONGEST_PX, Layout, canvas_for, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import PlanProgress, PlanResult, plan
from maulstick.planning.problem import PlannerSettings, PlanningProblem
from maulstick.planning.state import State
from maulstick.storage.arrays import Image
from maulstick.style import Style, load_style

_READ_PX = 4096
_SHEET_PX, _WIDEST_SHEET_PX = 1024, 2048


@dataclass(frozen=True)
class Prepared:
    """All that planning and its file need; names: of the paints, by their colours as ``#rrggbb``."""

    request: PlanRequest
    layout: Layout
    brush: Brush
    style: Style
    options: PlannerSettings
    problem: PlanningProblem
    made: Provenance
    names: dict[str, str]
    mural: Mural | None
    loss_options: LossOptions
    network: Callable[[], Network]

    def plan(self, watch: Callable[[PlanProgress], bool], resume: State | None) -> PlanResult:
        """Plan it, in windows where it is large."""
        if self.mural is None:
            return plan(self.problem, self.options, watch, resume=resume)
        return plan_mural(
            self.mural,
            self.brush,
            self.style,
            self.options,
            watch,
            loss_options=self.loss_options,
            network=self.network,
            resume=resume,
        )

    def weighed(self, weights: Mapping[str, float]) -> "Prepared":
        """The same with other weights of the terms. Raises InputError for weights that cannot be."""
        loss_options = replace(self.loss_options, weights=weights)
        told = loss_options.weights_of_terms(has_picture=self.layout.target is not None)
        made = self.made.model_copy(update={"options": {**self.made.options, "weights": told}})
        problem = problem_of(self.layout, self.brush, self.style, self.options, loss_options, self.network)
        return replace(self, loss_options=loss_options, made=made, problem=problem)


def prepare(request: PlanRequest) -> Prepared:
    """Read all files of the job. Raises InputError for the first that cannot be used, and where words contradict."""
    brush, sheet = load_brush(request.brush), _sheet(request)
    if request.pressure is not None:
        brush = brush.held_at(request.pressure)
    tubes = read_paints(request.paints_from) if request.paints_from is not None else ()
    if len(tubes) > request.strokes:
        raise InputError.of_range("the number of paints", len(tubes), f"at most the {request.strokes} strokes")
    options = _options(request, tubes)
    picture = read_picture(request.photo, longest_px=_READ_PX) if request.photo is not None else None
    mural = _mural(request, picture, sheet, brush)
    layout = (
        lay_out_for(picture, sheet, brush, request.fit, request.px) if mural is None else mural.overview(LONGEST_PX)
    )
    style = load_style(request.style, layout.canvas)
    look = read_picture(request.look, longest_px=_SHEET_PX) if request.look is not None else None
    asks_clip = {"likeness": 1.0} if request.names_clip and request.photo is not None else {}
    loss_options = LossOptions(request.text, look, {**asks_clip, **request.weights})
    known = {"Maulstick": version("maulstick"), "the brush": sum_of(brush.model_dump(mode="json"))}
    request = request.with_sums({**known, "the style": style.hash})
    network = cache(partial(_network, request))
    problem = problem_of(layout, brush, style, options, loss_options, network)
    if request.names_clip and not problem.network_losses:
        raise InputError("--clip says which network to ask, and no term asks one; leave it out, or weigh likeness")
    weights = loss_options.weights_of_terms(has_picture=picture is not None)
    untold = ("photo", "weigh", "sums", "frames")
    words = {name: value for name, value in request.as_json().items() if name not in untold}
    asked = {name: vars(request)[name].name if isinstance(vars(request)[name], Path) else words[name] for name in words}
    name, sha256 = (request.photo.name, request.sums[str(request.photo)]) if request.photo is not None else (None, None)
    used = {"brush": brush.name, "style": style.name, "weights": dict(weights)}
    made = making(options, name, sha256, {**asked, **used})
    names = {hex_colour(tube.colour): tube.name for tube in tubes}
    return Prepared(request, layout, brush, style, options, problem, made, names, mural, loss_options, network)


def _mural(request: PlanRequest, picture: Image | None, sheet: Sheet, brush: Brush) -> Mural | None:
    """Where the canvas is too large to be planned in one piece."""
    canvas = canvas_for(picture, sheet, brush, request.fit, request.px)
    if max(canvas.width_px, canvas.height_px) <= LONGEST_PX:
        return None
    if picture is None or request.text is not None:
        raise InputError(f"a text is planned in one piece, of at most {LONGEST_PX} pixels; choose a smaller --px")
    return Mural(picture, sheet, canvas, request.fit)


def _options(request: PlanRequest, tubes: tuple[NamedPaint, ...]) -> PlannerSettings:
    palette = tuple(tube.colour for tube in tubes) or (parse_colour(request.ink or "black"),)
    paints = None if request.ink is not None or tubes else request.paints
    return PlannerSettings(
        request.strokes, request.exact, paints, palette, request.steps, request.ask_every, request.seed
    )


def _sheet(request: PlanRequest) -> Sheet:
    width, height = parse_size(request.size)
    if request.canvas is None:
        return Sheet(width=width, height=height, paper=parse_colour(request.paper))
    canvas = Canvas(width, height, min(_SHEET_PX / height, _WIDEST_SHEET_PX / width))
    photograph = canvas_photograph(request.canvas, canvas)
    edge = np.concatenate([photograph[0], photograph[-1], photograph[:, 0], photograph[:, -1]])
    paper = tuple(np.median(edge, axis=0).tolist())
    return Sheet(width=width, height=height, paper=paper, picture=encode_png(photograph))


def _network(request: PlanRequest) -> Network:
    if not request.names_clip and request.text is None:
        return EfficientNetLite0()
    from maulstick.planning.features.clip import Clip  # takes seconds to load

    return Clip.load(request.clip or "RN101", request.clip_weights, layers=request.clip_layers)
