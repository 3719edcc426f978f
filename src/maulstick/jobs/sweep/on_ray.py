"""Sweep on a Ray cluster: each cell is a task; Ray finds it a machine, and a GPU where it asks for one."""

import math
import signal
import socket
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from threading import current_thread, main_thread
from typing import Any

from maulstick.errors import InputError, MachineError, how_to_add
from maulstick.jobs.processes import deaf_to_interrupts
from maulstick.jobs.sweep.cell import needs_gpu, plan_cell

_PATIENCE = 5.0  # seconds


class OnRay:
    """Engine of the Ray cluster at an address, or of a small one on this machine for as long as it is used.

    All its machines have Maulstick, and see the sweep's folder at the same path.
    at_once: most cells at a time; without it Ray's queue has them all.
    Raises InputError where there is no Ray, and MachineError where the cluster does not answer.
    """

    def __init__(self, address: str | None, at_once: int | None) -> None:
        try:
            import ray
        except ImportError as error:
            raise InputError(f"ray needs the package of this name; {how_to_add('ray')}") from error
        if address is not None:
            _check_answers(address)
        self._ray = ray
        self.room = math.inf if at_once is None else float(at_once)
        own = {"num_cpus": at_once} if address is None else {}
        try:
            with _our_signals(), deaf_to_interrupts():
                ray.init(
                    address=address or "local",
                    include_dashboard=False if address is None else None,
                    configure_logging=False,
                    log_to_driver=False,
                    **own,
                )
        except (OSError, RuntimeError, ValueError) as error:
            raise _silent(address or "on this machine", error) from error
        self._task: Any = ray.remote(max_retries=0)(plan_cell)  # those that fail are tried again by the sweep

    def submit(self, folders: Sequence[Path]) -> list["Future[str | None]"]:
        """Hand the cells in these folders to Ray. Raises InputError where they ask for a GPU that is not there."""
        gpus = {folder: int(needs_gpu(folder)) for folder in folders}
        if any(gpus.values()) and "GPU" not in self._ray.cluster_resources():
            raise InputError("device is cuda, and no machine of the Ray cluster has a GPU; leave it out")
        return [self._task.options(num_gpus=gpus[folder]).remote(str(folder.absolute())).future() for folder in folders]

    def stop(self) -> tuple[()]:
        """Take nothing back: what begins from now on sees that it is to stop before it loads anything."""
        return ()

    def close(self) -> None:
        """Leave the cluster, which ends what still runs."""
        with _our_signals():
            self._ray.shutdown()


@contextmanager
def _our_signals() -> Iterator[None]:
    """Keep the handlers of Ctrl-C and of SIGTERM: Ray sets its own."""
    if current_thread() is not main_thread():  # nobody can set them from there
        yield
        return
    before = {each: signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)


def _check_answers(address: str) -> None:
    """Raise MachineError where nobody listens at HOST:PORT, at which Ray would knock for minutes."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if port.isdigit():
        try:
            socket.create_connection((host, int(port)), _PATIENCE).close()
        except (OSError, OverflowError) as error:
            raise _silent(address, error) from error


def _silent(where: str, error: Exception) -> MachineError:
    reason = (str(error) or type(error).__name__).splitlines()[0]
    return MachineError(f"the Ray cluster {where} does not answer: {reason}; start it, or check its address")
