"""Planning again: the locked strokes of a painting stay as they are, and the others are planned on from where they are.

Its sheet, its brushes and its paints stay too, since they may be mixed already. With a photograph of the sheet the rest
is planned over what is on it: what a machine has painted, and what a person has painted since.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isclose
from pathlib import Path
from typing import Self

import numpy as np
import torch
from pydantic import JsonValue

from maulstick.colour.palette import parse_colour
from maulstick.errors import InputError, option
from maulstick.jobs.plan.inputs import not_a_paint
from maulstick.jobs.plan.options import PlanOptions, colours_in
from maulstick.painting.brush import Brush, in_painting_order
from maulstick.painting.painting import Painting, Sheet, Stroke, hex_colour
from maulstick.painting.painting_file import read_painting
from maulstick.planning.parameters import StrokeParameters
from maulstick.planning.problem import Colour, Neighbours, PlannerSettings, PlanningProblem
from maulstick.planning.regions import Regions
from maulstick.planning.result import PlanResult
from maulstick.robot.journal import Journal, latest_journal
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted
from maulstick.strokes.strokes import resampled, standardise
from maulstick.style.pressure import fit_knots


@dataclass(frozen=True)
class Again:
    """Painting that is planned again. Raises InputError for a drawing, which nobody planned, and without any paint.

    painted: number of its strokes that are on the sheet, and were left out of it.
    """

    painting: Painting
    painted: int = 0

    @classmethod
    def of(cls, options: PlanOptions) -> Self | None:
        """Return the painting of the options, or None where they ask for a new one."""
        if options.again is None:
            return None
        return cls(read_painting(options.again)) if options.background is None else cls.on_paper(options.again)

    @classmethod
    def on_paper(cls, file: Path) -> Self:
        """Return what is left of a painting by its journal, which lies beside it; all of it where there is none.

        Raises InputError for a journal that cannot be read, or was begun with another painting.
        """
        if (latest := latest_journal(file)) is None:
            return cls(read_painting(file))
        try:
            journal = Journal.read(latest)
            painting = read_painting(journal.painting())
        except InputError as error:
            raise InputError(f"{error.fault}; move the journal away, and all strokes count as not painted") from error
        left = tuple(stroke for stroke in painting.strokes if stroke.id not in journal.painted)
        return cls(painting.model_copy(update={"strokes": left}), len(painting.strokes) - len(left))

    def __post_init__(self) -> None:
        if self.painting.literal:
            raise InputError("the painting was not planned, so it cannot be planned again; name a plan's")
        if not self.painting.paints:  # as of a picture that the bare sheet shows
            raise InputError("the painting has no stroke, and so no paint to plan it again with; plan anew")

    @property
    def left(self) -> list[Stroke]:
        """Strokes that are planned on, in painting order."""
        return [stroke for stroke in self.painting.strokes if not stroke.locked]

    def brushes(self, named: Sequence[Brush]) -> tuple[Brush, ...]:
        """Return the painting's brushes, and those that are named and not among them, the broadest first."""
        own = self.painting.brushes
        return in_painting_order([*own.values(), *(brush for brush in named if brush.name not in own)])

    def usual(self, named: Sequence[Brush]) -> tuple[Brush, ...]:
        """Return the brushes where a region says none: the painting's that were so before, and those that are named.

        Raises InputError where one is named beside that of a painting in ink.
        """
        own, said = self.painting.brushes, self.painting.provenance.options.get("brush")
        before = own if not isinstance(said, str) else [name for name in own if name in said.split(",")]
        more = [brush for brush in named if brush.name not in before]
        if more and before and is_in_ink(self.painting):
            raise InputError(
                f"the painting is drawn in ink with {','.join(before)}, and ink is drawn with one brush; name that "
                f"one with {option('brush')}, or plan anew"
            )
        return in_painting_order([*(own[name] for name in before), *more])

    def check_pressure(self, options: PlanOptions) -> None:
        """Raise InputError where a machine would hold a brush of the painting that it paints with any pressure."""
        varying = [brush.name for brush in self.painting.brushes.values() if brush.pressure_matters]
        if varying and options.held_pressure is not None:
            raise InputError(
                f"this machine only lifts its pen, and the painting presses its brush {varying[0]} more and less; "
                f"leave out {option('robot')}, or plan anew"
            )

    def check_guides(self, guides: Path | None, painted: str | None) -> None:
        """Raise InputError for guides to be painted, known by their sum, that are not those of the painting."""
        if painted is None or guides is None:
            return
        options = self.painting.provenance.options
        if "painted_guides" in options:
            are_others = options["painted_guides"] != painted
        else:  # older paintings know only the file's name
            are_others = options.get("guides") != guides.name
        if are_others:
            raise InputError(
                "lines on a layer called paint are painted with a new plan; add them to the painting as strokes, and "
                "leave that layer out"
            )

    def sheet(self, asked: Sheet) -> Sheet:
        """Return the painting's sheet, or its photograph. Raises InputError where one of another size is asked for."""
        own = self.painting.sheet
        if not (isclose(asked.width, own.width) and isclose(asked.height, own.height)):
            raise InputError(
                f"the painting is on a sheet of {own.millimetres}, and {option('size')} asks for {asked.millimetres}; "
                "give the size of the painting, or plan anew"
            )
        return own if asked.picture is None else own.model_copy(update={"paper": asked.paper, "picture": asked.picture})

    @property
    def names(self) -> dict[str, str]:
        """Names of its paints, by their colours as ``#rrggbb``."""
        return {paint.hex: paint.name for paint in self.painting.paints if paint.name is not None}

    @property
    def settled(self) -> dict[str, JsonValue]:
        """Options that stay as the painting has them, whatever is asked for: its inks, and its painted guides."""
        options = self.painting.provenance.options
        guides = {"painted_guides": options["painted_guides"]} if "painted_guides" in options else {}
        return {"ink": options.get("ink"), **guides}

    def in_paints(self, settings: PlannerSettings) -> PlannerSettings:
        """Return the settings with the painting's paints, or its inks."""
        in_colours = not is_in_ink(self.painting)
        return replace(settings, paints=None, palette=palette_of(self.painting), pinned=(), in_colours=in_colours)

    def check_regions(self, regions: Regions) -> None:
        """Raise InputError for a region whose colours are none of the painting's paints."""
        paints, every = np.array(palette_of(self.painting)), torch.arange(len(regions.said))
        for region, allowed in zip(regions.said, regions.allowed_paints(every, paints), strict=True):
            if region.colours is not None and not allowed.any():
                raise not_a_paint(region.colours[0])

    def settings(self, settings: PlannerSettings) -> PlannerSettings:
        """Return the settings for those of the strokes asked for that are not locked.

        Strokes are taken out where fewer are asked for than before. Those that a person has added since take none out.
        """
        locked, before = len(locked_in(self.painting)), self.painting.provenance.options.get("strokes")
        strokes, there = settings.strokes - self.painted - locked, self.painted + len(self.painting.strokes)
        if settings.strokes >= (min(before, there) if isinstance(before, int) else there):
            strokes = max(strokes, len(self.left))
        if strokes < 1:
            every = "" if self.left or self.painted + locked == 1 else "all "
            stay = counted(self.painted + locked, "stroke is", "strokes are")
            raise InputError(
                f"{every}{stay} locked or painted, and {option('strokes')} asks for no more; unlock some, "
                "or ask for more"
            )
        return replace(settings, strokes=strokes)

    def start(self, problem: PlanningProblem) -> StrokeParameters:
        """Return the strokes that are planned on, as they are."""
        return parameters_of(self.left, self.painting, problem)


