"""Exit codes that the shell sees."""

STOPPED = 130
"""Stopped with Ctrl-C: 128 and the number of the signal, as shells count."""
