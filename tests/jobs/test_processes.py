"""Processes that work for the one that hears the terminal."""

import subprocess
import sys

FIRST = """
import os, signal, time
from multiprocessing import get_context
from maulstick.jobs.processes import deaf_to_interrupts

with deaf_to_interrupts():
    first = get_context("spawn").Process(target=time.sleep, args=(0.2,))
    first.start()
os.kill(first.pid, signal.SIGINT)
first.join()
print(first.exitcode)
"""


def test_the_first_process_of_all_does_not_hear_ctrl_c_either() -> None:
    run = subprocess.run([sys.executable, "-c", FIRST], capture_output=True, text=True, check=True)
    assert (run.stdout, run.stderr) == ("0\n", "")
