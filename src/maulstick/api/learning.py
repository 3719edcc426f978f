"""Reading ink, and learning styles and brushes, from Python."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from maulstick.api.usual_torch import in_usual_torch
from maulstick.api.warning import warn
from maulstick.errors import InputError, needs_torch
from maulstick.jobs.learn import Recorded, learn_style, strokes_of
from maulstick.jobs.plan.options import PlanOptions
from maulstick.kinds import checked
from maulstick.painting.brush import BRUSHES, Brush, write_brush
from maulstick.painting.raster import Canvas, parse_size
from maulstick.storage.arrays import kind_of
from maulstick.storage.folders import MAKE_ROOM, made_folder
from maulstick.storage.text import counted
from maulstick.strokes import ink as records
from maulstick.strokes.ink import Ink
from maulstick.style import Style
from maulstick.style import load_style as load_style_for
from maulstick.style.cards import STYLES

_MOST_SAID = 3  # trials left out that are named in a warning, which is one line


@checked
def read_ink(path: str | Path, *, size: str | None = None, longest: str | None = None) -> Ink:
    """Read ink: an .ink.npz, InkML, SVG, Wacom's UIM and WILL, or the JSON of pointer events.

    size: the sheet that the page fills, as in ``A4``.  longest: the longer side of the drawing, as in ``150mm``.
    Raises InputError where the file is none of these, or both are given, or one with an .ink.npz, which has its size.
    Warns where neither is, and the file does not say how large it was drawn, and where a path's data is faulty.

        >>> read_ink(drawing).summary()
        '26 strokes, 1.01 m drawn on 100 x 100 mm, times not recorded, pressure not recorded'
    """
    if size is not None and longest is not None:
        raise InputError("size and longest cannot both be kept; give one of them")
    if kind_of(path) == "ink":
        if size is not None or longest is not None:
            raise InputError(f"{path} has a size already; leave out size and longest")
        return records.read_ink(path)
    from maulstick.recording.files.ink_files import read_ink_file  # loads parsers
    from maulstick.recording.files.page import parse_longest

    sheet = None if size is None else parse_size(size)
    longer = None if longest is None else parse_longest(longest)
    return read_ink_file(path, sheet, longer, warn, "; say it with size or longest")[0]


@checked
@in_usual_torch
def fit_style(
    ink: Recorded | Sequence[Recorded], name: str = "own", *, kind: str = "exemplar", keep: bool = False
) -> Style:
    """Learn a style from the strokes of one hand; twenty of them make a good one.

    ink: `Ink`, `Strokes`, or a path to .ink.npz or .strokes.npz; or several of these.
    kind: ``exemplar``, the strokes themselves and a density around them, or ``trajvae``, the paper's network.
    keep: keep it among your own styles, for `plan` by its name, in place of an earlier one of that name.
    Raises InputError for strokes that are too few or unlike any, and for a name that cannot be used, and OutputError
    where it cannot be kept.

        >>> fit_style(ink, "me").name
        'me'
    """
    several = [ink] if isinstance(ink, Recorded) else list(ink)
    STYLES.check_own_name(name, overwrite=True) if keep else STYLES.check_name(name)
    strokes = strokes_of(several)
    with needs_torch(), made_folder(STYLES.own(), MAKE_ROOM) if keep else nullcontext():
        style = learn_style(name, strokes, kind)
        if keep:
            from maulstick.style.store import write_style

            write_style(style, "Python", STYLES.own())
    return style


@checked
@in_usual_torch
def load_style(name: str | Path, size: str = PlanOptions.size) -> Style:
    """Return a style by its name or the path of its JSON; ``free`` is sized for a sheet of this `size`.

    Raises InputError where there is no such style, or its files cannot be used.

        >>> load_style("loops").name
        'loops'
    """
    with needs_torch():
        return load_style_for(str(name), Canvas(*parse_size(size), 1.0))


@checked
@in_usual_torch
def fit_brush(trials: str | Path, name: str = "own", *, keep: bool = False) -> Brush:
    """Fit a brush to a folder of trials: strokes drawn once each, with photographs before and after.

    keep: keep it among your own brushes, for `plan` by its name, in place of an earlier one of that name.
    What the photographs cannot tell is a warning, and so is that some trials cannot be used.
    Raises InputError where the folder holds no trials, or too few of them can be used, and OutputError where it cannot
    be kept.
    """
    with needs_torch():
        from maulstick.brush_fit.fit import fit_brush as fit
    from maulstick.brush_fit.trials import Trials

    BRUSHES.check_own_name(name, overwrite=True) if keep else BRUSHES.check_name(name)
    drawn = Trials.open(Path(trials))
    source = f"{drawn.medium}, fitted in Python"
    with made_folder(BRUSHES.own(), MAKE_ROOM) if keep else nullcontext():
        found = fit(drawn, drawn.pixels_per_metre, name, source=source, depth=drawn.depth)
        if keep:
            write_brush(found.brush, BRUSHES.own() / f"{name}.json")
    of_all = f"of {counted(len(drawn), 'trial')}"
    how_many = counted(len(found.left_out), f"{of_all} is left out", f"{of_all} are left out")
    left_out = [f"{how_many}: {'; '.join(found.left_out[:_MOST_SAID])}"]
    for warning in (*found.warnings, *(left_out if found.left_out else ())):
        warn(warning)
    return found.brush
