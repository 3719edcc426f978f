"""Fits of a brush to photographs of strokes that were drawn one at a time."""
