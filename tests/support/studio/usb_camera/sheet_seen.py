"""Sheet that the stand-in for a USB camera sees."""

SIZE = 640, 480
CORNERS = [(120, 90), (520, 110), (560, 400), (80, 380)]
"""Corners of the sheet, from the upper left one as a clock goes, pixels."""
