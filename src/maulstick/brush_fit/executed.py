"""What a machine repeats of a fit: it knows neither a stroke's own offset nor its own darkness in advance."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import torch
from torch import Tensor

from maulstick.brush_fit.descent import Unknowns, stamped
from maulstick.brush_fit.evidence import Evidence
from maulstick.brush_fit.flow import Flow, fit_flow
from maulstick.brush_fit.mosaic import Mosaic
from maulstick.storage.arrays import Floats


@dataclass(frozen=True)
class Executed:
    """Unknowns of a fit, the offset (x, y) in metres that all strokes share, and the flow of their opacity."""

    unknowns: Unknowns
    shift: Floats
    flow: Flow

    @classmethod
    def of(cls, unknowns: Unknowns, evidence: Evidence, pales: bool) -> Self:
        """Return what the strokes share to which the unknowns were fitted. pales: whether light strokes are paler."""
        shift = np.median((unknowns.unit * unknowns.place).double().numpy(), axis=0)
        opacity = unknowns.ink.clamp(max=0).exp().double().numpy()
        return cls(unknowns, shift, fit_flow(evidence.pressures(), opacity, pales))

    @torch.no_grad()
    def stamped(self, evidence: Evidence, mosaic: Mosaic) -> Tensor:
        """Return the predicted photographs (C, H, W) of any strokes, on the mosaic of their windows."""
        place = torch.tensor(self.shift / self.unknowns.unit, dtype=torch.float32).expand(len(evidence), -1)
        ink = torch.tensor(np.log(self.flow.at(evidence.pressures())), dtype=torch.float32)
        return stamped(mosaic, replace(self.unknowns, place=place, ink=ink))

    def l1(self, evidence: Evidence) -> Tensor:
        """Return the mean error (N,) per pixel of each window, of any strokes."""
        mosaic = evidence.mosaic()
        return mosaic.l1(self.stamped(evidence, mosaic))
