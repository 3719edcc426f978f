"""Panel Trash."""
