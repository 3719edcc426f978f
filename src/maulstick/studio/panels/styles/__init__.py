"""Panel Styles."""
