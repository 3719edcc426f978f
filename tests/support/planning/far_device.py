"""A far device: tensors that the CPU computes and that claim to be elsewhere, so that planning can be tested for it.

As on a GPU, tensors there and tensors of the CPU must not be mixed, but for numbers and indices, and NumPy cannot read
them. They claim to be on PyTorch's device ``meta``, since nothing is real there and autograd needs no library for it.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import torch
from torch import Tensor
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves, tree_map_only

from maulstick.rendering.kernels import cpu, render

FAR = torch.device("meta")
_MOVES = torch.ops.aten._to_copy.default
_TAKE_INDICES_OF_THE_CPU = (torch.ops.aten.index.Tensor, torch.ops.aten.index_put_.default)


class FarTensor(Tensor):
    """A tensor on the far device, whose numbers are those of `near`."""

    near: Tensor

    @staticmethod
    def __new__(cls, near: Tensor) -> "FarTensor":
        far: FarTensor = Tensor._make_wrapper_subclass(  # type: ignore[attr-defined]
            cls, near.shape, strides=near.stride(), dtype=near.dtype, device=FAR
        )
        far.near = near
        return far

    def tolist(self) -> Any:
        return self.near.tolist()

    @classmethod
    def __torch_dispatch__(
        cls, operation: Any, types: Any, args: Sequence[Any] = (), kwargs: Mapping[str, Any] | None = None
    ) -> Any:
        return _computed(operation, args, kwargs or {})


class _Factories(TorchDispatchMode):
    """Lets tensors be made on the far device, and moved there."""

    def __torch_dispatch__(
        self, operation: Any, types: Any, args: Sequence[Any] = (), kwargs: Mapping[str, Any] | None = None
    ) -> Any:
        kwargs = kwargs or {}
        if FarTensor not in types and kwargs.get("device") != FAR:
            return operation(*args, **kwargs)
        return _computed(operation, args, kwargs)


def _computed(operation: Any, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
    """Return the results of an operation of PyTorch, on the device of its arguments or on the one that it names."""
    tensors = [x for x in tree_leaves((args, kwargs)) if isinstance(x, Tensor)]
    any_far = any(isinstance(x, FarTensor) for x in tensors)
    if any_far and operation is not _MOVES and operation not in _TAKE_INDICES_OF_THE_CPU:
        for x in tensors:
            if not isinstance(x, FarTensor) and x.ndim:
                raise RuntimeError(f"{operation} mixes tensors of the CPU and of the far device")
    named = kwargs.get("device")
    if named is not None:
        kwargs = {**kwargs, "device": torch.device("cpu")}
    near_args, near_kwargs = tree_map_only(FarTensor, lambda x: x.near, (tuple(args), dict(kwargs)))
    results = operation(*near_args, **near_kwargs)
    lies_far = any_far if named is None else torch.device(named) == FAR
    return tree_map_only(Tensor, FarTensor, results) if lies_far else results


def _there_and_back(kernel: Any) -> Any:
    def run(*args: Tensor, **kwargs: Any) -> Tensor:
        for x in (*args, *kwargs.values()):
            assert not isinstance(x, Tensor) or isinstance(x, FarTensor), "a kernel got a tensor of another device"
        near = {name: x.to("cpu") if isinstance(x, Tensor) else x for name, x in kwargs.items()}
        result: Tensor = kernel(*(x.to("cpu") for x in args), **near)
        return result.to(FAR)

    return run


def _tensor(data: Any, *, dtype: torch.dtype | None = None, device: torch.device | None = None) -> Tensor:
    """`torch.tensor`, which makes a tensor on the named device before anything else hears of it."""
    near = _NEAR_TENSOR(data, dtype=dtype)
    return near if device is None else near.to(device)


_NEAR_TENSOR = torch.tensor


@contextmanager
def far_device() -> Iterator[torch.device]:
    """Provide the far device, whose kernels are those of the CPU."""
    kernels = SimpleNamespace(composite=_there_and_back(cpu.composite), darkness=_there_and_back(cpu.darkness))

    def kernels_for(device: torch.device) -> Any:
        return kernels if device == FAR else cpu

    with patch.object(render, "kernels_for", kernels_for), patch.object(torch, "tensor", _tensor), _Factories():
        yield FAR
