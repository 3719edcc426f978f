"""The command line: every command is one small function; its work is done in other packages."""

import os
import sys
from io import TextIOWrapper

from maulstick.cli.exit_codes import FAILED, MACHINE, STOPPED, UNUSABLE
from maulstick.cli.loading import no_garbage
from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import MachineError, MaulstickError, OutputError, needs_torch


def main() -> None:
    """Run the command line, and leave with its exit code; an error is one line on the standard error."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files may be any bytes
    try:
        with no_garbage():
            from maulstick.cli.app import run  # takes a moment, in which Ctrl-C may come

        with needs_torch():
            code = run()
        sys.exit(code)
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except MaulstickError as error:
        print(f"maulstick: {COMMAND_LINE.say(error)}", file=sys.stderr)
        sys.exit(FAILED if isinstance(error, OutputError) else MACHINE if isinstance(error, MachineError) else UNUSABLE)
    except OSError as error:  # for most files this is a MaulstickError
        where = error.filename or "the standard output"
        print(f"maulstick: cannot write to {where}: {error.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python, leaving, writes what it still holds, and fails again
        sys.exit(FAILED)
