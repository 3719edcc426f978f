"""Losses of a canvas: objectives at every step, and network losses, which are evaluated now and then."""

from maulstick.planning.objectives.edges import Edges
from maulstick.planning.objectives.likeness import Likeness, sketch
from maulstick.planning.objectives.look import Look
from maulstick.planning.objectives.objective import NetworkLoss, Objective
from maulstick.planning.objectives.pyramid import halved
from maulstick.planning.objectives.text import TextMatch
from maulstick.planning.objectives.tone import Halftone, Tone, towards_contours

__all__ = [
    "Edges",
    "Halftone",
    "Likeness",
    "Look",
    "NetworkLoss",
    "Objective",
    "TextMatch",
    "Tone",
    "halved",
    "sketch",
    "towards_contours",
]
