"""Cameras over the sheet, and the tags that they look for."""
