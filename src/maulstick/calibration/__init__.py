"""Calibration before a machine paints: the places of sheet and camera, and the camera's colours."""
