"""Panels of the page, one folder per panel."""
