"""How far results may be from the truth: one table, never loosened (CONTRIBUTING.md, Style).

Values are darkness or colour, in [0, 1]; a gradient's error is a fraction of the largest entry of that same gradient.
"""

FLOAT32_VALUE = 5e-6
FLOAT32_GRADIENT = 1e-4

# A stroke from a point hundreds of pixels beside the canvas: float32 knows that point to 1e-4 of a pixel.
FLOAT32_VALUE_FAR = 1e-4
FLOAT32_GRADIENT_FAR = 1e-3

FINITE_DIFFERENCE = 1e-6

# A pixel beside the mean of the bare mark over it: around points, and at sharp corners and hairpins.
# In float32 the way across a stroke is known to no better where a pixel's centre lies on it.
FLOAT32_VALUE_CREASED, FLOAT32_GRADIENT_CREASED = 1e-4, 1e-3
BESIDE_A_POINT = 0.005
BESIDE_A_CORNER = 0.01

# A mark on pixels beside the bare mark's mean over each, for half-widths from 0.2 pixels: of a pixel, and of its ink.
ALONG_A_LINE, AT_A_DOT, AT_AN_END, AT_A_CORNER, AT_A_HAIRPIN = 0.004, 0.04, 0.055, 0.12, 0.18
INK_OF_A_LINE, INK_OF_A_DOT, INK_OF_A_HAIRPIN = 0.02, 0.14, 0.045  # a dot's from half a pixel on
MANY_STROKES = 0.0025  # mean over pixels and channels
JUMP = 0.002
GRADIENT_OF_THE_TRUTH = 0.1  # as a share, from a half-width of a pixel on

# Strokes, brush and plans. Lengths on a sheet are known in float32 to a hundredth of a micrometre or so.
FLOAT64_METRES = 1e-14
FLOAT32_METRES = 1e-7
FILE_METRES = 2e-6  # a trajectory, and the pose beside it, rounded to a micrometre in the painting's file
INK = 0.05  # of a stroke's ink in mm², from 256 to 1024 pixels and at any place between them

# A plan's likeness to its picture, beside marks that were sampled at 16 by 16 points a pixel.
TRUE_DECIBELS, TRUE_SSIM = 0.05, 0.002
PLANNED_DECIBELS = 0.2  # on the planner's own pixels
FINER_BANDS = 1e-4  # of a colour: a stroke's pixels count from its band's edge, which float32 rounds otherwise

# Codes of strokes: there and back again in float64, as a share of the largest number.
FLOAT64_ROUND_TRIP = 1e-11
FLOAT32_ROUND_TRIP = 5e-6
LEAST_SPLINE = 1e-6  # metres: a shape whose spline is shorter than this is known to no better
CODE_LOGARITHM = 1e-3  # of a sample's length or roughness: its residual of micrometres is kept in float32
DESCRIPTION = 1e-8  # of turning, of a path that was placed elsewhere: rounding over its shortest step

NATS = 1e-10  # of a cost at a centre, in float64: the square of no distance, from terms of 1e5 that cancel

MAX_MEAN_COST = 1.1  # times what a style allows, at the end of a plan whose few steps gave its weight no time to settle

# Golden pictures, in steps of 255: rounding may differ by processor, nothing more.
GOLDEN_WORST = 2
GOLDEN_MEAN = 0.05

# Recordings, metres. A take without noise is known to rounding; a pivot is solved for over all its poses.
FRAME_METRES = 1e-12
PIVOT_METRES = 1e-9
WACOM_FILE_METRES = 1e-6  # the resolution of the files that the tests write

# With 0.1 mm of noise on each marker, so 0.35 mm at the tip before smoothing.
FRAME_METRES_NOISY = 0.15e-3  # at any place on the sheet, in any frame
PIVOT_METRES_NOISY = 0.15e-3  # from a take of 10 s
TIP_METRES_NOISY = 0.5e-3  # 95 % of the time
PAPER_METRES = 0.05e-3  # anywhere on the sheet, with 0.06 mm of trembling left

# From a take to its strokes. What is asked for; and of all samples the median and 95 %, and of the ends the median,
# that five sessions with five seeds each keep to: at worst they had 0.11, 0.43 and 0.90 mm.
DRAWN_MEDIAN_ASKED = 0.3e-3
DRAWN_MEDIAN, DRAWN_P95, DRAWN_END = 0.13e-3, 0.48e-3, 1.1e-3

# The media of libmypaint, which draws at least two pixels wide and trails the pen.
MEDIUM_END = 0.2e-3  # metres between the end of a path and of its mark
MEDIUM_BLUR = 0.25  # pixels between a path and the middle of its mark
MEDIUM_INK = 0.08  # of a stroke's ink, from 5 to 20 pixels per millimetre
MEDIUM_COLOUR = 1e-3  # a colour in steps of 1/32768, after some dabs

# Trials, in the files of their folder: photographs in 8 bits, paths in micrometres (and pressure in millionths).
PHOTOGRAPH = 0.5001 / 255
EXECUTED_PATH = 0.5001e-6

# A brush fitted to five strokes of five to ten pixels in half-width: its widest mark, as a share of it.
FEW_STROKES_WIDTH = 0.02

