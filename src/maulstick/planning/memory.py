"""Memory that one step frees and the next takes again."""

import torch

_LARGER_MIB = 16  # than all tensors of a usual canvas, and no more than half of what glibc learns from


def keep_freed_memory() -> None:
    """Let what is freed stay with this process.

    The allocator of glibc gives the system back what is larger than any block freed so far, and a step would take
    some 300 pages anew: half a millisecond.
    """
    torch.empty(_LARGER_MIB * 2**20, dtype=torch.uint8)