def palette_of(painting: Painting) -> tuple[Colour, ...]:
    """Return the colours of a painting, each once, and those of its inks that no stroke has, sRGB in [0, 1]."""
    own = dict.fromkeys(paint.colour for paint in painting.paints)
    known, said = {paint.hex for paint in painting.paints}, painting.provenance.options.get("ink")
    inks = map(parse_colour, colours_in(said) if isinstance(said, str) else ())
    return (*own, *(ink for ink in inks if hex_colour(ink) not in known))


def is_in_ink(painting: Painting) -> bool:
    """Return whether a painting was planned in inks; one whose only paint was mixed was not."""
    options = painting.provenance.options
    mixed = options.get("paints") is not None or options.get("in_colours") is True
    return (len(palette_of(painting)) == 1 or options.get("ink") is not None) and not mixed


def locked_in(painting: Painting) -> list[Stroke]:
    """Return the strokes of a painting that stay, in painting order."""
    return [stroke for stroke in painting.strokes if stroke.locked]


def parameters_of(strokes: Sequence[Stroke], painting: Painting, problem: PlanningProblem) -> StrokeParameters:
    """Return strokes of a painting as parameters of the problem's style, each as the hand of its place draws it.

    One that is not of that hand is taken as nearly as the hand can draw it, and one whose brush is not used at its
    place gets the one there that is nearest in width.
    """
    paths, style, regions = _paths(strokes), problem.style, problem.regions
    standard, poses = standardise(paths[..., :2])
    centres, standardised = torch.from_numpy(paths[..., :2].mean(axis=1)).float(), torch.from_numpy(standard).float()
    there = torch.zeros(len(strokes), dtype=torch.long) if regions is None else regions.at(centres)
    codes = style.encode(standardised) if regions is None else regions.style.encode_in(there, standardised)
    codes = codes.detach()
    for row, (stroke, region) in enumerate(zip(strokes, there.tolist(), strict=True)):
        hand = style if regions is None else regions.said[region].hand
        if stroke.style is not None and stroke.style.hash == hand.hash:
            own = torch.tensor([stroke.style.code])
            codes[row] = own[0] if regions is None else regions.style.codes_in(region, own)[0]
            poses[row] = stroke.style.pose
    return StrokeParameters(
        codes=codes,
        centres=centres,
        angles=torch.from_numpy(poses[:, 2]).float(),
        pressure_knots=torch.from_numpy(fit_knots(paths[..., 2])).float(),
        colours=_colours(strokes, painting),
        brush_of=_used_there(_brushes(strokes, painting, problem.brushes), there, problem),
    )


