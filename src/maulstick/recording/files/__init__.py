"""Readers of ink files, one per format."""
