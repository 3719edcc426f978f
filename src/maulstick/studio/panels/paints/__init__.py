"""Panel Paints."""
