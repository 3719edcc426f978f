"""CLIP, by the package open-clip-torch: a network that compares pictures with texts."""

import warnings
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path
from pickle import UnpicklingError
from socket import getaddrinfo
from textwrap import shorten
from typing import Any, Final
from urllib.parse import urlsplit
from urllib.request import getproxies

import torch
from torch import Tensor
from torch.nn.functional import normalize

from maulstick.errors import InputError, Remedy, how_to_add, option
from maulstick.planning.features.network import ReadingNetwork
from maulstick.storage.files import file_to_read

USUAL: Final = ("RN50", "RN101", "ViT-B-16", "ViT-B-32", "ViT-L-14")
"""Models that messages name as examples: those with OpenAI's weights."""

_USUAL_WEIGHTS = "openai"  # set of weights where none is named: the original ones, which most models have
_FORMATS = (".safetensors", ".pt", ".pth", ".bin")  # endings of files that open_clip loads as tensors
_LAYERS = 4  # maps that are compared where no layers are named: from fine to coarse, as in CLIPasso


class Clip(ReadingNetwork):
    """A CLIP model, made by `Clip.load`. Source: Radford et al., Learning Transferable Visual Models."""

    def __init__(
        self,
        name: str,
        model: Any,
        tokenize: Callable[[list[str]], Tensor],
        shown: dict[str, Any],
        layers: tuple[int, ...] | None,
    ) -> None:
        """Take a model and its tokeniser; `shown` has size, mean and std of the images that it was trained with."""
        self._name, self._model, self._tokenize = name, model.eval().requires_grad_(False), tokenize
        size = shown["size"]
        self._side = int(size if isinstance(size, int) else size[0])
        self._mean, self._std = (torch.tensor(shown[key])[:, None, None] for key in ("mean", "std"))
        count = len(self._intermediates(torch.zeros(1, 3, self._side, self._side))[0])
        for layer in layers or ():
            if not 0 <= layer < count:
                raise InputError.of_range("the layer of CLIP", layer, f"in 0 to {count - 1} for {name}")
        self._layers = layers or _spread(count)

    @classmethod
    def load(
        cls, model: str = "RN101", weights: Path | None = None, *, layers: tuple[int, ...] | None = None
    ) -> "Clip":
        """Load a model by its name in open_clip, as in ``RN101``, or by name and weights, as in ``RN101:openai``.

        weights: a file of weights; when left out they are fetched once into open_clip's cache.
        layers: indices from 0 of the maps that are its features: of a ResNet the stem and four stages, of a
        transformer its blocks. When left out, four that are spread evenly up to the last.

        Raises InputError without the package, for an unknown model, a layer that does not exist, and weights that
        cannot be had, or could only be read by running code in their file.
        """
        if find_spec("open_clip") is None:
            raise InputError(f"CLIP needs the package open-clip-torch; {how_to_add('clip')}")
        import open_clip

        name, tag = _named(model)
        made = open_clip.get_pretrained_cfg(name, tag)
        file = file_to_read(weights, "file of CLIP weights") if weights else _fetched(name, tag, made)
        if file.suffix not in _FORMATS:
            raise InputError(f"{file} is no file of CLIP weights; it must be one of: {', '.join(_FORMATS)}")
        try:
            # OpenAI's weights were trained with an approximate GELU, which their files do not say.
            with torch.random.fork_rng(devices=()):  # it is made with random weights first
                loaded = open_clip.create_model(
                    name,
                    pretrained=str(file),
                    force_quick_gelu=made.get("quick_gelu", False),
                    force_preprocess_cfg=made,
                    weights_only=True,
                )
            tokenize = open_clip.get_tokenizer(name)
        except Exception as error:  # a broken file raises nearly anything
            if isinstance(error, UnpicklingError) or "TorchScript" in str(error):
                raise InputError(
                    f"{file} holds more than tensors, and reading it could run what is in it; "
                    f"give {option('clip_weights')} a .safetensors file"
                ) from error
            raise InputError(f"{file} gives no {name}: {shorten(str(error), 200)}") from error
        return cls(model, loaded, tokenize, open_clip.get_model_preprocess_cfg(loaded), layers)

    @property
    def name(self) -> str:
        """Name as given to `load`: ``RN101``, or ``RN101:openai``."""
        return self._name

    @property
    def side(self) -> int:
        """Side of the images that the model was trained with, pixels, mostly 224."""
        return self._side

    def features(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        """Return the chosen layers' maps, of a transformer without its class token, and one unit vector per image."""
        maps, embedding = self._intermediates(images)
        return [maps[layer] for layer in self._layers], embedding

    @torch.no_grad()
    def embed_text(self, texts: Sequence[str]) -> Tensor:
        """Return unit vectors (T, D) of English texts; of a long text, its first 75 tokens count."""
        tokens = self._tokenize(list(texts)).to(next(self._model.parameters()).device)
        return normalize(self._model.encode_text(tokens), dim=-1)

    def _intermediates(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        """Return the maps of all layers, and a unit vector per image."""
        self._model.to(images)
        shown = (images - self._mean.to(images)) / self._std.to(images)
        found = self._model.forward_intermediates(shown)
        return found["image_intermediates"], normalize(found["image_features"], dim=-1)


def _named(model: str) -> tuple[str, str]:
    """Return the names of the model and of its weights; raises InputError where open_clip does not know one of them."""
    import open_clip

    name, _, tag = model.partition(":")
    name = name.replace("/", "-")  # OpenAI writes ViT-B/32
    if name not in (names := open_clip.list_models()):
        raise InputError(
            f"there is no CLIP model {name!r}; usual ones are {', '.join(USUAL)}, "
            f"and open_clip.list_models() lists all {len(names)}"
        )
    tags = open_clip.list_pretrained_tags_by_model(name)
    if tag and tag not in tags:
        raise InputError.of_choice(f"set of weights for {name}", tag, tags)
    return name, tag or (_USUAL_WEIGHTS if _USUAL_WEIGHTS in tags else "".join(tags[:1]))


def _fetched(name: str, tag: str, made: dict[str, Any]) -> Path:
    """Return the file of weights, fetched if it is not cached. Raises InputError where that fails."""
    import open_clip

    if not made:
        raise InputError(f"nobody publishes weights of {name}", Remedy.CLIP_WEIGHTS)
    from huggingface_hub import constants

    before = constants.HF_HUB_OFFLINE
    constants.HF_HUB_OFFLINE = before or not _reachable(constants.ENDPOINT)  # or it tries again for a minute
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about accounts and speed
            return Path(open_clip.download_pretrained(made))
    except Exception as error:  # without a network nearly anything is raised
        raise InputError(
            f"the {tag} weights of {name} are not on this machine and cannot be fetched",
            Remedy.CLIP_WEIGHTS_OR_NETWORK,
        ) from error
    finally:
        constants.HF_HUB_OFFLINE = before


def _reachable(address: str) -> bool:
    """Return whether the name of the host is resolved, or there is a proxy."""
    try:
        return bool(getproxies() or getaddrinfo(urlsplit(address).hostname, None))
    except OSError:
        return False


def _spread(count: int) -> tuple[int, ...]:
    """Return indices of a few layers of `count`, evenly spread up to the last."""
    return tuple(sorted({round(k * (count - 1) / _LAYERS) for k in range(1, _LAYERS + 1)}))
