"""Strokes of a style all over an empty sheet, arranged as its hand arranges them."""

import numpy as np
import torch

from maulstick.planning.adam import Adam
from maulstick.planning.groups import choose_groups, place_groups
from maulstick.storage.arrays import Floats
from maulstick.strokes.strokes import place
from maulstick.style import Style
from maulstick.style.arrangement import Arrangement
from maulstick.style.arrangement.laid import NEAREST, Laid

_STEPS = 150
_MOVED, _TURNED = 0.02, 0.02  # median lengths, and radians, a step
_PX = 200  # of the sheet's longer side, which groups are placed on


def spread(style: Style, arrangement: Arrangement, width: float, height: float, seed: int = 0) -> Floats:
    """Return as many strokes as the hand drew, (N, n, 2), on a sheet of this size, metres: no picture, even ink."""
    rng, torch_rng = np.random.default_rng(seed), torch.Generator().manual_seed(seed)
    count, scale = len(arrangement.paths), _PX / max(width, height)
    sheet = np.ones((max(1, round(height * scale)), max(1, round(width * scale))))
    no_lines = np.zeros(sheet.shape, dtype=complex)
    groups = choose_groups(arrangement, count, rng)
    places, rows = place_groups(
        sheet[None], no_lines, sheet, arrangement, groups, (sheet.size / count) ** 0.5, scale, rng
    )
    paths = style.decode(style.sample_around(torch.from_numpy(rows), torch_rng)[0]).detach().double()
    centres, angles = torch.from_numpy(places.centres / scale), torch.from_numpy(places.angles)
    hand = arrangement.neighbourhoods.crowded(Laid.of(paths, centres, angles).density())
    adam = Adam()
    adam.add(centres.requires_grad_(), _MOVED * hand.unit)
    adam.add(angles.requires_grad_(), _TURNED)
    for _ in range(_STEPS if count > NEAREST else 0):
        adam.step(hand.price(Laid.of(paths, centres, angles), torch_rng))
    away = (paths - paths.mean(dim=1, keepdim=True)).numpy()
    return place(away, np.column_stack([centres.detach().numpy(), angles.detach().numpy()]))
