"""``maulstick`` that saves its plan in the making after every step, and is killed once it did so N times (0: never).

python -m tests.support.cli.mortal N paint …
"""

import os
import signal
import sys

from maulstick.cli import main
from maulstick.jobs.plan import checkpoints as keeping

_write_state = keeping.write_state
_left = int(sys.argv.pop(1)) if __name__ == "__main__" else 0  # processes that it makes itself are not killed


def _write_and_die(*what: object) -> None:
    global _left
    _write_state(*what)  # type: ignore[arg-type]
    _left -= 1
    if _left == 0:
        os.kill(os.getpid(), signal.SIGKILL)


keeping._EVERY = 0.0
keeping._SHARE = 0
keeping.write_state = _write_and_die

if __name__ == "__main__":
    main()
