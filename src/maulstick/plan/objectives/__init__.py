"""What a painting should look like: objectives, asked at every step, and judges, networks that are asked seldom."""

from maulstick.plan.objectives.edges import Edges
from maulstick.plan.objectives.likeness import Likeness, sketch
from maulstick.plan.objectives.look import Look
from maulstick.plan.objectives.objective import Judge, Objective
from maulstick.plan.objectives.tone import Tone, halved
from maulstick.plan.objectives.words import Words

__all__ = ["Edges", "Judge", "Likeness", "Look", "Objective", "Tone", "Words", "halved", "sketch"]
