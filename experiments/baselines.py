"""The rivals of the stroke model (paper: Brush Stroke Dynamics Modeling Experiments), written from the paper's words.

Each is trained by `train_...(train, valid, seed=..., seconds=...)`, the same wall-clock budget for all, into a `Model`.
"""

from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn.functional import max_pool2d, pad, pixel_shuffle, pixel_unshuffle
from training import Examples, Model, fit

from maulstick.rendering.kernels.cpu import darkness

HIDDEN = 64
CHANNELS = (64, 32, 16, 8, 1)
"""Between the transposed convolutions, each of which doubles height and width."""
CNN_RATE, CNN_WARM_UP, CNN_SHIFT = 0.01, 0.3, 3
NUMBERS_RATE, UNET_RATE = 0.03, 0.01
UNET_WIDTHS = (8, 16, 32)
BLANK = -3.0
"""The logit of nearly blank paper, where the networks begin."""


def train_cnn(train: Examples, valid: Examples, *, seed: int, seconds: float) -> Model:
    """A fully connected start and transposed convolutions."""
    return _train_cnn(train, valid, seed, seconds, coordinates=False)


def train_coordconv(train: Examples, valid: Examples, *, seed: int, seconds: float) -> Model:
    """The same, where each convolution also sees the coordinates of its pixels."""
    return _train_cnn(train, valid, seed, seconds, coordinates=True)


def train_traj2stroke(train: Examples, valid: Examples, *, seed: int, seconds: float) -> Model:
    """The paper's seven numbers."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = Traj2Stroke(train)
        return Model(network, fit(network, train, valid, rates={"": NUMBERS_RATE}, seconds=seconds))


def train_traj2stroke_unet(train: Examples, valid: Examples, *, seed: int, seconds: float) -> Model:
    """The seven numbers alone for the first half of the time, together with a U-Net for the second."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = Traj2StrokeUNet(train)
        took = fit(network.stroke, train, valid, rates={"": NUMBERS_RATE}, seconds=seconds / 2)
        rates = {"stroke": NUMBERS_RATE / 10, "unet": UNET_RATE}
        took += fit(network, train, valid, rates=rates, seconds=seconds / 2)
    return Model(network, took)


def _train_cnn(train: Examples, valid: Examples, seed: int, seconds: float, *, coordinates: bool) -> Model:
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        network = Cnn(train, coordinates=coordinates)
        took = fit(network, train, valid, rates={"": CNN_RATE}, seconds=seconds, warm_up=CNN_WARM_UP, shift=CNN_SHIFT)
    return Model(network, took)


