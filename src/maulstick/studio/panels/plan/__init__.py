"""Panel Plan."""
