"""Succession: what a hand draws next, as it is kept with a painting."""

from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from maulstick.storage.arrays import Floats

_Weight = Annotated[float, Field(ge=-1e4, le=1e4), AfterValidator(lambda number: float(f"{number:.9g}"))]


class Succession(BaseModel):
    """Weights of a conditional logit of which stroke a hand draws after another, of numbers of both.

    jump: log distance from the end of the one to the start of the other.  distance: log distance of their centres.
    along: 1 where the other lies end to end with the one, -1 where side by side.  parallel: 1, or -1 across.
    same_way: 1 where it is drawn the same way, -1 where back.  unlike: |log ratio of their lengths|.
    The unit of length is the median length of a stroke.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    jump: _Weight
    distance: _Weight
    along: _Weight
    parallel: _Weight
    same_way: _Weight
    unlike: _Weight

    @property
    def weights(self) -> Floats:
        """All six, as `maulstick.ordering.succession.Outlines.numbers` orders them."""
        return np.array(list(self.model_dump().values()))