class Cnn(nn.Module):
    """From the whole trajectory, standardised as `train` is, to an image of the size of those in `train`."""

    def __init__(self, train: Examples, *, coordinates: bool) -> None:
        super().__init__()
        self.height, self.width = train.darkness.shape[1:]
        least = torch.tensor([1.0, 1.0, 0.02])  # where all paths start at one place, nothing is to be divided by
        self.register_buffer("mean", train.paths.mean(0))
        self.register_buffer("deviation", train.paths.std(0).maximum(least))
        doublings = len(CHANNELS) - 1
        rows, columns = -(-self.height // 2**doublings), -(-self.width // 2**doublings)
        layers: list[nn.Module] = [
            nn.Flatten(),
            nn.Linear(train.paths[0].numel(), HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, CHANNELS[0] * rows * columns),
            nn.Unflatten(1, (CHANNELS[0], rows, columns)),
        ]
        for came, goes in pairwise(CHANNELS):
            layers.append(nn.ReLU())
            if coordinates:
                layers.append(Coordinates())
                came += 2
            layers.append(nn.ConvTranspose2d(came, goes, 4, stride=2, padding=1))
            if goes > 1:
                layers.append(nn.BatchNorm2d(goes))
        nn.init.constant_(layers[-1].bias, BLANK)
        self.layers = nn.Sequential(*layers, nn.Sigmoid())

    def forward(self, paths: Tensor) -> Tensor:
        """Darkness (N, H, W) of paths (N, 32, 3)."""
        return self.layers((paths - self.mean) / self.deviation)[:, 0, : self.height, : self.width]


class Coordinates(nn.Module):
    """Two more channels: x and y of each pixel, from -1 to 1 (paper: CoordConv)."""

    def forward(self, image: Tensor) -> Tensor:
        """(N, C + 2, H, W) of (N, C, H, W)."""
        count, _, height, width = image.shape
        y, x = torch.meshgrid(torch.linspace(-1, 1, height), torch.linspace(-1, 1, width), indexing="ij")
        return torch.cat([image, torch.stack([x, y]).expand(count, -1, -1, -1)], dim=1)


class Traj2Stroke(nn.Module):
    """The paper's seven numbers, in pixels, each in a unit that one learning rate suits."""

    def __init__(self, train: Examples) -> None:
        super().__init__()
        self.height, self.width = train.darkness.shape[1:]
        half_width = _usual_half_width(train)
        self.log_scale = nn.Parameter(torch.zeros(2))
        self.shift = nn.Parameter(torch.zeros(2))
        self.thickness = nn.Parameter(torch.tensor([half_width, half_width]))
        self.log_c = nn.Parameter(torch.zeros(1))

    def forward(self, paths: Tensor) -> Tensor:
        """Darkness (N, H, W) of paths (N, 32, 3)."""
        start = paths[:, :1, :2]
        points = start + self.log_scale.exp() * (paths[..., :2] - start) + self.shift
        alpha, beta = self.thickness
        neutral = torch.zeros(1), torch.ones(1)
        return darkness(
            points,
            alpha * paths[..., 2] + beta,
            self.log_c.exp(),
            *neutral,
            height=self.height,
            width=self.width,
            threads=torch.get_num_threads(),
        )


def _usual_half_width(train: Examples) -> float:
    """Ink over path length, pixels: that of a hard mark as wide everywhere."""
    length = (train.paths[:, 1:, :2] - train.paths[:, :-1, :2]).norm(dim=-1).sum()
    return float((train.weights * train.darkness).sum() / length.clamp(min=1) / 2)


class Traj2StrokeUNet(nn.Module):
    """A U-Net adds to what the seven numbers draw; at first it adds nothing."""

    def __init__(self, train: Examples) -> None:
        super().__init__()
        self.stroke = Traj2Stroke(train)
        self.unet = UNet()

    def forward(self, paths: Tensor) -> Tensor:
        """Darkness (N, H, W) of paths (N, 32, 3), in training perhaps a little outside [0, 1]."""
        drawn = self.stroke(paths)
        return drawn + self.unet(drawn[:, None])[:, 0]


class UNet(nn.Module):
    """After Ronneberger et al., with the zero convolution of ControlNet at its end.

    Four pixels are four channels of one at half the resolution, which loses nothing and is several times as fast.
    In training it sees each image mirrored at random, which is right for any mark once it is drawn in its place.
    """

    def __init__(self) -> None:
        super().__init__()
        pairs = list(pairwise((4, *UNET_WIDTHS)))
        self.down = nn.ModuleList(_convolutions(came, goes) for came, goes in pairs)
        self.grow = nn.ModuleList(nn.ConvTranspose2d(goes, came, 2, stride=2) for came, goes in reversed(pairs[1:]))
        self.up = nn.ModuleList(_convolutions(2 * came, came) for came, _ in reversed(pairs[1:]))
        self.end = nn.Conv2d(UNET_WIDTHS[0], 4, 1)
        nn.init.zeros_(self.end.weight)
        nn.init.zeros_(self.end.bias)
        self.to(memory_format=torch.channels_last)

    def forward(self, image: Tensor) -> Tensor:
        """What to add (N, 1, H, W) to images (N, 1, H, W)."""
        mirrored = [axis for axis in (2, 3) if self.training and torch.rand(()) < 0.5]
        return self._residual(image.flip(mirrored)).flip(mirrored)

    def _residual(self, image: Tensor) -> Tensor:
        height, width = image.shape[2:]
        coarsest = 2 ** len(UNET_WIDTHS)
        padded = pad(image, (0, -width % coarsest, 0, -height % coarsest))
        x = self.down[0](pixel_unshuffle(padded, 2).contiguous(memory_format=torch.channels_last))
        skipped = []
        for block in self.down[1:]:
            skipped.append(x)
            x = block(max_pool2d(x, 2))
        for grow, block in zip(self.grow, self.up, strict=True):
            x = block(torch.cat([skipped.pop(), grow(x)], dim=1))
        return pixel_shuffle(self.end(x), 2)[:, :, :height, :width]


def _convolutions(came: int, goes: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(came, goes, 3, padding=1, bias=False),
        nn.BatchNorm2d(goes),
        nn.ReLU(),
        nn.Conv2d(goes, goes, 3, padding=1, bias=False),
        nn.BatchNorm2d(goes),
        nn.ReLU(),
    )
