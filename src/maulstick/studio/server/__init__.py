"""Server of the studio, and the gate in front of it."""
