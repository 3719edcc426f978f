"""Panel Draw."""
