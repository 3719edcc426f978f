"""Preparation of a plan: the files of a request are read and checked; nothing is planned yet."""

from dataclasses import replace
from functools import partial
from importlib.metadata import version

from pydantic import JsonValue

from maulstick.colour.palette import parse_colour
from maulstick.colour.tubes import NamedPaint, read_paints
from maulstick.errors import InputError, option
from maulstick.jobs.plan.again import Again, locked_in, neighbours_of
from maulstick.jobs.plan.device import choose_device
from maulstick.jobs.plan.directing import Directing
from maulstick.jobs.plan.inputs import SHEET_PX, enough, held, mural_of, network_of, picture_of, settings_of, sheet_of
from maulstick.jobs.plan.options import AUTO, PlanOptions
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest, sum_of
from maulstick.jobs.plan.window_pool import workers_for
from maulstick.painting.brush import Brush, finest_of, load_brushes, names_of
from maulstick.painting.painting import hex_colour
from maulstick.painting.picture import read_picture
from maulstick.painting.raster import parse_margin
from maulstick.planning.features.network import LoadedOnce
from maulstick.planning.from_picture import problem_of, provenance_of
from maulstick.planning.layout import LONGEST_PX, Layout, lay_out_for
from maulstick.planning.lines import lines_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.regions import Regions
from maulstick.planning.room import check_room
from maulstick.planning.tones import InkSupply, draw_light
from maulstick.storage.arrays import Image
from maulstick.storage.text import counted
from maulstick.style import Style, load_style


def prepare(
    request: PlanRequest,
    image: Image | None = None,
    *,
    brushes: tuple[Brush, ...] = (),
    style: Style | None = None,
    again: Again | None = None,
) -> Prepared:
    """Return what planning needs, from the files of a request.

    image: the picture, (H, W, 3), sRGB in [0, 1], where it is in memory and not in a file that the request names.
    brushes, style, again: replace those that the options name.
    Raises InputError for the first file that cannot be used, and for contradictions.
    """
    request.options.check_counted()
    options, device = request.options, choose_device(request.options.device)
    again, picture = again or Again.of(options), picture_of(request, image)
    sheet = sheet_of(options, picture)
    margin = parse_margin(options.margin, (sheet.width, sheet.height))
    directing = Directing(options, (sheet.height, sheet.width) if picture is None else picture.shape, margin)
    usual = brushes or load_brushes(options.brush, None if again is None else again.painting.brushes)
    if again is not None:
        usual = again.usual(usual)
    brushes, is_held = _held(directing.brushes(usual), options)
    if again is not None:
        again.check_pressure(options)
        again.check_guides(options.guides, directing.painted_sum)
        brushes, sheet = again.brushes(brushes), again.sheet(sheet)
    finest = finest_of(brushes)
    if options.drawing == "lines":
        if picture is None:
            raise InputError(f"{option('drawing')} lines draws those of a picture; name one, or leave it out")
        light = draw_light(tuple(parse_colour(ink) for ink in options.inks), sheet.paper)
        picture = lines_for(picture, sheet, finest, options.fit, margin, light=light)
    mural = mural_of(options, picture, sheet, finest, margin)
    workers = workers_for(request.workers, device.device, has_windows=mural is not None)
    if mural is None:
        layout = lay_out_for(picture, sheet, finest, options.fit, options.px, margin)
    else:
        _check_windows(again, directing)
        layout = mural.overview(LONGEST_PX)
    check_room(layout.room, brushes)
    hand = style or load_style(options.style, layout.canvas)
    style = hand.scaled(options.hand_size)
    regions = directing.regions(layout, hand, options.hand_size, brushes, usual)
    tubes = _tubes(options)
    colours = directing.colours, directing.painted_colours(layout, finest, regions)
    settings = settings_of(options, tubes, *colours, are_mixed=again is not None)
    if again is not None:
        settings = again.in_paints(settings)
    supply = _supply(options, settings, layout, brushes, usual, style, regions) if settings.in_ink else None
    if options.strokes == AUTO:
        settings = replace(settings, strokes=enough(supply))
    names = {hex_colour(tube.colour): tube.name for tube in tubes}
    if again is None:
        kept = directing.painted(layout, finest, settings.pinned or settings.palette, names, regions)
    else:
        settings, names, kept = again.settings(settings), again.names, again.painting
    locked = [] if kept is None else locked_in(kept)
    tones = None if supply is None else supply.tones(settings.strokes + len(locked))
    if again is not None and regions is not None:
        again.check_regions(regions)
    loss_options, network = _losses(options, picture), LoadedOnce(partial(network_of, options))
    problem = problem_of(
        layout,
        brushes,
        style,
        settings,
        loss_options,
        network,
        device=device.device,
        tones=tones,
        regions=regions,
    )
    problem = replace(problem, guides=directing.guides(layout, regions))
    if kept is not None:
        problem = replace(problem, neighbours=neighbours_of(locked, kept, brushes))
    if options.names_clip and not problem.network_losses:
        clip = option("clip")
        raise InputError(f"{clip} says which network to ask, and no term asks one; leave it out, or weigh likeness")
    request = request.with_sums(
        {
            "Maulstick": version("maulstick"),
            "the brush": sum_of([brush.model_dump(mode="json") for brush in brushes]),
            "the style": problem.style.hash,
        }
    )
    weights = loss_options.weights_to_keep(has_picture=picture is not None)
    used = {"brush": names_of(usual), "style": style.name, "weights": weights, "device": device.device.type}
    of_guides: dict[str, JsonValue] = {"painted_guides": directing.painted_sum} if options.guides else {}
    settled = of_guides if again is None else again.settled
    name = request.picture.name if request.picture is not None else None
    sha256 = request.sums[str(request.picture)] if request.picture is not None else None
    of_all = replace(settings, strokes=settings.strokes + len(locked))
    provenance = provenance_of(of_all, name, sha256, {**request.provenance_options, **used, **settled})
    return Prepared(
        request,
        layout,
        brushes,
        style,
        settings,
        problem,
        provenance,
        names,
        mural,
        workers,
        loss_options,
        network,
        device,
        supply,
        is_held,
        again,
        kept,
    )


