"""How far results may be from the truth: one table, never loosened (design §6.10).

Values are darkness or colour, in [0, 1]; a gradient's error is a fraction of the largest entry of that same gradient.
"""

FLOAT32_VALUE = 5e-6
FLOAT32_GRADIENT = 1e-4

# A stroke from a point hundreds of pixels beside the canvas: float32 knows that point to 1e-4 of a pixel.
FLOAT32_VALUE_FAR = 1e-4
FLOAT32_GRADIENT_FAR = 1e-3

FINITE_DIFFERENCE = 1e-6

# Strokes, brush and plans. Lengths on a sheet are known in float32 to a hundredth of a micrometre or so.
FLOAT64_METRES = 1e-14
FLOAT32_METRES = 1e-7
FILE_METRES = 2e-6  # a trajectory, and the pose beside it, rounded to a micrometre in the painting's file
INK = 0.05  # of a stroke's ink in mm², from 256 to 1024 pixels and at any place between them

# Golden pictures, in steps of 255: rounding may differ by processor, nothing more.
GOLDEN_WORST = 2
GOLDEN_MEAN = 0.05
