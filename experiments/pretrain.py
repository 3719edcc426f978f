"""Pretrain the TrajVAE that comes with Maulstick, on the Wacom drawings.

    .venv/bin/python experiments/pretrain.py

Prints how well it draws strokes of drawings that it was not trained on (every fourth left out), then trains on all.
"""

import argparse
from pathlib import Path

import numpy as np
import torch
from safetensors.numpy import save
from wacom import wacom_hands

import maulstick
from maulstick.storage.files import atomic_write
from maulstick.style.hand import Hand
from maulstick.style.train import pretrain
from maulstick.style.trajvae import TrajVAE, Weights, activity

WEIGHTS = Path(maulstick.__file__).parent / "style" / "built_in" / "trajvae.safetensors"
SEED = 0


def main() -> None:
    """Write the network."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    torch.set_num_threads(1)
    hands = {name: Hand.of(strokes) for name, strokes in wacom_hands().items()}
    for left in range(4):
        unseen = list(hands)[left::4]
        weights = pretrain([hand for name, hand in hands.items() if name not in unseen], SEED)
        for name in unseen:
            print(f"{name}, unseen: {_told(weights, hands[name])}", flush=True)
    weights = pretrain(list(hands.values()), SEED)
    for name, hand in hands.items():
        print(f"{name}: {_told(weights, hand)}")
    atomic_write(WEIGHTS, save({name: tensor.numpy() for name, tensor in weights.items()}))


def _told(weights: Weights, hand: Hand) -> str:
    style = TrajVAE("", hand, weights)
    paths = torch.from_numpy(hand.paths)
    off = (style.decode(style.encode(paths)) - paths).square().sum(-1).mean(1).sqrt().numpy() * 1e3
    used = activity(weights, hand.paths)
    return (
        f"{np.median(off):.3f} mm median, {np.quantile(off, 0.95):.3f} mm at 95 %, "
        f"{used.active} latents active, effective rank {used.effective_rank:.1f}"
    )


if __name__ == "__main__":
    main()
