"""``maulstick plan``: from a picture or a text to a painting in a folder."""

from maulstick.cli.plan.command import paint

__all__ = ["paint"]
