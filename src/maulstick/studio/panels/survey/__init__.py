"""The panel Survey."""
