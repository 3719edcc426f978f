"""``maulstick plan``: plans a painting of a picture or a text."""

from maulstick.cli.plan.command import plan

__all__ = ["plan"]
