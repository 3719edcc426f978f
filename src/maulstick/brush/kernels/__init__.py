"""Learn a hand, know a brush, plan a painting, paint it."""