def neighbours_of(strokes: Sequence[Stroke], painting: Painting, brushes: Sequence[Brush]) -> Neighbours:
    """Return strokes of a painting as neighbours that planning does not change."""
    return Neighbours(
        torch.from_numpy(_paths(strokes)).float(),
        _colours(strokes, painting),
        _brushes(strokes, painting, brushes),
    )


def with_locked(planned: Painting, locked: Sequence[Stroke], before: Painting, result: PlanResult) -> Painting:
    """Return a painting that was planned with locked strokes of the one `before` it, in the places of the result.

    Locked strokes keep their ids, and the planned ones get new ones.
    """
    paints, numbers = list(planned.paints), {}
    for stroke in locked:
        paint = before.paints[stroke.paint]
        if paint not in paints:
            paints.append(paint)
        numbers[stroke.id] = paints.index(paint)
    free = 1 + max((stroke.id for stroke in before.strokes), default=-1)
    rest = [stroke.model_copy(update={"id": free + row}) for row, stroke in enumerate(planned.strokes)]
    kept = [stroke.model_copy(update={"paint": numbers[stroke.id]}) for stroke in locked]
    places = np.concatenate([np.arange(len(rest)) + 0.5, result.before.numpy()])
    order = np.argsort(places, kind="stable").tolist()
    both = [*rest, *kept]
    brushes = {paint.brush: {**before.brushes, **planned.brushes}[paint.brush] for paint in paints}
    return planned.model_copy(
        update={"paints": tuple(paints), "brushes": brushes, "strokes": tuple(both[row] for row in order)}
    )


def in_paints_of(planned: Painting, before: Painting) -> Painting:
    """Return a painting in all paints of the one `before` it, with their numbers; those that are new come last."""
    paints = [*before.paints, *(paint for paint in planned.paints if paint not in before.paints)]
    numbers = [paints.index(paint) for paint in planned.paints]
    strokes = tuple(stroke.model_copy(update={"paint": numbers[stroke.paint]}) for stroke in planned.strokes)
    brushes = {**before.brushes, **planned.brushes}
    return planned.model_copy(update={"paints": tuple(paints), "brushes": brushes, "strokes": strokes})


def _paths(strokes: Sequence[Stroke]) -> Floats:
    """Return commanded trajectories (N, 32, 3): those that have another number of points, resampled."""
    return resampled(np.array(stroke.trajectory) for stroke in strokes)


def _colours(strokes: Sequence[Stroke], painting: Painting) -> torch.Tensor:
    return torch.tensor([painting.paints[stroke.paint].colour for stroke in strokes]).reshape(-1, 3)


def _brushes(strokes: Sequence[Stroke], painting: Painting, brushes: Sequence[Brush]) -> torch.Tensor:
    used = [painting.brushes[painting.paints[stroke.paint].brush] for stroke in strokes]
    return torch.tensor([brushes.index(brush) for brush in used], dtype=torch.long)


def _used_there(brush_of: torch.Tensor, there: torch.Tensor, problem: PlanningProblem) -> torch.Tensor:
    """Return brushes (N,), those that regions (N,) do not use as those that they do, the nearest in width."""
    if problem.regions is None:
        return brush_of
    widths = torch.tensor([brush.widest for brush in problem.brushes])
    used = torch.tensor([region.brushes for region in problem.regions.said])[there]
    away = (widths - widths[brush_of][:, None]).abs().masked_fill(~used, torch.inf)
    return torch.where(used[torch.arange(len(brush_of)), brush_of], brush_of, away.argmin(dim=1))
