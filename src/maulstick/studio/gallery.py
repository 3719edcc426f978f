"""The pictures that people brought to be painted. A name is a folder with picture.png and small.jpg."""

from importlib.resources import files
from pathlib import Path

from PIL import Image

from maulstick.files import atomic_write
from maulstick.picture import LONGEST_KEPT_PX, encode_png, read_picture

_SMALL_PX = 480


def portrait() -> Path:
    """The picture that comes along."""
    return Path(str(files("skimage.data").joinpath("astronaut.png")))


def keep_picture(brought: Path, folder: Path) -> None:
    """Keep the pixels of a picture, and nothing else of its file, in a new folder.

    Raises InputError for what is no picture, or too large a one.
    """
    picture = read_picture(brought, longest_px=LONGEST_KEPT_PX)
    folder.mkdir()
    atomic_write(folder / "picture.png", encode_png(picture))
    small = Image.open(folder / "picture.png")
    small.thumbnail((_SMALL_PX, _SMALL_PX))
    small.save(folder / "small.jpg", quality=85)


def picture_of(folder: Path) -> Path:
    """The picture in its folder."""
    return folder / "picture.png"
