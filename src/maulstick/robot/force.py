"""Machines that feel how hard they press."""

from abc import abstractmethod

from maulstick.robot.robot import Robot


class FeelsForce(Robot):
    """A machine that can find the paper by touching it."""

    @abstractmethod
    def force(self) -> float:
        """Newtons along z at the tip; only differences mean anything, as zero and sign are the machine's own."""
