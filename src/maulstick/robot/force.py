"""Machines that measure the force at their tip."""

from abc import abstractmethod

from maulstick.robot.robot import Robot


class FeelsForce(Robot):
    """Machine with a force sensor, which can find the paper by touching it."""

    @abstractmethod
    def force(self) -> float:
        """Return the force along z at the tip, newtons; zero and sign are the machine's own: use differences."""
