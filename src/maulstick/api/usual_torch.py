"""PyTorch as it is when a program begins, whatever the program that calls Maulstick has made of it."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import wraps
from typing import ParamSpec, TypeVar

Given = ParamSpec("Given")
Returned = TypeVar("Returned")


@contextmanager
def usual_torch() -> Iterator[None]:
    """Compute meanwhile in float32, on the processor and with gradients; afterwards all is as the caller had it.

    A program may have asked for float64, a GPU or no gradients for tensors of its own. Loads nothing: where PyTorch is
    not loaded yet, it is as usual.
    """
    torch = sys.modules.get("torch")
    if torch is None:
        yield
        return
    with ExitStack() as stack:
        stack.enter_context(torch.inference_mode(False))
        stack.enter_context(torch.enable_grad())
        if torch.get_default_device().type != "cpu":  # else the context would cost time at every call
            stack.enter_context(torch.device("cpu"))
        if (theirs := torch.get_default_dtype()) != torch.float32:
            stack.callback(torch.set_default_dtype, theirs)
            torch.set_default_dtype(torch.float32)
        yield


def in_usual_torch(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """Return the function, which then runs in `usual_torch`; one of ours, so that `warn` looks beyond it."""

    @wraps(function)
    def call(*args: Given.args, **named: Given.kwargs) -> Returned:
        with usual_torch():
            return function(*args, **named)

    return call
