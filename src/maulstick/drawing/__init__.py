"""Drawings: any SVG, read as a painting that a machine draws as it is."""
