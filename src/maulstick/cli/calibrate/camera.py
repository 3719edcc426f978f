"""``maulstick calibrate camera``: makes the sheet in a photograph flat."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer
from rich.console import Console

from maulstick.cli.folder import check_other, check_place
from maulstick.cli.lengths import metres
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
    photo: Annotated[Path, typer.Argument(help="Photograph of the sheet with its four tags.")],
    size: Annotated[str, typer.Option(metavar="SIZE", help="Size of the sheet: 200x160mm, A4-landscape.")],
    tag: Annotated[str, typer.Option(metavar="MM", help="Side of the black squares of the tags.")] = "20",
    corners: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y X,Y X,Y X,Y",
            help="Corners of the sheet in pixels, instead of tags: upper left, upper right, lower right, lower left.",
        ),
    ] = None,
    colours: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The camera's colours, from `maulstick calibrate colours`.")
    ] = None,
    keep: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File for the camera's view, if the camera does not move.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", show_default="beside the photograph", help="The PNG file to write.")
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", metavar="", help="Replace earlier files.")] = False,
) -> None:
    """Make the sheet in a photograph flat, and print how far that can be wrong.

    The picture that is written suits maulstick plan --background.

    Example: maulstick calibrate camera photo.jpg --size 200x160mm --out flat.png
    """
    sheet = parse_size(size)
    path = out or photo.parent / f"{photo.stem}-flat.png"
    if path.suffix.lower() != ".png":
        raise InputError(f"--out is {path}; an image is written as PNG, so let its name end in .png")
    read = {"the photograph": photo, "the file of --colours": colours}
    check_other(path, "--out", read)
    check_place(path, "--out", overwrite)
    if keep is not None:
        if path.resolve() == keep.resolve():
            raise InputError(f"--out and --keep are both {path}; choose another --keep")
        check_other(keep, "--keep", read)
        check_place(keep, "--keep", overwrite)
    from maulstick.calibration.camera import write_view
    from maulstick.calibration.colour import read_colours, whites_of
    from maulstick.robot.camera.tag_frame import TagFrame

    picture, frame = read_picture(photo), TagFrame(*sheet, side=metres(tag, "--tag"))
    view = view_of(picture, frame, corners)
    flat = view.rectify(picture, flat_canvas(*sheet))
    if colours is not None:
        known = read_colours(colours)
        flat = known.correct(flat, whites_of(picture, view, frame))
        if known.is_of_another(sheet):
            note = f"the lamp in {colours} is that of a sheet of another size; measure it on this one"
            Console(stderr=True, markup=False, highlight=False).print(f"note: {note}", soft_wrap=True)
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
    """Return where the camera sees the sheet: by its tags, or by four corners in pixels, as in ``10,12 630,9 …``."""
    from maulstick.calibration.camera import locate, view_of_corners

    if corners is None:
        return locate(picture, frame)
    size = picture.shape[1], picture.shape[0]
    return view_of_corners(four_points(corners, "--corners"), (frame.width, frame.height), size)


def four_points(words: str, option: str) -> Floats:
    """Return four points (4, 2) from their text. Raises InputError, which names the `option`, for other texts."""
    try:
        points = np.array([[float(x) for x in word.split(",")] for word in words.split()], dtype=np.float64)
        if points.shape != (4, 2) or not np.isfinite(points).all():
            raise ValueError
    except ValueError:
        raise InputError(f"{option} is {words!r}; it must be four points, as in '10,12 630,9 640,470 5,480'") from None
    return points
