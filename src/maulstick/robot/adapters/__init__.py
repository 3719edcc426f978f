"""Adapters: what each machine needs to be driven."""
