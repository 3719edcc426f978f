"""``maulstick calibrate``: what must be known before a machine paints."""

import typer

from maulstick.cli.calibrate.brush import brush
from maulstick.cli.calibrate.camera import camera
from maulstick.cli.calibrate.colours import colours
from maulstick.cli.calibrate.tags import tags
from maulstick.cli.calibrate.touch import touch

calibrate = typer.Typer(
    no_args_is_help=True, help="Tell a machine where its sheet lies, a camera what it sees, and learn a brush."
)
calibrate.command()(touch)
calibrate.command()(tags)
calibrate.command()(camera)
calibrate.command()(colours)
calibrate.command()(brush)
