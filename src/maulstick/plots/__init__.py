"""Plots: pictures of ink, strokes and brushes, for people to look at."""
