"""Views of cameras whose sheet was shown by its corners, kept in the studio's folder by camera and sheet."""

from pathlib import Path
from typing import Final, final

from maulstick.errors import OutputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.workers.camera_work import Corners, SeenSheet, keep_corners, see_sheet
from maulstick.studio.workers.desk import Desk

CAMERAS: Final = "cameras"
"""Folder of the views, within the studio's."""

_TITLE = "Corners of the sheet"


@final
class CameraViews:
    """Views in the folder ``cameras``: a view is of one camera, and of sheets of one size."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self._folder, self._desk, self._root = folder, desk, folder.root / CAMERAS

    def path(self, camera: str, sheet: tuple[float, float]) -> Path:
        """Return the file of a view, existing or not. camera: as in ``usb:0``.  sheet: width and height, metres."""
        sides = "x".join(f"{1e3 * side:.6g}" for side in sheet)
        return self._root / f"{camera.replace(':', '-')}-{sides}mm.json"

    async def see(self, camera: str, sheet: tuple[float, float]) -> SeenSheet:
        """Take a photograph, with the sheet's corners as they were shown last; raises as `see_sheet`."""
        return await self._desk.do(see_sheet, camera, self.path(camera, sheet), sheet)

    async def keep(self, camera: str, sheet: tuple[float, float], seen: SeenSheet, corners: Corners) -> None:
        """Keep the corners of a sheet in a photograph; those before go into the trash. Raises as `keep_corners`."""
        path = self.path(camera, sheet)
        try:
            self._root.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"cannot make the folder {self._root}: {error.strerror}; make room for it") from error
        await self._desk.do(keep_corners, new := self._folder.incoming(), corners, sheet, seen.size)
        self._folder.keep_former(path, title=_TITLE)
        new.replace(path)

    def throw_away(self, camera: str, sheet: tuple[float, float]) -> None:
        """Move the view into the trash, after which the sheet is found by its tags."""
        self._folder.throw_away(self.path(camera, sheet), title=_TITLE)

    def take_back(self, trashed: Path) -> None:
        """Move a view back out of the trash; raises as `Folder.take_back`."""
        self._folder.take_back(trashed, self._root)
