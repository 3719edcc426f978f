"""The studio: one web page from a hand to a painting."""
