"""Murals: pictures too large to be planned in one piece, planned in windows."""
