"""Adapters: one subclass of `Robot` per machine, and the protocols that they speak."""
