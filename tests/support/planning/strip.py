"""A strip of a picture that is quickly planned as a mural: eight windows side by side, in two rounds of four."""

from collections.abc import Callable

import numpy as np
from PIL import Image
from skimage.data import astronaut

from maulstick.painting.painting import Sheet
from maulstick.painting.raster import Canvas
from maulstick.planning.losses import LossOptions
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.mural.window import PlanWindows, in_turn
from maulstick.planning.mural.windows import Mural
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.result import PlanProgress, PlanResult
from maulstick.planning.state import State
from maulstick.style import load_style
from tests.support.nominal import nominal

WIDTH, HEIGHT, RESOLUTION = 0.32, 0.03, 800.0
CORE = 32
ROUNDS = ([0, 2, 4, 6], [1, 3, 5, 7])
SETTINGS = PlannerSettings(strokes=120, paints=3, steps=3)
TONE = LossOptions(weights={"tone": 1.0})


def strip_mural() -> Mural:
    picture = Image.fromarray(astronaut()[100:148]).resize((256, 24), Image.Resampling.LANCZOS)
    canvas = Canvas(WIDTH, HEIGHT, RESOLUTION)
    return Mural(np.asarray(picture, dtype=np.float32) / 255, Sheet(width=WIDTH, height=HEIGHT), canvas)


def plan_strip(
    plan_windows: PlanWindows = in_turn,
    watch: Callable[[PlanProgress], bool] = lambda progress: True,
    resume: State | None = None,
    settings: PlannerSettings = SETTINGS,
    loss_options: LossOptions = TONE,
) -> PlanResult:
    mural = strip_mural()
    return plan_mural(
        mural,
        (nominal("fineliner"),),
        load_style("free", mural.canvas),
        settings,
        watch,
        loss_options=loss_options,
        window_px=CORE,
        resume=resume,
        plan_windows=plan_windows,
    )
