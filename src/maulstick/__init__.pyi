from .api.learning import fit_brush, fit_style, load_style, read_ink
from .api.machine import paint
from .api.painting import Painting, read_painting
from .api.planning import compare, plan, render
from .api.sweeping import sweep
from .errors import InputError, MachineError, MaulstickError, OutputError
from .jobs.plan.options import PlanOptions
from .painting.brush import load_brush
from .robot.robot import Robot

__version__: str

__all__ = [
    "InputError",
    "MachineError",
    "MaulstickError",
    "OutputError",
    "Painting",
    "PlanOptions",
    "Robot",
    "__version__",
    "compare",
    "fit_brush",
    "fit_style",
    "load_brush",
    "load_style",
    "paint",
    "plan",
    "read_ink",
    "read_painting",
    "render",
    "sweep",
]