# What a fit sees of its photographs, of 3 pixels a millimetre.
EVEN_LIGHT = 0.02  # of a photograph whose exposure and light, across it, were 10 % (one sigma) beside another's
MARK_EXTENT = 0.35e-3  # metres: a cone's edge is too pale to be seen, and a path is known to a pixel
MOVED_PX = 1.0
FLOW_NOISY = 0.05  # of an opacity, from 60 strokes that differ by 5 %
MARK_REACH = 0.6e-3  # metres that a stroke may lie beside its place and not touch the edge of its window

# A brush fitted to 20 simulated strokes of 2 to 5 pixels in half-width, with their noise.
SIGMAS = 3.5  # of the standard errors that were told
CLEAN_WIDTH = 0.01  # half-width at a pressure, as a share
KEPT_WIDTH = 0.02  # the same where much more is sought, or fewer strokes were drawn
KEPT_NUMBER = 0.05e-3  # metres: a lag
INK_COLOUR = 0.03
OPACITY = 0.06

# Colours of paints, sRGB.
LIGHTNESS_DRIFT = 6.0  # of 100: paints go on adapting after they are put in order, the lightest first
MIXED = 1e-7  # of a mix that must be what it was made of: the two pieces of sRGB's curve miss each other by 3e-8

# What is written to plotters: half of the last decimal, step or unit, and rounding.
GCODE_METRES = 0.5001e-6
STEP_METRES = 6.2501e-6  # along each axis, on the motors' grid
HPGL_METRES = 12.501e-6
FEED = 1e-4  # of a feed of at least 1000 mm/min with one decimal
CLOCK = 0.03  # an estimate of how long a machine takes: what is asked for
FIRMWARE_CLOCK = 0.01  # the fake Grbl beside the real firmware

# Arms. A stroke follows its path, and what touch finds of a sheet is known at any place on it; metres.
ARM_PATH = 0.5e-3
ARM_SETTLED = 0.1e-3  # where an arm says that it stands: the simulated Franka's own control leaves that much
ARM_TURNED = 2e-3  # of a rotation matrix, likewise
SET_POINT = 1e-9  # rounding, on a wire of millimetres
TOUCH = 1e-9
TOUCH_NOISY = 0.6e-3  # with 0.1 mm of noise at each of the four corners of A4

# Tours. Metres of pen-up travel, added up in another order.
TOUR_METRES = 1e-8

# The simulated webcam of 1600 x 1200 pixels over A4; metres on the sheet. What is asked for, and what is kept to.
RECTIFIED_ASKED = 0.3e-3
RECTIFIED, RECTIFIED_WORST = 0.06e-3, 0.15e-3
RECTIFIED_SMALL = 0.2e-3  # with 800 x 600 pixels, worst
ROUND_TRIP = 1e-9
TONES = 0.02  # of a picture that was photographed and put right, away from its edges, mean
WHITE = 0.004  # of bare paper, after the lamp and the exposure are taken out, mean
CHART_ERROR, OTHER_COLOURS = 1.2, 1.5  # mean CIEDE2000, of the chart and of colours that were not on it
MOVED, TURNED = 0.06e-3, 0.4e-3  # metres and radians, of a sheet by its edges or its strokes

# A painting in another order, and a stroke drawn backwards: metres of its mark, and steps of colour in float32.
MARK_METRES = 1e-6
SAME_PICTURE = 1e-5
CREASED = 0.001  # of the pixels: they lie as near to two steps of a stroke, and float32 decides

# Machines. Places of a sheet before a machine, of metres; and profiles of motion against sums over small steps of time.
FLOAT64_METRES_NEAR = 1e-12
PROFILE_SECONDS = 1e-9  # as a share: the same motion, added up otherwise
PROFILE_STEPPED = 2e-3  # as a share: the same motion in steps of length
PROFILE_ACCELERATION = 1e-3  # as a share, from differences of places
PAINTED_CORRELATION = 0.9  # of the simulated sheet with the brush's own picture of the painting: another tool drew it
SAME_SHEET = 1e-3  # of colour, on average: the same strokes on the simulated sheet, their places rounded otherwise

# The eye over a sheet, with the simulated webcam of 800 x 600 pixels: away from edges, and of a whole picture, mean.
GREYS = 0.03
PICTURE = 0.02
FOUND_OFFSET = 0.15e-3  # metres that strokes land beside their places, from one photograph of 12: what is asked for
FOUND_WIDTH = 0.2e-3  # metres of half-width, likewise
CHART_SEEN = 0.03  # of a chart that was photographed, made flat and corrected by itself, mean
LANDED = 0.3e-3  # metres that a stroke lands beside its place on a sheet that was moved, with 480 x 360 pixels

# Surveys. Shares that the literature prints with four digits; and how far counts of 2000 seeds lie from equal shares.
FOUR_DIGITS = 5e-5
SURVEY_BALANCE = 0.045  # four standard deviations of a fair coin

# Ink of the studio's sheets: thousandths of a millimetre, taken to metres.
INK_FILE_METRES = 1e-12
PEN_METRES = 0.02e-3  # of a place that a test points at on the page, where a browser counts in parts of a pixel

# Metres: less than a pixel of 20 micrometres on which a pen's line is measured.
PEN_WIDTH = 1.5e-5
