"""Painting: what was asked of the machine, and what stands ready for it."""
