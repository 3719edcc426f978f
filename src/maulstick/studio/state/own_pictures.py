"""Copies of pictures that plans keep of their own once those are thrown away: others may come to have their names."""

import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from maulstick.jobs.plan.request import PlanRequest
from maulstick.storage.files import atomic_write
from maulstick.storage.folders import MAKE_ROOM, as_output_error
from maulstick.studio.state.carrying import REQUEST, read_request


def keep_own(folder: Path, request: PlanRequest, picture: Path) -> None:
    """Keep a picture in a plan's folder where its request names it, unless it did so before.

    Raises OutputError where there is no room for it.
    """
    own = _own(folder, picture)
    if picture not in request.files or own.exists() or not picture.is_file():
        return
    with as_output_error(folder, MAKE_ROOM):
        own.parent.mkdir(parents=True, exist_ok=True)
        with suppress(OSError):  # a disk that has no links
            os.link(picture, own)
            return
        atomic_write(own, picture.read_bytes())


def keep_own_in_trash(root: Path, picture: Path) -> None:
    """Keep a picture with the plans in the trash of the studio's folder `root` that name it; raises as `keep_own`."""
    for file in root.glob(f"trash/*/*/{REQUEST}"):
        try:
            request = read_request(file, root)
        except (OSError, ValueError):  # one that cannot be read could not go on either
            continue
        keep_own(file.parent, request, picture)


def with_own(request: PlanRequest, folder: Path) -> PlanRequest:
    """Return a plan's request, with its own copies in place of pictures that were thrown away."""

    def kept(picture: Path | None) -> Path | None:
        return picture if picture is None or not (own := _own(folder, picture)).is_file() else own

    options = request.options
    options = replace(options, look=kept(options.look), background=kept(options.background))
    return replace(request, picture=kept(request.picture), options=options)


def _own(folder: Path, picture: Path) -> Path:
    return folder / "own" / picture.parent.name / picture.name
