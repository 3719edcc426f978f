"""Panel Survey."""
