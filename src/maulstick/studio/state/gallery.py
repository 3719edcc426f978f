"""Pictures that people brought to be painted, each in a folder with picture.png and small.jpg."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.request import demo_picture
from maulstick.painting.picture import LONGEST_KEPT_PX, encode_jpeg, encode_png, read_picture
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import whole_folder
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.titles import retitle
from maulstick.studio.workers.desk import Desk

SCREEN = "screen.jpg"
"""File of a picture as large as a screen, made once it is wanted."""

_SMALL = "small.jpg"
_SMALL_PX, _SCREEN_PX = 480, 1920  # longest side of a thumbnail, and of a picture to look at
_PORTRAIT, _PORTRAIT_TITLE = "portrait", "Portrait"


@final
class Gallery:
    """Pictures by their names. changed: emitted after one came, went or has another title."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._keeping = asyncio.Lock()  # or two uploads at once could get the same name
        self._showing = asyncio.Lock()  # or two clicks at once would bring the example twice

    def names(self) -> list[str]:
        """Return the names of all pictures, newest first."""
        return [name for name in reversed(self._folder.names("pictures")) if self.path(name).is_file()]

    def path(self, name: str) -> Path:
        """Return the file of a picture, which need not exist. Raises InputError for an invalid name."""
        return picture_of(self._folder.of("pictures", name))

    def small(self, name: str) -> Path:
        """Return the file of a picture's thumbnail. Raises InputError for an invalid name."""
        return self.path(name).with_name(_SMALL)

    async def screen(self, name: str) -> Path:
        """Return the file of a picture as large as a screen. Raises InputError where the picture is gone."""
        path = self.path(name).with_name(SCREEN)
        if not path.is_file():
            await self._desk.do(keep_screen, self.path(name), path)
        return path

    def shape(self, name: str) -> tuple[int, int]:
        """Return height and width of a picture, pixels, by the head of its file. Raises InputError where it is gone."""
        try:
            with Image.open(self.path(name)) as picture:
                return picture.height, picture.width
        except OSError as error:
            raise InputError(f"the picture {name} is there no more; bring it again") from error

    async def keep(self, brought: Path, called: str) -> str:
        """Store a picture and return its name here. Raises InputError for what is no picture, or too large a one.

        called: name of the file that was brought.
        """
        async with self._keeping:
            title = self._folder.title_for_file("pictures", called)
            name = self._folder.free_name("pictures", title)
            await self._desk.do(keep_picture, brought, folder := self._folder.of("pictures", name))
            retitle(folder, title)
        self.changed.emit()
        return name

    def titles(self) -> dict[str, str]:
        """Return the titles of all pictures by name."""
        return self._folder.titles("pictures")

    def retitle(self, name: str, title: str) -> None:
        """Give a picture another title. Raises InputError as `titles.retitle`."""
        retitle(self._folder.of("pictures", name), title)
        self.changed.emit()

    def throw_away(self, name: str) -> Path:
        """Move a picture into the trash; return its place there. Raises InputError where there is none of that name."""
        if not (path := self.path(name)).is_file():
            raise InputError("that picture is there no more; look in the trash")
        trashed = self._folder.throw_away(path.parent)
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move a picture back out of the trash; raises, and name, as `Folder.take_back`."""
        self._folder.take_back(trashed, self._folder.root / "pictures", name)
        self.changed.emit()

    async def keep_portrait(self) -> str:
        """Store the picture that comes with Maulstick, unless it is there; return its name."""
        async with self._showing:
            return _PORTRAIT if _PORTRAIT in self.names() else await self.keep(demo_picture(), _PORTRAIT_TITLE)


def keep_picture(brought: Path, folder: Path) -> None:
    """Store the pixels of a picture, and nothing else of its file, in a new folder, written whole or not at all.

    Raises InputError for what is no picture, or too large a one, and where the folder exists by now; OutputError where
    there is no room for it.
    """
    picture = read_picture(brought, longest_px=LONGEST_KEPT_PX)
    taken = f"there is a picture {folder.name} meanwhile; use that one, or bring yours again"
    with whole_folder(folder, taken) as made:
        atomic_write(made / "picture.png", encode_png(picture))
        with Image.open(made / "picture.png") as small:
            small.thumbnail((_SMALL_PX, _SMALL_PX))
            small.save(made / _SMALL, quality=85)


def keep_screen(picture: Path, path: Path) -> None:
    """Write a picture as large as a screen. Raises InputError where there is none, OutputError where no room is."""
    atomic_write(path, encode_jpeg(read_picture(picture), _SCREEN_PX))


def picture_of(folder: Path) -> Path:
    """Return the file of the picture in its folder."""
    return folder / "picture.png"
