"""What a painting should look like: objectives, asked at every step, and judges, networks that are asked seldom."""

from maulstick.plan.objectives.objective import Judge, Objective
from maulstick.plan.objectives.tone import Tone, halved

__all__ = ["Judge", "Objective", "Tone", "halved"]
