"""A coarse webcam over the simulated easel of the commands, and what can happen to it."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.jobs.paint.simulation import Simulation
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.simulated.camera import Optics, SimulatedCamera

SMALL, FINE = Optics(size=(480, 360)), 1200
Event = Callable[[Simulation, SimulatedCamera], None]


def nothing(simulation: Simulation, camera: SimulatedCamera) -> None:
    """An ordinary day."""


def put_webcam(monkeypatch: pytest.MonkeyPatch, event: Event = nothing) -> None:
    """Let the easel have that camera, and something happen once it is there."""

    def camera(simulation: Simulation, tags: TagFrame) -> SimulatedCamera:
        sheet = simulation.robot.sheet
        made = SimulatedCamera(sheet.image, sheet.canvas, np.random.default_rng(0), SMALL, tags)
        event(simulation, made)
        return made

    monkeypatch.setattr(Simulation, "camera", camera)
    monkeypatch.setattr("maulstick.painting.raster.FINE", FINE)


def after(photographs: int, event: Event) -> Event:
    """Let it happen before the next photograph after so many."""

    def prepare(simulation: Simulation, camera: SimulatedCamera) -> None:
        take, taken = camera._take, 0

        def counted() -> NDArray[np.float32]:
            nonlocal taken
            if taken == photographs:
                event(simulation, camera)
            taken += 1
            return take()

        camera._take = counted  # type: ignore[method-assign]

    return prepare


def unplug(simulation: Simulation, camera: SimulatedCamera) -> None:
    camera.unplug()
