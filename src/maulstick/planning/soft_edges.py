"""Soft edges of regions: pixels of both sides mingle across them, the fewer of each the farther from its own side."""

import numpy as np
from scipy.ndimage import distance_transform_edt

from maulstick.storage.arrays import Bools, Floats, Ints


def softened(labels: Ints, number: int, width: float, open_to: Bools, noise: Floats) -> Ints:
    """Return labels (H, W) in which the edge of the region of this number is soft.

    width: pixels over which its share of pixels falls from all to none.
    open_to: (R,), which regions it may mingle with.  noise: (H, W), evenly spread in [0, 1).
    """
    own = labels == number
    others = open_to[labels] & ~own
    if not own.any() or not others.any() or width < 1:
        return labels
    outside, at = distance_transform_edt(~others, return_indices=True)
    inside = distance_transform_edt(~own)
    share = 0.5 + np.where(own, outside - 0.5, 0.5 - inside) / width
    lost, won = own & (noise >= share), others & (noise < share)
    soft: Ints = np.where(lost, labels[tuple(at)], np.where(won, number, labels))
    return soft
