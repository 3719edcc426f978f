"""What must be known before a machine paints: where the sheet and the camera are, and what colours it sees."""
