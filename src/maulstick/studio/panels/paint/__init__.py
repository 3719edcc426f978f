"""Panel Paint."""
