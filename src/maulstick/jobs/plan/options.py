"""Options of a plan: one set of defaults and checks for the command line, the studio and Python."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from math import ceil
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from pydantic import ConfigDict

from maulstick.errors import InputError, option
from maulstick.kinds import check_kinds, check_whole
from maulstick.painting.edit import WHOLE, Crop, PictureEdit
from maulstick.painting.fit import FITS
from maulstick.painting.picture import READ_PX
from maulstick.painting.raster import is_turned_by_picture, parse_margin, parse_sheet
from maulstick.planning.weights import check_weights
from maulstick.robot.machines import only_lifts
from maulstick.storage.library import all_placed, placed
from maulstick.storage.text import counted

MOST_SEED: Final = 2**32 - 1
"""Largest seed that all generators of random numbers take."""

DEVICES: Final = ("auto", "cpu", "cuda")
"""What may plan: the processor, a GPU, or a GPU where one is trusted."""

AUTO: Final = "auto"
"""Number of strokes that is found from the picture's ink."""

DRAWINGS: Final = ("both", "lines", "tones")
"""What ink draws of a picture: contours and tones, the lines that carry it, or tones alone."""

FILES: Final = ("background", "again", "regions", "say", "guides", "look", "paints_from", "clip_weights")
"""Options that are paths of files."""

MOST_INKS: Final = 12
"""Inks of one plan; of more it takes long to find out how much the picture needs of each."""

MOST_AUTO: Final = 10_000
"""Most strokes that are chosen for a picture: more would take a plotter days."""

MOST_STROKES: Final = 100_000
"""Strokes of one plan; more would fill the memory of a usual computer."""

LEAST_HAND: Final = 0.02
"""Least times a hand's size: a stamp."""

LARGEST_HAND: Final = 50.0
"""Most times a hand's size: a wall."""

USUAL_PRESSURE: Final = 0.5
"""Pressure of a brush on a machine that only lifts it: half as deep as it goes, for lines of a middle width."""

_USUAL_PAINTS = 12  # paints by default: as many as a person is willing to mix
_MOST_STEPS = 1_000_000  # largest number of steps, which takes hours to days
_FINER = 2  # times as fine as the canvas, as `READ_PX` is for the largest in one piece
_FEWEST_PX, _MOST_PX = 16, 32_768  # pixels over the picture's height: a thumbnail, a mural


