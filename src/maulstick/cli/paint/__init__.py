"""``maulstick paint``: let a machine paint."""

from maulstick.cli.paint.command import paint

__all__ = ["paint"]
