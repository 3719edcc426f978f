"""Surveys among people: who drew these strokes, and which of two looks is preferred (paper: Human Evaluations)."""
