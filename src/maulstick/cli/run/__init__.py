"""``maulstick run``: let a machine paint."""

from maulstick.cli.run.command import run

__all__ = ["run"]
