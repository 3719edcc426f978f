"""Sweeps: every combination of some options is a plan of its own, made by processes here or by other machines."""
