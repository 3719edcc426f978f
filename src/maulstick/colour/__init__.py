"""Colours: sRGB and light, palettes, tubes of paint, and how to mix them."""
