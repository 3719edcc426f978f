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
from maulstick.jobs.plan.options import Job, sum_of
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Making, Sheet, hex_colour
from maulstick.painting.picture import canvas_photograph, encode_png, read_picture
from maulstick.painting.raster import Canvas, parse_size
from maulstick.planning.features.efficientnet import EfficientNetLite0
from maulstick.planning.features.network import Network
from maulstick.planning.from_picture import commission_of, making
from maulstick.planning.layout import LONGEST_PX, Image, Layout, canvas_for, lay_out_for
from maulstick.planning.losses import Wishes
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.windows import Mural
from maulstick.planning.planner import Plan, Progress, plan
from maulstick.planning.problem import Commission, PlanOptions
from maulstick.planning.state import State
from maulstick.style import Style, load_style

_READ_PX = 4096
_SHEET_PX, _WIDEST_SHEET_PX = 1024, 2048


@dataclass(frozen=True)
class Prepared:
    """All that planning and its file need; names: of the paints, by their colours as ``#rrggbb``."""

    job: Job
    layout: Layout
    brush: Brush
    style: Style
    options: PlanOptions
    commission: Commission
    made: Making
    names: dict[str, str]
    mural: Mural | None
    wishes: Wishes
    network: Callable[[], Network]

    def plan(self, watch: Callable[[Progress], bool], resume: State | None) -> Plan:
        """Plan it, in windows where it is large."""
        if self.mural is None:
            return plan(self.commission, self.options, watch, resume=resume)
        return plan_mural(
            self.mural,
            self.brush,
            self.style,
            self.options,
            watch,
            wishes=self.wishes,
            network=self.network,
            resume=resume,
        )

    def weighed(self, weights: Mapping[str, float]) -> "Prepared":
        """The same with other weights of the terms. Raises InputError for weights that cannot be."""
        wishes = replace(self.wishes, weights=weights)
        told = wishes.weights_of_terms(has_picture=self.layout.target is not None)
        made = self.made.model_copy(update={"options": {**self.made.options, "weights": told}})
        commission = commission_of(self.layout, self.brush, self.style, self.options, wishes, self.network)
        return replace(self, wishes=wishes, made=made, commission=commission)


def prepare(job: Job) -> Prepared:
    """Read all files of the job. Raises InputError for the first that cannot be used, and where words contradict."""
    brush, sheet = load_brush(job.brush), _sheet(job)
    if job.press is not None:
        brush = brush.held_at(job.press)
    tubes = read_paints(job.paints_from) if job.paints_from is not None else ()
    if len(tubes) > job.strokes:
        raise InputError.of_range("the number of paints", len(tubes), f"at most the {job.strokes} strokes")
    options = _options(job, tubes)
    picture = read_picture(job.photo, longest_px=_READ_PX) if job.photo is not None else None
    mural = _mural(job, picture, sheet, brush)
    layout = lay_out_for(picture, sheet, brush, job.fit, job.px) if mural is None else mural.overview(LONGEST_PX)
    style = load_style(job.style, layout.canvas)
    look = read_picture(job.look, longest_px=_SHEET_PX) if job.look is not None else None
    asks_clip = {"likeness": 1.0} if job.names_clip and job.photo is not None else {}
    wishes = Wishes(job.text, look, {**asks_clip, **job.weigh})
    known = {"Maulstick": version("maulstick"), "the brush": sum_of(brush.model_dump(mode="json"))}
    job = job.with_sums({**known, "the style": style.hash})
    network = cache(partial(_network, job))
    commission = commission_of(layout, brush, style, options, wishes, network)
    if job.names_clip and not commission.judges:
        raise InputError("--clip says which network to ask, and no term asks one; leave it out, or weigh likeness")
    weights = wishes.weights_of_terms(has_picture=picture is not None)
    untold = ("photo", "weigh", "sums", "frames")
    words = {name: value for name, value in job.as_json().items() if name not in untold}
    asked = {name: vars(job)[name].name if isinstance(vars(job)[name], Path) else words[name] for name in words}
    name, sha256 = (job.photo.name, job.sums[str(job.photo)]) if job.photo is not None else (None, None)
    used = {"brush": brush.name, "style": style.name, "weights": dict(weights)}
    made = making(options, name, sha256, {**asked, **used})
    names = {hex_colour(tube.colour): tube.name for tube in tubes}
    return Prepared(job, layout, brush, style, options, commission, made, names, mural, wishes, network)


def _mural(job: Job, picture: Image | None, sheet: Sheet, brush: Brush) -> Mural | None:
    """Where the canvas is too large to be planned in one piece."""
    canvas = canvas_for(picture, sheet, brush, job.fit, job.px)
    if max(canvas.width_px, canvas.height_px) <= LONGEST_PX:
        return None
    if picture is None or job.text is not None:
        raise InputError(f"a text is planned in one piece, of at most {LONGEST_PX} pixels; choose a smaller --px")
    return Mural(picture, sheet, canvas, job.fit)


def _options(job: Job, tubes: tuple[NamedPaint, ...]) -> PlanOptions:
    palette = tuple(tube.colour for tube in tubes) or (parse_colour(job.ink or "black"),)
    paints = None if job.ink is not None or tubes else job.paints
    return PlanOptions(job.strokes, job.exact, paints, palette, job.steps, job.ask_every, job.seed)


def _sheet(job: Job) -> Sheet:
    width, height = parse_size(job.size)
    if job.canvas is None:
        return Sheet(width=width, height=height, paper=parse_colour(job.paper))
    canvas = Canvas(width, height, min(_SHEET_PX / height, _WIDEST_SHEET_PX / width))
    photograph = canvas_photograph(job.canvas, canvas)
    edge = np.concatenate([photograph[0], photograph[-1], photograph[:, 0], photograph[:, -1]])
    paper = tuple(np.median(edge, axis=0).tolist())
    return Sheet(width=width, height=height, paper=paper, picture=encode_png(photograph))


def _network(job: Job) -> Network:
    if not job.names_clip and job.text is None:
        return EfficientNetLite0()
    from maulstick.planning.features.clip import Clip  # takes seconds to load

    return Clip.load(job.clip or "RN101", job.clip_weights, layers=job.clip_layers)
