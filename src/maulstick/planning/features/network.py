"""Interface of pretrained networks: images in, features out, nothing to train."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Final

from torch import Tensor


class Network(ABC):
    """A frozen network.

    Images are sRGB in [0, 1]; each network normalises them itself. It works on their device, in their precision.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of the network, as in ``efficientnet-lite0`` or ``RN101``."""

    @property
    @abstractmethod
    def side(self) -> int:
        """Width and height of the images that it takes, pixels."""

    @abstractmethod
    def features(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        """Return features of images (B, 3, side, side): maps (B, C, h, w), shallow first, and an embedding (B, D).

        Differentiable.
        """


class ReadingNetwork(Network):
    """A network that also reads: it embeds texts and images in one space."""

    @abstractmethod
    def embed_text(self, texts: Sequence[str]) -> Tensor:
        """Return unit vectors (T, D) of texts, to be compared with the embeddings of images."""


class LoadedOnce:
    """A network that is loaded at the first call, and once per process: sent to another, it is loaded there anew."""

    def __init__(self, load: Callable[[], Network]) -> None:
        self._load: Final = load
        self._network: Network | None = None

    def __call__(self) -> Network:
        """Return the network."""
        if self._network is None:
            self._network = self._load()
        return self._network

    def __reduce__(self) -> tuple[object, ...]:
        return LoadedOnce, (self._load,)
