"""Colours: sRGB and linear light, palettes, tubes of paint, and recipes for mixing them."""
