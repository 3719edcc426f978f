"""``maulstick plan``: from a picture or a text to a painting in a folder."""

from maulstick.cli.plan.command import plan

__all__ = ["plan"]
