"""The two pages of reference, made out of the program itself: all commands, and what Python programs call or extend."""

import runpy

from elsewhere import ROOT
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import maulstick

EXTENDED = {
    "Objects": [
        "maulstick.painting.painting.Stroke",
        "maulstick.painting.brush.Brush",
        "maulstick.strokes.ink.Ink",
        "maulstick.painting.metrics.Metrics",
        "maulstick.planning.result.PlanProgress",
        "maulstick.api.machine.PaintResult",
    ],
    "Options of painting": [
        "maulstick.jobs.paint.options.PaintOptions",
        "maulstick.drawing.options.DrawingOptions",
    ],
    "Machines": [
        "maulstick.robot.limits.Limits",
        "maulstick.robot.easel.Easel",
        "maulstick.robot.check.check_robot",
    ],
    "Styles": ["maulstick.style.style.Style"],
    "Objectives": [
        "maulstick.planning.objectives.objective.Objective",
        "maulstick.planning.objectives.objective.NetworkLoss",
    ],
    "Errors": [
        "maulstick.errors.InputError",
        "maulstick.errors.OutputError",
        "maulstick.errors.MachineError",
        "maulstick.robot.robot.StoppedError",
    ],
}
FRONT = """# Python

    import maulstick as ms

What `ms` has, and below it what programs get from it, give to it, or extend ([Contributing](contributing.md)).
Lengths are metres, angles radians, times seconds, colours sRGB in [0, 1].
"""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add both pages."""
    commands = runpy.run_path(str(ROOT / "experiments" / "commands.py"))["page"]()
    files.append(File.generated(config, "commands.md", content=commands))
    files.append(File.generated(config, "python.md", content=_python()))
    return files


def _python() -> str:
    front = [f"maulstick.{name}" for name in maulstick.__all__ if name != "__version__"]
    sections = {"The front door": front, **EXTENDED}
    return FRONT + "".join(
        f"\n## {title}\n\n" + "\n".join(f"::: {name}\n" for name in names) for title, names in sections.items()
    )
