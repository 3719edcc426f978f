"""Strokes of a pen: ink as it was recorded, and strokes as arrays."""
