"""Planning: all strokes of a painting at once, by gradient descent."""
