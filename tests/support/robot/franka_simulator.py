"""A simulated Franka: franky-sim, which speaks libfranka's protocol, in a process of its own.

While it is driven, it takes a step once the driver has answered the last one, so a busy computer makes it slow, and
nothing else: its milliseconds are those of an arm whose driver is never late. They are no shorter than those of clocks
on the wall.
"""

import json
import select
import signal
import subprocess
import sys
import threading
import time
from types import TracebackType
from typing import Self

import numpy as np

from maulstick.storage.arrays import Floats

SECONDS_A_STEP = 1e-3
_UNANSWERED = 0.5  # seconds, after which a driver is gone
_LONGEST = 300  # seconds of its life, so that no driver waits for it for ever
_STILL = 1e-6  # metres a step


class FrankaSimulator:
    """Runs while its context lasts, at `address`."""

    def __enter__(self) -> Self:
        command = [sys.executable, "-W", "ignore", __file__]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.address = self._said().strip()
        assert self.address, "the simulated Franka did not start: what franky-sim needs is not there; its words follow"
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._process.communicate()

    def path(self) -> Floats:
        """(steps, 3) metres, where the tip was at each step since this was asked last."""
        assert self._process.stdin is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return np.array(json.loads(self._said()), dtype=np.float64).reshape(-1, 3)

    def vanish(self) -> None:
        """As when its cable is cut."""
        self._process.kill()

    def _said(self) -> str:
        assert self._process.stdout is not None
        return self._process.stdout.readline()


def moving_seconds(path: Floats) -> float:
    """How long the tip was moving, by the simulator's clock."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    return SECONDS_A_STEP * int((steps > _STILL).sum())


def _serve() -> None:
    """Simulate until the standard input ends; each line of it asks for the path since the last."""
    from franky_sim import SimulationServer
    from franky_sim.mujoco_simulator import MujocoSimulator

    signal.alarm(_LONGEST)
    path: list[list[float]] = []
    over = threading.Event()
    with MujocoSimulator() as simulator:
        arm = simulator.add_robot()
        simulator.register_post_step_callback(lambda _: path.append([float(x) for x in arm.state.O_T_EE[12:15]]))
        with SimulationServer(simulator) as server:

            def run() -> None:
                answering, stepped = False, time.monotonic()
                while not over.is_set():
                    time.sleep(max(stepped + SECONDS_A_STEP - time.monotonic(), 0.0))
                    stepped = time.monotonic()
                    server.run_once(realtime=not answering)
                    if arm.server.current_motion_id:
                        patience = _UNANSWERED if answering else 0.0  # a driver takes some steps to begin
                        commands, _, _ = select.select([arm.server._FrankaServer__udp_socket], [], [], patience)
                        answering = bool(commands)
                    else:
                        answering = False

            loop = threading.Thread(target=run)
            loop.start()
            print(arm.hostname, flush=True)
            for _ in sys.stdin:
                told = len(path)
                print(json.dumps(path[:told]), flush=True)
                del path[:told]
            over.set()
            loop.join()


if __name__ == "__main__":
    _serve()
