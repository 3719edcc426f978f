"""Recordings of a person's drawing, by motion capture or on a tablet, and their conversion to ink."""
