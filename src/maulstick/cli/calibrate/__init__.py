"""``maulstick calibrate``: measures the sheet's place, the camera, the light and a brush before a machine paints."""

import typer

from maulstick.cli.calibrate.brush import brush
from maulstick.cli.calibrate.camera import camera
from maulstick.cli.calibrate.colours import colours
from maulstick.cli.calibrate.tags import tags
from maulstick.cli.calibrate.touch import touch

calibrate = typer.Typer(
    no_args_is_help=True, help="Measure where the sheet lies, what a camera sees, and how a brush paints."
)
calibrate.command()(touch)
calibrate.command()(tags)
calibrate.command()(camera)
calibrate.command()(colours)
calibrate.command()(brush)
