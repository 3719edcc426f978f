"""A painting: its sheet, brushes, paints and strokes, and its files."""