def _held(brushes: tuple[Brush, ...], options: PlanOptions) -> tuple[tuple[Brush, ...], bool]:
    """Return the brushes, held where the options say so, and whether one is since its machine only lifts its pen."""
    kept = tuple(held(brush, options) for brush in brushes)
    changed = any(was.pressure_matters != now.pressure_matters for was, now in zip(brushes, kept, strict=True))
    return kept, options.pressure is None and changed


def _tubes(options: PlanOptions) -> tuple[NamedPaint, ...]:
    """Return the paints of a file. Raises InputError for two of one colour, and for more than strokes."""
    tubes = read_paints(options.paints_from) if options.paints_from is not None else ()
    if options.again is not None:
        return tubes
    if options.strokes != AUTO and len(tubes) > options.strokes:
        raise InputError.of_range(
            "the number of paints", len(tubes), f"at most the {counted(options.strokes, 'stroke')}"
        )
    names: dict[str, str] = {}
    for tube in tubes:
        colour = hex_colour(tube.colour)
        if (other := names.setdefault(colour, tube.name)) != tube.name:
            raise InputError(
                f"{options.paints_from}: {other!r} and {tube.name!r} are both {colour}, and a painting tells its "
                "paints by colour; leave out one of them"
            )
    return tubes


def _losses(options: PlanOptions, picture: Image | None) -> LossOptions:
    look = read_picture(options.look, longest_px=SHEET_PX) if options.look is not None else None
    clip_weights = {"likeness": 1.0} if options.names_clip and picture is not None else {}
    return LossOptions(options.text, look, {**clip_weights, **options.weights}, options.drawing != "tones")


def _check_windows(again: Again | None, directing: Directing) -> None:
    """Raise InputError for what is not planned in windows."""
    if again is not None:
        raise InputError(f"{option('again')} plans in one piece; choose a smaller {option('px')}")
    directing.check_windows()


def _supply(
    options: PlanOptions,
    settings: PlannerSettings,
    layout: Layout,
    brushes: tuple[Brush, ...],
    usual: tuple[Brush, ...],
    style: Style,
    regions: Regions | None,
) -> InkSupply | None:
    """Return the supply of inks. Raises InputError for several brushes, of which the usual ones are not of regions."""
    if len(brushes) > 1 == len(usual):
        of_regions = names_of(brush for brush in brushes if brush.name != usual[0].name)
        raise InputError(
            f"regions ask for {of_regions} beside {usual[0].name}, and ink is drawn with one brush; let them have "
            "that one, or paint in colours"
        )
    if len(brushes) > 1:
        raise InputError(
            f"{option('brush')} {names_of(brushes)} names several, and ink is drawn with one; name one, or "
            "paint in colours"
        )
    with_lines = options.drawing == "both"
    return InkSupply.of(layout, brushes[0], style, settings.palette, with_lines=with_lines, regions=regions)
