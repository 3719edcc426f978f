"""Painting: options, preparation and runs of a machine that paints."""
