"""Parameters of strokes that are optimised: code, pose, pressure and colour, one tensor per kind; and their brushes."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import torch
from torch import Tensor

from maulstick.planning.state import State
from maulstick.rendering.laying import extents, laid, poses_of
from maulstick.style import Style
from maulstick.style.pressure import pressure_along


@dataclass(frozen=True)
class StrokeParameters:
    """Parameters of N strokes that are optimised, and the brush of each.

    codes: (N, K).  centres: (N, 2) metres, where the middle of each path lies; turning a stroke about it moves both
    ends alike.  angles: (N,) radians.  pressure_knots: (N, 4) in [0, 1].  colours: (N, C) in [0, 1].
    brush_of: (N,), indices of brushes, which descent leaves as they are.
    """

    codes: Tensor
    centres: Tensor
    angles: Tensor
    pressure_knots: Tensor
    colours: Tensor
    brush_of: Tensor

    def __len__(self) -> int:
        return self.angles.shape[0]

    def each(self) -> dict[str, Tensor]:
        """Return the tensors by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __getitem__(self, rows: Tensor) -> Self:
        """Return some of the strokes, without gradients."""
        return type(self)(**{name: tensor.detach()[rows] for name, tensor in self.each().items()})

    @classmethod
    def in_state(cls, state: State) -> Self:
        """Return the strokes that a state of planning holds. Raises KeyError where it holds none."""
        return cls(**{field.name: torch.from_numpy(state[field.name]) for field in fields(cls)})

    def replace_rows(self, rows: Tensor, others: "StrokeParameters") -> None:
        """Put `others` in the place of the strokes `rows`."""
        for name, tensor in self.each().items():
            tensor.detach()[rows] = getattr(others, name)

    def poses(self, paths: Tensor) -> Tensor:
        """Return the poses (N, 3), Δ = (Δx, Δy, Δθ), that place standardised paths (N, n, 2), metres and radians."""
        return poses_of(paths, self.centres, self.angles)

    def trajectories(self, style: Style) -> Tensor:
        """Return commanded trajectories (N, n, 3): x, y in metres, pressure in [0, 1]."""
        return laid(style.decode(self.codes), self.centres, self.angles, pressure_along(self.pressure_knots))

    @torch.no_grad()
    def keep_inside(self, style: Style, width: float, height: float) -> None:
        """Move each stroke by the least that keeps its path on a sheet of this size, metres."""
        least, most = extents(self.trajectories(style))
        self.centres.add_((-least).clamp(min=0) - (most - torch.tensor([width, height])).clamp(min=0))


def joined(parts: Sequence[StrokeParameters]) -> StrokeParameters:
    """Return the strokes of all parts, one after another, without gradients."""
    each = {name: [part.each()[name].detach() for part in parts] for name in parts[0].each()}
    return StrokeParameters(**{name: torch.cat(tensors) for name, tensors in each.items()})
