"""A brush: how a commanded stroke becomes a mark, and what a painting will look like."""
