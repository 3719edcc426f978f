import pytest
import torch
from torch import Tensor

from maulstick.planning.adam import Adam

RATES, BETAS = (0.02, 0.05), (0.9, 0.99)


def tensors(dtype: torch.dtype) -> list[Tensor]:
    torch_rng = torch.Generator().manual_seed(3)
    return [torch.randn(7, n, generator=torch_rng, dtype=dtype).requires_grad_() for n in (5, 2)]


def loss_of(these: list[Tensor], step: int) -> Tensor:
    used = these if step % 3 else these[:1]  # the other has no gradient then
    return torch.stack([((tensor - 0.3) ** 4).sum() + tensor.sin().sum() for tensor in used]).sum()


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_each_step_is_that_of_pytorch_to_the_bit(dtype: torch.dtype) -> None:
    ours, theirs = tensors(dtype), tensors(dtype)
    adam = Adam(BETAS)
    for tensor, rate in zip(ours, RATES, strict=True):
        adam.add(tensor, rate)
    groups = [{"params": [tensor], "lr": rate} for tensor, rate in zip(theirs, RATES, strict=True)]
    pytorch = torch.optim.Adam(groups, betas=BETAS)
    for step in range(40):
        share = 1 / (1 + step)
        for group, rate in zip(pytorch.param_groups, RATES, strict=True):
            group["lr"] = rate * share
        pytorch.zero_grad()
        loss_of(theirs, step).backward()
        pytorch.step()
        adam.step(loss_of(ours, step), share)
        assert all(torch.equal(a, b) for a, b in zip(ours, theirs, strict=True))
