"""``maulstick paint``: let a machine paint."""

from maulstick.cli.paint.command import run

__all__ = ["run"]
