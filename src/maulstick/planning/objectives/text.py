"""Text: a loss that compares what the canvas shows with a text."""

from collections.abc import Sequence

from torch import Tensor
from torch.nn.functional import cosine_similarity

from maulstick.errors import InputError
from maulstick.planning.features.network import ReadingNetwork
from maulstick.planning.features.views import through
from maulstick.planning.objectives.objective import NetworkLoss


class TextMatch(NetworkLoss):
    """One minus the cosine between a network's embeddings of a view of the canvas and of a text.

    views: (V, 3, 3), of the canvas.  paper: (3,), what lies beside it.
    Raises InputError for an empty text. Source: Frans et al., CLIPDraw.
    """

    def __init__(self, network: ReadingNetwork, text: str, views: Tensor, paper: Tensor) -> None:
        if not text.strip():
            raise InputError("the text is empty; say what the painting should show, as in 'a sailing boat'")
        self._network, self._views, self._paper = network, views, paper
        self._wanted = network.embed_text([text])[0]

    @property
    def name(self) -> str:
        """Name of the term: ``text``."""
        return "text"

    @property
    def views(self) -> int:
        """Number of views."""
        return len(self._views)

    def losses(self, canvas: Tensor, which: Sequence[int]) -> Tensor:
        """Return a loss in [0, 2] per view, (len(which),); with CLIP rarely below 0.6."""
        seen = through(canvas, self._views[list(which)], self._network.side, self._paper)
        _, embedding = self._network.features(seen)
        return 1 - cosine_similarity(embedding, self._wanted.to(canvas)[None])
