"""``maulstick calibrate camera``: from a photograph to the flat sheet."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from maulstick.cli.folder import check_absent
from maulstick.errors import InputError
from maulstick.painting.picture import encode_png, read_picture
from maulstick.painting.raster import flat_canvas, parse_size
from maulstick.storage.arrays import Floats
from maulstick.storage.files import atomic_write

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from maulstick.calibration.camera import CameraView
    from maulstick.robot.camera.tag_frame import TagFrame


def camera(
    photo: Annotated[Path, typer.Argument(help="A photograph of the sheet with its four tags.")],
    size: Annotated[str, typer.Option(metavar="SIZE", help="Of the sheet: 200x160mm, A4-landscape.")],
    tag: Annotated[float, typer.Option(metavar="MM", help="The side of the tags' black squares.")] = 20,
    corners: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y X,Y X,Y X,Y",
            help="Without tags: the sheet's upper left, upper right, lower right and lower left corner, pixels.",
        ),
    ] = None,
    colours: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Of this light, from maulstick calibrate colours.")
    ] = None,
    keep: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Keep where the sheet is, for a camera that does not move.")
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE", help="The PNG; by default beside the photograph.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace a picture there.")] = False,
) -> None:
    """Make the sheet in a photograph flat, and say how far that can be wrong.

    What is written suits maulstick plan --background.
    """
    sheet = parse_size(size)
    path = out or photo.with_name(f"{photo.stem}-flat.png")
    if path.suffix.lower() != ".png":
        raise InputError(f"--out is {path}; an image is written as PNG, so let its name end in .png")
    check_absent(path, "--out", overwrite)
    if keep is not None:
        check_absent(keep, "--keep", overwrite)
    from maulstick.calibration.camera import write_view
    from maulstick.calibration.colour import read_colours, whites_of
    from maulstick.robot.camera.tag_frame import TagFrame

    picture, frame = read_picture(photo), TagFrame(*sheet, side=tag * 1e-3)
    view = view_of(picture, frame, corners)
    flat = view.rectify(picture, flat_canvas(*sheet))
    if colours is not None:
        flat = read_colours(colours).correct(flat, whites_of(picture, view, frame))
    atomic_write(path, encode_png(flat))
    if keep is not None:
        write_view(view, keep)
    if view.error is None:
        print("four corners: how far that is wrong cannot be known", flush=True)
    else:
        usual, worst = (1e3 * error for error in view.error)
        print(f"{len(view.tags)} tags: {usual:.2f} mm, at worst {worst:.2f} mm", flush=True)
    print(path, flush=True)


def view_of(picture: "NDArray[np.float32]", frame: "TagFrame", corners: str | None) -> "CameraView":
    """By the tags, or by the words of four corners."""
    from maulstick.calibration.camera import locate, view_of_corners

    if corners is None:
        return locate(picture, frame)
    size = picture.shape[1], picture.shape[0]
    return view_of_corners(four_points(corners, "--corners"), (frame.width, frame.height), size)


def four_points(words: str, option: str) -> Floats:
    """(4, 2) from four words of two numbers."""
    try:
        points = np.array([[float(x) for x in word.split(",")] for word in words.split()], dtype=np.float64)
        if points.shape != (4, 2) or not np.isfinite(points).all():
            raise ValueError
    except ValueError:
        raise InputError(f"{option} is {words!r}; it must be four points, as in '10,12 630,9 640,470 5,480'") from None
    return points
