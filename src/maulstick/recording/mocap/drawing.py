"""Conversion of a take to ink: the canvas's frame, the tip's path on it, and the touches."""

from dataclasses import dataclass

import numpy as np

from maulstick.errors import InputError
from maulstick.recording.mocap.contact import Contact, ContactOptions, Frames, find_contact
from maulstick.recording.mocap.frames import CanvasPath, canvas_path
from maulstick.recording.mocap.plane import SheetPlane, find_paper
from maulstick.recording.mocap.take import Take
from maulstick.recording.mocap.tip import GAP, TipPath, tip_path
from maulstick.storage.arrays import Floats
from maulstick.storage.text import counted
from maulstick.strokes.ink import Ink
from maulstick.strokes.strokes import path_lengths

_BESIDE = 0.01  # metres beyond the sheet's edge up to which a touch counts as a stroke
_DOUBTFUL = 3e-3  # metres between paper and markers' plane, above which the pen's length may be wrong


@dataclass(frozen=True)
class TakeInk:
    """Ink of a take, and what it was derived from.

    ink: the strokes, without pressure.
    times: (F,), seconds since the take began, as in `Take.interrupted`.
    heights: (F,), of the tip over the paper, metres; NaN where not known.
    contact: the touches.  beside: touches beside the sheet, which are not in the ink.
    summary: sentences for people, one per line.
    """

    ink: Ink
    times: Floats
    heights: Floats
    contact: Contact
    beside: Frames
    summary: list[str]


def drawing_of(
    take: Take, tip: Floats, options: ContactOptions | None = None, corner: str = "upper-left", source: str = ""
) -> TakeInk:
    """Return the drawing that a take shows, made by the tip at `tip` (3,), metres in the frame of the pen's rigid body.

    corner: corner of the sheet with the canvas's marker at the right angle, one of `CORNERS`.
    source: description of the origin, for people.

    Raises InputError where the pen or the canvas cannot be followed, or the tip is never at the paper or never draws.
    """
    options = options or ContactOptions()
    whole = take.interrupted(GAP)  # or a stroke would go straight on over frames that a network lost
    canvas = canvas_path(whole, corner)
    path = tip_path(whole, tip, canvas)
    paper = find_paper(whole.times, path.places, path.heights, canvas.size)
    heights = paper.heights_over(path.places, path.heights)
    contact = find_contact(whole.times, heights, options)
    outside = np.maximum(-path.places, path.places - canvas.size).max(axis=1)  # metres; negative on the sheet
    nearest = np.array([outside[start:stop].min() for start, stop in contact.touches])
    drawn = nearest <= _BESIDE
    times = whole.times - whole.times[0]
    samples = np.column_stack([times, path.places, np.full(len(times), np.nan)])
    strokes = [samples[start:stop] for start, stop in contact.touches[drawn]]
    if not strokes:
        raise InputError(
            f"no stroke was found: the tip comes down to {np.nanmin(heights) * 1e3:.2f} mm over the paper, with a "
            f"threshold of {contact.threshold * 1e3:.2f} mm, "
            f"{counted(len(contact.dropped), 'touch was', 'touches were')} too short and "
            f"{len(contact.touches)} beside the canvas; set another threshold or a shorter touch"
        )
    summary = [
        *_seen(take, canvas, path),
        _where(paper),
        *_decided(contact, options, int((~drawn).sum())),
        *_cut(contact.touches[drawn], heights),
        _drawn(strokes),
    ]
    ink = Ink.of(strokes, canvas.size, source)
    return TakeInk(ink, times, heights, contact, contact.touches[~drawn], summary)


def _seen(take: Take, canvas: CanvasPath, path: TipPath) -> list[str]:
    width, height = (side * 1e3 for side in canvas.size)
    (plane, up), (plane_hertz, up_hertz) = path.noise, path.hertz
    return [
        f"{counted(len(take), 'frame')} in {take.times[-1] - take.times[0]:.1f} s; the pen was in the wrong place in "
        f"{path.rejected:,}, bridged in {path.bridged:,}, and lost for longer than {GAP * 1e3:g} ms in {path.lost:,}",
        f"canvas {width:.1f} x {height:.1f} mm, with an angle of {90 + np.degrees(canvas.skew):.1f} degrees; its "
        f"markers swapped names in {counted(canvas.swapped, 'frame')}, two of them were enough in {canvas.mended:,}, "
        f"and it was taken to be where it was before and after in {canvas.guessed:,}",
        f"the tip trembled by {plane * 1e3:.2f} mm, smoothed from {plane_hertz:g} Hz on, and in height by "
        f"{up * 1e3:.2f} mm, smoothed from {up_hertz:g} Hz on",
    ]


def _where(paper: SheetPlane) -> str:
    doubt = ": is the pen's length measured well?" if abs(paper.level) > _DOUBTFUL else ""
    return (
        f"the paper lies {abs(paper.level) * 1e3:.1f} mm {'over' if paper.level > 0 else 'under'} the plane of the "
        f"markers, leaning by {np.degrees(np.arctan(np.hypot(*paper.slope))):.1f} degrees{doubt}"
    )


def _decided(contact: Contact, options: ContactOptions, beside: int) -> list[str]:
    chosen = "proposed from the data" if options.threshold is None else "as you set it"
    return [
        f"threshold {contact.threshold * 1e3:.2f} mm over the paper, {chosen}; a stroke ends above "
        f"{contact.release * 1e3:.2f} mm",
        f"merged {counted(len(contact.merged), 'lift')} of at most {options.merge * 1e3:g} ms",
        f"dropped {counted(len(contact.dropped), 'touch', 'touches')} shorter than {options.shortest * 1e3:g} ms"
        + (f", and {beside} beside the canvas" if beside else ""),
    ]


def _cut(touches: Frames, heights: Floats) -> list[str]:
    around = np.concatenate([[np.inf], heights, [np.inf]])
    beside = around[np.column_stack([touches[:, 0], touches[:, 1] + 1])]
    parts = ((np.isnan(beside), "where the pen was lost"), (np.isinf(beside), "where the take begins or ends"))
    cuts = [(int(cut.any(axis=1).sum()), where) for cut, where in parts]
    return [f"{counted(number, 'stroke')} cut short {where}" for number, where in cuts if number]


def _drawn(strokes: list[Floats]) -> str:
    metres = sum(float(path_lengths(stroke[:, 1:3])) for stroke in strokes)
    seconds = sum(stroke[-1, 0] - stroke[0, 0] for stroke in strokes)
    return f"{counted(len(strokes), 'stroke')}, {metres:.2f} m drawn in {seconds:.1f} s of touching"
