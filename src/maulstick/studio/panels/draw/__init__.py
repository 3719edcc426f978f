"""The panel Draw."""
