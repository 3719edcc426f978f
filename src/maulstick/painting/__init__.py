"""Paintings: sheet, brushes, paints and strokes, and their files."""
