"""Pretrained networks, and the views of a canvas that they are shown."""
