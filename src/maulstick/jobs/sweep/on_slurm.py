"""Sweep on Slurm, by submitit: each cell is a job, which is requeued and goes on from its plan in the making."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import JsonValue

from maulstick.errors import InputError, how_to_add
from maulstick.jobs.sweep.cell import needs_gpu, plan_cell
from maulstick.jobs.sweep.sweep import Job

_MINUTES = 240  # of a job, unless the grid says otherwise


class PlanCell:
    """`plan_cell` for submitit."""

    def __call__(self, folder: str) -> str | None:
        """Finish the cell in a folder."""
        return plan_cell(folder)

    def checkpoint(self, folder: str) -> Any:
        """Return what a requeued job does: the same, which finds the plan in the making."""
        from submitit.helpers import DelayedSubmission

        return DelayedSubmission(self, folder)


class OnSlurm:
    """Engine of a Slurm cluster, all of whose machines see the folder `out` at the same path.

    at_once: most cells at a time; without it Slurm's queue has them all.
    parameters: of submitit's ``update_parameters``.  cluster: ``slurm``, or ``local`` for processes here.
    Raises InputError where there is no submitit, no Slurm, or no such parameter.
    """

    def __init__(
        self, out: Path, at_once: int | None, parameters: Mapping[str, JsonValue], cluster: str = "slurm"
    ) -> None:
        try:
            from submitit import AutoExecutor
        except ImportError as error:
            raise InputError(f"slurm needs submitit; {how_to_add('slurm')}") from error
        self.room = math.inf if at_once is None else float(at_once)
        self._jobs: list[Any] = []
        self._executors: dict[bool, Any] = {}  # by whether its jobs have a GPU
        try:
            for gpu in (False, True):
                more = {"gpus_per_node": 1} if gpu else {}
                executor = AutoExecutor(folder=out.absolute() / ".jobs", cluster=cluster)
                executor.update_parameters(**{"name": "maulstick", "timeout_min": _MINUTES, **more, **parameters})
                self._executors[gpu] = executor
        except RuntimeError as error:
            raise InputError(f"there is no Slurm here ({error}); run this on a machine that submits jobs") from error
        except (NameError, TypeError, ValueError, AssertionError) as error:
            raise InputError(f"the grid's parameters of slurm cannot be used: {str(error).splitlines()[0]}") from error

    def submit(self, folders: Sequence[Path]) -> Sequence[Job]:
        """Submit an array of jobs; cells that ask for a GPU get one each."""
        jobs: dict[Path, Any] = {}
        for gpu, executor in self._executors.items():
            these = [folder for folder in folders if needs_gpu(folder) == gpu]
            if these:
                paths = [str(folder.absolute()) for folder in these]
                jobs |= zip(these, executor.map_array(PlanCell(), paths), strict=True)
        self._jobs += jobs.values()
        return [jobs[folder] for folder in folders]

    def stop(self) -> Sequence[Job]:
        """Cancel the jobs that wait in the queue, and return them."""
        waiting = [job for job in self._jobs if job.state in ("PENDING", "REQUEUED")]
        for job in waiting:
            job.cancel()
        self._jobs = [job for job in self._jobs if job not in waiting]
        return waiting

    def close(self) -> None:
        """Cancel all jobs that are not done."""
        for job in self._jobs:
            if not job.done():
                job.cancel()
