"""Exit codes that the shell sees."""

FAILED = 1
"""Exit code where a result could not be written."""

UNUSABLE = 2
"""Exit code where a file or an option cannot be used."""

MACHINE = 3
"""Exit code where a machine or a camera failed."""

STOPPED = 130
"""Exit code after Ctrl-C: 128 plus the number of the signal, as shells count."""
