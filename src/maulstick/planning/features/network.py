"""A pretrained network as planning sees it: images in, features out, nothing to train."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

from torch import Tensor


class Network(ABC):
    """A frozen network.

    Images are sRGB in [0, 1]; what it does with them before is its own affair. It works on their device, in their
    precision.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """As in ``efficientnet-lite0`` or ``RN101``."""

    @property
    @abstractmethod
    def side(self) -> int:
        """Width and height of the images that it looks at, pixels."""

    @abstractmethod
    def features(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        """What its layers say of images (B, 3, side, side): maps (B, C, h, w), shallow first, and an embedding (B, D).

        Differentiable.
        """


class ReadingNetwork(Network):
    """A network that also reads: what a text says and what an image shows are points of one space."""

    @abstractmethod
    def embed_text(self, texts: Sequence[str]) -> Tensor:
        """Unit vectors (T, D), to be compared with the embeddings of images."""
