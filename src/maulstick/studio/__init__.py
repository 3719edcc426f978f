"""Studio: one web page for the way from a hand to a painting."""
