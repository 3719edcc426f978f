"""Names of colours in plain words."""

from typing import Final

import numpy as np

from maulstick.colour.palette import nearest_paint

_WORDS: Final = {
    "#ffffff": "white",
    "#cccccc": "pale grey",
    "#8c8c8c": "grey",
    "#4d4d4d": "dark grey",
    "#0d0d0d": "black",
    "#f29bb4": "pink",
    "#d62a28": "red",
    "#7d1c1c": "dark red",
    "#ee8a2b": "orange",
    "#e3b596": "peach",
    "#b4532a": "rust",
    "#77502f": "brown",
    "#3d2a1e": "dark brown",
    "#f3e9cf": "cream",
    "#cdb48a": "sand",
    "#c2902f": "ochre",
    "#f5d93a": "yellow",
    "#77762f": "olive",
    "#aed6a0": "pale green",
    "#3f9a45": "green",
    "#1f4a2c": "dark green",
    "#36b3ac": "turquoise",
    "#1c5a5e": "dark turquoise",
    "#a5cbe6": "pale blue",
    "#2c62c9": "blue",
    "#1a33b2": "blue",
    "#4f86d8": "blue",
    "#1d2a63": "dark blue",
    "#262c40": "dark blue",
    "#6f879c": "grey blue",
    "#7a44a8": "violet",
    "#c0a5d8": "lilac",
    "#c2287f": "magenta",
    "#5a2446": "plum",
}
"""Names of some colours; there are several blues, because distance in CIELAB alone takes many blues for violet."""


def colour_word(colour: tuple[float, float, float]) -> str:
    """Return the plain name nearest to a colour, sRGB in [0, 1]; two paints may get the same name."""
    known = np.array([tuple(bytes.fromhex(known[1:])) for known in _WORDS]) / 255
    return list(_WORDS.values())[int(nearest_paint(np.array([colour]), known)[0])]
