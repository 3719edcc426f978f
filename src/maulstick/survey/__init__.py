"""Surveys among people: whose strokes are these, and which of two looks do they prefer (paper, Human Evaluations)."""
