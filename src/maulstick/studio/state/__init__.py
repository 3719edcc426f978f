"""State of the studio: shown on all pages, and kept on disk."""
