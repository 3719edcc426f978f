"""The panel Plan."""
