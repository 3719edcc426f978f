"""The order of strokes: few changes of paint, little travel, and every overlap as planned."""
