"""The command line. Every word is one small function; what it does lives elsewhere."""

import os
import sys
from io import TextIOWrapper

from maulstick.cli.exit_codes import STOPPED
from maulstick.cli.wording import COMMAND_LINE
from maulstick.errors import MachineError, MaulstickError, OutputError


def main() -> None:
    """Run the command line; a user's mistake is one line."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # names of files may be any bytes
    try:
        from maulstick.cli.app import app  # takes a moment, in which Ctrl-C may come

        app()
    except KeyboardInterrupt:
        sys.exit(STOPPED)
    except MaulstickError as error:
        print(f"maulstick: {COMMAND_LINE.say(error)}", file=sys.stderr)
        sys.exit(1 if isinstance(error, OutputError) else 3 if isinstance(error, MachineError) else 2)
    except OSError as error:  # a file would be a MaulstickError
        print(f"maulstick: cannot write to the standard output: {error.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or Python, leaving, writes what it still holds, and fails again
        sys.exit(1)
