"""Renderer: a dense reference implementation, and fast kernels that are tested against it."""
