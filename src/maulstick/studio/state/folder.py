"""Folder of a studio: drawn hands, pictures, plans, drawings, surveys, and the trash."""

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
from maulstick.storage.records import write_record
from maulstick.studio.state.thrown import RECORD, STYLES_FOLDER, TrashRecord
from maulstick.studio.state.titles import free_among, numbered, title_of, title_of_file, titles_of

KINDS = ("hands", "pictures", "plans", "drawings", "surveys")
"""Kinds of things in the folder, each in a folder of its own."""

PAINTED = ("plans", "drawings")
"""Kinds that a machine paints, which have no name in common."""

_INCOMING = ".incoming-"  # prefix of uploaded files until they are checked


@final
@dataclass(frozen=True)
class Folder:
    """Paths in the folder; everything in it has a name, which is never a path. root: absolute."""

    root: Path

    @classmethod
    @contextmanager
    def opened(cls, root: Path) -> Iterator["Folder"]:
        """Open the folder for one studio at a time; make it where there is none, for nobody else to read.

        Raises InputError where another studio uses it, OutputError where it cannot be written.
        """
        folder = cls(root.absolute())
        _make_private(root)
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
        """Path of the thing of a kind ("plans") and a name, existing or not. Raises InputError for an invalid name."""
        if kind not in KINDS or not re.fullmatch(NAME, name):
            raise InputError(f"{name!r} is no name; use up to 40 of a-z, 0-9 and -, beginning with a letter or a digit")
        return self.root / kind / name

    def painting(self, name: str) -> Path:
        """Path of the SVG of a drawing, or else of the painting.json of a plan, which may not exist; raises as `of`."""
        drawing = self.of("drawings", name) / "drawing.svg"
        return drawing if drawing.is_file() else self.of("plans", name) / "painting.json"

    def names(self, *kinds: str) -> list[str]:
        """Return the names of all things of these kinds, oldest first."""
        return [path.name for path in self._things(*kinds)]

    def titles(self, *kinds: str) -> dict[str, str]:
        """Return the titles of all things of these kinds by name, oldest first; equal ones with the name beside."""
        return titles_of(self._things(*kinds))

    def title(self, kind: str, name: str) -> str:
        """Return the title of a thing, with its name beside it where another has that title."""
        return self.titles(*_sharing(kind)).get(name, name)

    def title_for(self, kind: str, wanted: str) -> str:
        """Return the wanted title, or else the kind's word, with a number where something of the kind has it."""
        return numbered(wanted or kind[:-1], map(title_of, self._things(*_sharing(kind))))

    def title_for_file(self, kind: str, file: str) -> str:
        """Return a title for what came in a file of that name, as `title_for`."""
        return self.title_for(kind, title_of_file(file))

    def free_name(self, kind: str, title: str, but: str = "") -> str:
        """Return a name like the title that nothing of the kind has yet: for "My cät", my-cat or my-cat-2.

        Plans and drawings have no name in common.  but: name that counts as free.
        """
        return free_among(set(self.names(*_sharing(kind))) - {but}, title, kind[:-1])

    def is_free(self, kind: str, name: str) -> bool:
        """Whether nothing has that name which something of the kind could have."""
        return not any(os.path.lexists(self.root / each / name) for each in _sharing(kind))

    def incoming(self) -> Path:
        """New path for an uploaded file, until its content is checked."""
        return self.root / f"{_INCOMING}{secrets.token_hex(8)}"

    def keep_former(self, *paths: Path, title: str = "") -> Path:
        """Copy those of the files that exist into the trash, before others replace them; title as in `throw_away`.

        Returns the folder of the copies, which does not exist where there were no files. Raises OutputError where a
        file cannot be copied.
        """
        trashed = self._new_trash_folder()
        try:
            trashed.mkdir()
            for path in paths:
                if path.is_file():
                    atomic_write(trashed / path.name, path.read_bytes())
            if any(trashed.iterdir()):
                self._record(trashed, paths[0], title)
            else:
                trashed.rmdir()
        except OSError as error:
            shutil.rmtree(trashed, ignore_errors=True)
            what = ", ".join(path.name for path in paths)
            raise OutputError(f"cannot copy {what} into the trash: {error.strerror or error}") from error
        return trashed

    def throw_away(self, *paths: Path, title: str = "") -> Path:
        """Move files or folders of one thing into the trash; return the folder there that holds them.

        title: of the thing, where its folder does not say it.
        Raises OutputError, and leaves all of them where they are, where one cannot be moved.
        """
        trashed = self._new_trash_folder()
        trashed.mkdir()
        self._record(trashed, paths[0], title)
        _move({path: trashed / path.name for path in paths})
        return trashed

    def take_back(self, trashed: Path, where: Path, name: str = "") -> list[Path]:
        """Move what was thrown away back into the folder `where`; return the new paths.

        name: another than it had, which is free.
        Raises OutputError where a path is taken, InputError where it was taken back already.
        """
        if not trashed.is_dir():
            raise InputError("it was taken out of the trash already; look where it was before")
        there = [path for path in trashed.iterdir() if path.name != RECORD]
        places = {path: where / (f"{name}{path.suffix}" if name else path.name) for path in there}
        for place in places.values():
            if any(os.path.lexists(where.with_name(kind) / place.name) for kind in _sharing(where.name)):
                raise OutputError(f"another one has the name {place.name} by now; put it back from the Trash page")
        _move(places)
        (trashed / RECORD).unlink(missing_ok=True)
        trashed.rmdir()
        return list(places.values())

    def _new_trash_folder(self) -> Path:
        return self.root / "trash" / f"{time.time_ns()}-{secrets.token_hex(4)}"

    def _things(self, *kinds: str) -> list[Path]:
        found: dict[Path, int] = {}
        for path in (path for kind in kinds for path in (self.root / kind).iterdir()):
            if re.fullmatch(NAME, path.name):
                with suppress(FileNotFoundError):  # it was removed meanwhile
                    found[path] = path.lstat().st_mtime_ns
        return sorted(found, key=found.__getitem__)

    def _record(self, trashed: Path, path: Path, title: str) -> None:
        """Write down in the trash what was at a path."""
        where = path.parent.relative_to(self.root).as_posix() if path.is_relative_to(self.root) else STYLES_FOLDER
        write_record(TrashRecord(where=where, title=title or title_of(path)), trashed / RECORD)

    def _clear_incoming(self) -> None:
        for path in self.root.glob(f"{_INCOMING}*"):
            path.unlink(missing_ok=True)


def _make_private(root: Path) -> None:
    try:
        root.mkdir(mode=0o700, parents=True)
    except FileExistsError:  # its owner has chosen who reads it
        if not root.is_dir():
            raise OutputError(f"cannot work in {root}: it is a file, and a folder is needed; name one") from None
    except OSError as error:
        raise OutputError(f"cannot work in {root}: {error.strerror}; name another folder") from error


def _sharing(kind: str) -> tuple[str, ...]:
    """Return the kinds that share their names with one."""
    return PAINTED if kind in PAINTED else (kind,)


def _move(places: dict[Path, Path]) -> None:
    """Move all paths, or none."""
    moved: dict[Path, Path] = {}
    try:
        for path, place in places.items():
            shutil.move(path, place)  # the styles may be on another disk
            moved[path] = place
    except OSError as error:
        for before, now in moved.items():
            shutil.move(now, before)
        raise OutputError(f"cannot move {path.name}: {error.strerror or error}; it stays where it is") from error
