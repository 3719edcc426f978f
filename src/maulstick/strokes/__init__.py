"""Ink as recorded, and strokes as arrays."""
