"""A sweep's worker that saves its plan after every step, noting in the file MORTAL_WORKER what was planned of which.

Where that file is not there when it starts, it is killed once it saved ten times.
"""

import os
import signal
from pathlib import Path

from maulstick.jobs.plan import checkpoints
from maulstick.jobs.sweep.worker import work

_write_state = checkpoints.write_state
_noted = Path(os.environ["MORTAL_WORKER"])
_left = 0 if _noted.exists() else 10


def _write_and_die(path: Path, state: object, request: object) -> None:
    global _left
    _write_state(path, state, request)  # type: ignore[arg-type]
    with _noted.open("a") as file:
        print(f"{path.name}:{state['progress'][0]:.9f}", file=file)  # type: ignore[index]
    _left -= 1
    if _left == 0:
        os.kill(os.getpid(), signal.SIGKILL)


checkpoints._EVERY = 0.0
checkpoints._SHARE = 0
checkpoints.write_state = _write_and_die  # type: ignore[assignment]

if __name__ == "__main__":
    work()
