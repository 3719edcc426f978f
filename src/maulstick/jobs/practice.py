"""Practice: strokes of a style, apart from one another, which a brush is fitted from."""

from importlib.metadata import version

import numpy as np
import torch

from maulstick.calibration.collect import spread_apart
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Paint, Painting, Provenance, Sheet, Stroke
from maulstick.style import Style
from maulstick.style.pressure import pressure_along

_LIGHTEST = 0.1  # least pressure: lighter strokes may leave no mark
_ROOM_IN_WIDTHS, _ROOM = 1.5, 2.5e-3  # room around strokes: half-widths of the brush, and metres to spare


def practice(style: Style, brush: Brush, sheet: Sheet, strokes: int, *, seed: int = 0) -> Painting:
    """Return a painting of strokes in the style, apart from one another, to fit a brush from.

    brush: about as wide as the one to be fitted. If its pressure matters, all pressures occur equally often.
    strokes: their number.  Raises InputError where so many do not fit on the sheet.
    """
    torch_rng = torch.Generator().manual_seed(seed)
    codes, knots = style.sample(strokes, torch_rng)
    paths = style.decode(codes).detach().double().numpy()
    pressure = pressure_along(knots).double().numpy()
    ranks = np.searchsorted(np.sort(pressure.ravel()), pressure, side="right") / pressure.size
    shown = _LIGHTEST + (1 - _LIGHTEST) * ranks if brush.pressure_matters else np.full(pressure.shape, 0.5)
    whole = np.concatenate([paths, shown[..., None]], axis=2)
    placed = spread_apart(whole, (sheet.width, sheet.height), room_around(brush))
    return Painting(
        sheet=sheet,
        provenance=Provenance(version=version("maulstick"), seed=seed, options={"style": style.name, "practice": True}),
        brushes={brush.name: brush},
        paints=(Paint(colour=(0.0, 0.0, 0.0), brush=brush.name),),
        strokes=tuple(
            Stroke.model_validate({"id": number, "paint": 0, "trajectory": path})
            for number, path in enumerate(placed.tolist())
        ),
    )


def room_around(brush: Brush) -> float:
    """Return the free room in metres around each stroke of a `practice` with this brush."""
    return _ROOM_IN_WIDTHS * brush.widest + _ROOM
