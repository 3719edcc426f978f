"""The studio's folder: what was drawn, pictures, plans, surveys, and what was thrown away."""

import os
import re
import secrets
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import final

from maulstick.errors import InputError, OutputError
from maulstick.storage.files import atomic_write, held
from maulstick.storage.library import NAME

_LONGEST, _ROOM = 40, 32  # letters of a name; and of one that a number may follow

KINDS = ("hands", "pictures", "plans", "surveys")

_INCOMING = ".incoming-"


@final
@dataclass(frozen=True)
class Folder:
    """The paths in it; everything has a name, which is never a path. root: absolute."""

    root: Path

    @classmethod
    @contextmanager
    def opened(cls, root: Path) -> Iterator["Folder"]:
        """The folder, made where it was not, for one studio at a time.

        Raises InputError where another studio has it, OutputError where nothing can be written there.
        """
        folder = cls(root.absolute())
        taken = f"another studio works in {root}; use that one, or name another folder"
        with held(folder.root / ".studio.lock", taken, f"cannot work in {root}", "name another folder"):
            try:
                for kind in (*KINDS, "trash"):
                    (folder.root / kind).mkdir(exist_ok=True)
                folder._clear_incoming()
            except OSError as error:
                raise OutputError(f"cannot work in {root}: {error.strerror}; name another folder") from error
            yield folder

    def of(self, kind: str, name: str) -> Path:
        """Where something of a kind ("plans") and that name is, or would be. Raises InputError for what is no name."""
        if kind not in KINDS or not re.fullmatch(NAME, name):
            raise InputError(f"{name!r} is no name; use up to 40 of a-z, 0-9 and -, beginning with a letter or a digit")
        return self.root / kind / name

    def names(self, kind: str) -> list[str]:
        """What there is of a kind, oldest first."""
        found: dict[str, int] = {}
        for path in (self.root / kind).iterdir():
            if re.fullmatch(NAME, path.name):
                with suppress(FileNotFoundError):  # it went meanwhile
                    found[path.name] = path.lstat().st_mtime_ns
        return sorted(found, key=found.__getitem__)

    def free_name(self, kind: str, wish: str) -> str:
        """A name like the wish that nothing of the kind has yet, "My cat.JPG" as my-cat or my-cat-2."""
        plain = plain_name(wish)[:_ROOM].strip("-") or kind[:-1]
        taken, number, name = set(self.names(kind)), 1, plain
        while name in taken:
            number += 1
            name = f"{plain}-{number}"
        return name

    def incoming(self) -> Path:
        """A new place for what comes from outside, until it is known what it is."""
        return self.root / f"{_INCOMING}{secrets.token_hex(8)}"

    def keep_former(self, *paths: Path) -> Path:
        """Copy those files that there are into the trash, as others are about to take their places.

        Returns where the copies are, together; where there were no files, nothing is there. Raises OutputError where
        one cannot be copied.
        """
        grave = self._grave()
        try:
            grave.mkdir()
            for path in paths:
                if path.is_file():
                    atomic_write(grave / path.name, path.read_bytes())
            if not any(grave.iterdir()):
                grave.rmdir()
        except OSError as error:
            shutil.rmtree(grave, ignore_errors=True)
            what = ", ".join(path.name for path in paths)
            raise OutputError(f"cannot copy {what} into the trash: {error.strerror or error}") from error
        return grave

    def throw_away(self, *paths: Path) -> Path:
        """Move files or folders into the trash; where they are then, together.

        Raises OutputError, and leaves all of them where they are, where one cannot be moved.
        """
        grave = self._grave()
        grave.mkdir()
        _move({path: grave / path.name for path in paths})
        return grave

    def take_back(self, grave: Path, where: Path) -> list[Path]:
        """Move what was thrown away to the folder `where` again; its places there.

        Raises OutputError where its place is taken, InputError where it is there already.
        """
        if not grave.is_dir():
            raise InputError("it was taken out of the trash already; look where it was before")
        places = {path: where / path.name for path in grave.iterdir()}
        for place in places.values():
            if os.path.lexists(place):
                raise OutputError(f"there is a {place.name} again meanwhile; rename that one first")
        _move(places)
        grave.rmdir()
        return list(places.values())

    def _grave(self) -> Path:
        return self.root / "trash" / f"{time.time_ns()}-{secrets.token_hex(4)}"

    def _clear_incoming(self) -> None:
        for path in self.root.glob(f"{_INCOMING}*"):
            path.unlink(missing_ok=True)


def plain_name(wish: str) -> str:
    """The wish, which may be a file's name, as a name can be; empty where nothing of it can."""
    return re.sub(r"[^a-z0-9]+", "-", Path(wish).stem.lower()).strip("-")[:_LONGEST].strip("-")


def _move(places: dict[Path, Path]) -> None:
    """Move all of them, or none."""
    moved: dict[Path, Path] = {}
    try:
        for path, place in places.items():
            shutil.move(path, place)  # the styles may be on another disk
            moved[path] = place
    except OSError as error:
        for before, now in moved.items():
            shutil.move(now, before)
        raise OutputError(f"cannot move {path.name}: {error.strerror or error}; it stays where it is") from error
