"""Recordings: from what a person drew, in motion capture or on a tablet, to ink."""
