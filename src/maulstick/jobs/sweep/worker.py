"""Process that finishes one cell after another: a folder per line of its input, an answer per line of its output.

It needs nothing of the program that started it, which may have no main module to import again, but the number of its
process: that may be gone before this one can look.
"""

import json
import os
import sys

from maulstick.jobs.sweep.cell import plan_cell


def work() -> None:
    """Answer each line with what `plan_cell` returns, as JSON; leave with the process that asked."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints is no answer
    asker = int(sys.argv[1])
    for line in sys.stdin:
        said = plan_cell(json.loads(line), lambda: os.getppid() == asker)
        print(json.dumps(said), file=answers, flush=True)


if __name__ == "__main__":
    work()