@dataclass(frozen=True, kw_only=True)
class PlanOptions:
    """Options of planning a painting; lengths as a person writes them, colours as ``white`` or ``#rrggbb``.

    strokes: at most so many; exactly so many with `exact`; ``auto``, as many as ink needs in a hand, up to 10,000.
    style: a name, or the path of a JSON file.  hand_size: times the size of its strokes.  brush: as style; several,
    as in ``wash,round,fineliner``, paint one after another in colours, the broadest first.
    pressure: holds the brush at one pressure in [0, 1], for machines that only lift their pen.
    robot: the machine that will paint, as `paint` takes it or only its kind, as in ``axidraw``; one that only lifts its
    pen holds the brush at one pressure, 0.5 unless `pressure` says another.
    paints: how many colours to mix, 12 unless there are fewer strokes.  ink: a colour to draw with instead, or several,
    as in ``black,#a04020``, each with a pen of its own.  paints_from: a CSV file of paints to use unmixed instead.
    size: of the sheet, as in ``200x160mm`` or ``A4``, or as ``A4-auto``, turned as the picture.  paper: its colour.
    fit: ``contain`` shows all of the picture, ``cover`` fills all of the sheet.
    margin: paper left bare at each edge of the sheet, as in ``10mm``; with one, no ink leaves the picture's area.
    rotate, straighten, crop, exposure, contrast: corrections of the picture, see `PictureEdit`.
    background: a photograph of the sheet, with what is painted on it so far.
    again: the path of a painting: its locked strokes, its sheet and its paints stay as they are, and its other strokes
    are planned on from where they are.
    regions: a map of the picture in colours, a PNG or an SVG, stretched over it.  say: a TOML file that says what holds
    where the map has each colour: see docs/planning.md.
    guides: an SVG of lines, stretched over the picture, which strokes near them follow; those on its layer ``paint``
    are painted as they are.
    pin: colours among the paints to mix that are used as they are.
    text: what the painting should show; needs CLIP.  look: the path of a picture whose look it should have.
    weights: of the terms of the loss by name, 1 for the usual: tone, edges, likeness, sketch, text, look. Beside them
    `faces`: how much more a face counts in the picture than its surroundings, 1 for the usual, 0 for not at all.
    clip, clip_weights, clip_layers: a CLIP model by name, a file of its weights, which of its layers to compare by.
    drawing: what ink draws: both contours and tones, the lines that carry the picture, or its tones.
    arrange: in [0, 1], how far strokes of ink are arranged as the hand arranges them, where the style knows how.
    steps: of the optimiser.  ask_every: steps between two evaluations of networks.
    px: pixels over the picture's height while planning, by default as many as the brush needs.
    seed: repeats a plan to the bit on one machine.
    device: ``cpu``, ``cuda``, or ``auto``: a GPU by CUDA where one is and draws as the processor does, else that.

    Raises InputError for a value that is out of its range, and for options that contradict each other.

        >>> PlanOptions(strokes=600, style="loops").steps
        500
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    strokes: int | Literal["auto"] = 400
    exact: bool = False
    style: str = "free"
    hand_size: float = 1.0
    brush: str = "round"
    pressure: float | None = None
    robot: str | None = None
    paints: int | None = None
    ink: str | None = None
    paints_from: Path | None = None
    size: str = "200x160mm"
    fit: str = "contain"
    margin: str = "0mm"
    rotate: int = 0
    straighten: float = 0.0
    crop: Crop = WHOLE
    exposure: float = 0.0
    contrast: float = 1.0
    paper: str = "white"
    background: Path | None = None
    again: Path | None = None
    regions: Path | None = None
    say: Path | None = None
    guides: Path | None = None
    pin: tuple[str, ...] = ()
    text: str | None = None
    look: Path | None = None
    weights: Mapping[str, float] = field(default_factory=dict)
    clip: str | None = None
    clip_weights: Path | None = None
    clip_layers: tuple[int, ...] | None = None
    drawing: str = DRAWINGS[0]
    arrange: float = 1.0
    steps: int = 500
    ask_every: int = 4
    px: int | None = None
    seed: int = 0
    device: str = "auto"

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            object.__setattr__(self, name, _plain(value))
        check_kinds(vars(self), {each.name: each.type for each in fields(self)})
        for name in FILES:  # so that a plan can go on from any folder
            if getattr(self, name) is not None:
                object.__setattr__(self, name, Path(getattr(self, name)).absolute())
        object.__setattr__(self, "style", placed(self.style, Path()))
        object.__setattr__(self, "brush", all_placed(self.brush, Path()))
        from maulstick.colour.palette import parse_colour  # loads scikit-image

        if self.strokes != AUTO:
            check_whole("strokes", self.strokes, 1, MOST_STROKES, f"from 1 to {MOST_STROKES}, or {AUTO}")
        if not (isinstance(self.hand_size, int | float) and LEAST_HAND <= self.hand_size <= LARGEST_HAND):
            raise InputError.of_range(option("hand_size"), self.hand_size, f"from {LEAST_HAND} to {LARGEST_HAND}")
        check_whole("steps", self.steps, 1, _MOST_STEPS)
        check_whole("ask_every", self.ask_every, 1, _MOST_STEPS)
        check_whole("seed", self.seed, 0, MOST_SEED)
        if self.px is not None:
            check_whole("px", self.px, _FEWEST_PX, _MOST_PX)
        parse_margin(self.margin, parse_sheet(self.size, None))
        if self.background is not None and is_turned_by_picture(self.size):
            raise InputError(
                f"{option('background')} shows how the sheet lies, and {option('size')} {self.size} turns it as the "
                "picture; leave out -auto"
            )
        object.__setattr__(self, "crop", tuple(self.crop))
        PictureEdit.of(vars(self))
        if self.fit not in FITS:
            raise InputError.of_choice("fit", self.fit, FITS)
        if self.device not in DEVICES:
            raise InputError.of_choice("device", self.device, DEVICES)
        paper = parse_colour(self.paper)
        if self.background is not None and paper != (1.0, 1.0, 1.0):
            raise InputError(
                f"{option('background')} shows the sheet as it is, and {option('paper')} its colour; "
                "leave one of them out"
            )
        inks = [parse_colour(colour) for colour in self.inks]
        if len(inks) > MOST_INKS:
            raise InputError.of_range(f"the number of colours of {option('ink')}", len(inks), f"at most {MOST_INKS}")
        if len(set(inks)) < len(inks):
            raise InputError(f"{option('ink')} {self.ink} names one colour twice; name each once")
        for colour in self.pin:
            parse_colour(colour)
        object.__setattr__(self, "pin", tuple(self.pin))
        if (self.regions is None) != (self.say is None):
            raise InputError(f"{option('regions')} maps regions, and {option('say')} says what holds there; give both")
        self._check_paints()
        if self.pressure is not None and not (isinstance(self.pressure, int | float) and 0 <= self.pressure <= 1):
            allowed = "from 0, just touching, to 1, as deep as the brush goes"
            raise InputError.of_range(option("pressure"), self.pressure, allowed)
        if self.robot is not None:
            only_lifts(self.robot)
        if self.text is not None and not self.text.strip():
            shown = "say what the painting should show, as in 'a sailing boat at dusk'"
            raise InputError(f"{option('text')} is empty; {shown}")
        if self.drawing not in DRAWINGS:
            raise InputError.of_choice("drawing", self.drawing, DRAWINGS)
        if self.drawing != DRAWINGS[0] and self.ink is None:
            raise InputError(f"{option('drawing')} {self.drawing} is for ink; give {option('ink')}, or leave it out")
        if not (isinstance(self.arrange, int | float) and 0 <= self.arrange <= 1):
            raise InputError.of_range(option("arrange"), self.arrange, "from 0, not at all, to 1")
        check_weights(self.weights, {"text": self.text is not None, "look": self.look is not None})

    @property
    def edit(self) -> PictureEdit:
        """Corrections of the picture."""
        return PictureEdit.of(vars(self))

    @property
    def read_px(self) -> int:
        """Longest side of the picture as it is read, pixels, where its shorter one has `least_px` or more."""
        return self.edit.read_px(max(READ_PX, _FINER * (self.px or 0)))

    @property
    def least_px(self) -> int:
        """Least pixels of the picture's shorter side as it is read: a long one is as fine as its canvas, too."""
        return self.edit.read_px(self._covered_px if self.fit == "cover" else self.px or 0)

    @property
    def inks(self) -> tuple[str, ...]:
        """Colours of the inks to draw with, as they are said; none where it is painted."""
        return () if self.ink is None else colours_in(self.ink)

    @property
    def mixed_paints(self) -> int | None:
        """Number of colours that are mixed; None where inks or paints of a file are used."""
        if self.ink is not None or self.paints_from is not None:
            return None
        usual = _USUAL_PAINTS if self.strokes == AUTO else min(_USUAL_PAINTS, self.strokes)
        return self.paints if self.paints is not None else usual

    @property
    def held_pressure(self) -> float | None:
        """Pressure at which the brush is held; None where it varies."""
        if self.pressure is None and self.robot is not None and only_lifts(self.robot):
            return USUAL_PRESSURE
        return self.pressure

    @property
    def names_clip(self) -> bool:
        """Whether any option of CLIP is given, so that CLIP is the network."""
        return any(value is not None for value in (self.clip, self.clip_weights, self.clip_layers))

    @property
    def _covered_px(self) -> int:
        """Pixels of the canvas's longer side, which either side of a picture may have to cover."""
        if self.px is None:
            return READ_PX // _FINER
        size = parse_sheet(self.size, None)
        width, height = (side - 2 * parse_margin(self.margin, size) for side in size)
        if is_turned_by_picture(self.size):
            height, width = sorted((width, height))
        return ceil(self.px * max(width / height, 1))

    def check_counted(self) -> None:
        """Raise InputError where strokes are to be counted for ink, and options of a new plan ask for none."""
        if self.strokes == AUTO and (self.ink, self.paints_from, self.again) == (None, None, None):
            raise no_ink_to_count()

    def _check_paints(self) -> None:
        given = {"paints": self.paints, "ink": self.ink, "paints_from": self.paints_from}
        ways = [option(name) for name, value in given.items() if value is not None]
        if len(ways) > 1:
            raise InputError(f"{ways[0]} and {ways[1]} are two ways to say what to paint with; leave one of them out")
        strokes = MOST_AUTO if self.strokes == AUTO else self.strokes
        if self.paints is not None:
            check_whole("paints", self.paints, 1, strokes, f"from 1 to the {counted(strokes, 'stroke')}")


def no_ink_to_count() -> InputError:
    """Return the fault of strokes that are to be counted where no hand draws in ink."""
    return InputError(
        f"{option('strokes')} is {AUTO}, which counts strokes of a hand for ink; give {option('style')} and "
        f"{option('ink')}, or a number"
    )


def colours_in(said: str) -> tuple[str, ...]:
    """Return the colours of inks, as in ``black,#a04020``, each as it is said."""
    return tuple(colour.strip() for colour in said.split(","))


def _plain(value: Any) -> Any:
    """Return a number of NumPy's, also within a mapping, as one of Python's, which files can hold."""
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    return value.item() if isinstance(value, np.generic) else value
