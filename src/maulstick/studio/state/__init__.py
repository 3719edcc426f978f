"""What all pages of the studio show, and keep on disk."""
