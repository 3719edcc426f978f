"""Cameras over the sheet, and the tags beside it."""
