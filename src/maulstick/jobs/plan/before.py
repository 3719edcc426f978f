"""What a painting was planned with, its options and its picture, for planning it again."""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from maulstick.errors import InputError, option, validation_fault
from maulstick.jobs.plan.options import FILES, PlanOptions
from maulstick.jobs.plan.request import demo_picture
from maulstick.painting.painting import Painting
from maulstick.storage.files import file_sum

_SETTLED = ("paper", "paints", "paints_from", "pin", "ink", "pressure")  # options that a painting has settled
_NOT_KEPT = ("background", "paints_from", "again")  # those whose file is no longer needed


def planned_before(painting: Painting, given: Mapping[str, Any]) -> PlanOptions:
    """Return the options that a painting was planned with, but for those given.

    Raises InputError as `kept_options`, and for other options that this Maulstick cannot read.
    """
    kept = kept_options(painting, given)
    weights = {"weights": kept.pop("weights")} if "weights" in kept else {}  # of a text or a look, which may be given
    try:
        options = TypeAdapter(PlanOptions).validate_python(kept)
    except ValidationError as error:
        raise InputError(f"it was planned with options of another kind: {validation_fault(error)}") from error
    return replace(options, **{**weights, **given})


def kept_options(painting: Painting, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options that a painting was planned with, by name and as its file has them, without those given.

    Raises InputError for a file that must be named once more, as a painting keeps no paths, and for what a painting has
    settled.
    """
    for name in sorted(set(_SETTLED) & set(given)):
        raise InputError(
            f"{option('again')} keeps the sheet, the paints and the pressure of the painting; leave out {option(name)}"
        )
    known = {field.name for field in fields(PlanOptions)} - {*_NOT_KEPT, "paints"}  # none is mixed
    kept = {name: value for name, value in painting.provenance.options.items() if name in known}
    kept["seed"] = painting.provenance.seed
    if given.get("background") is not None:
        sides = (f"{1e3 * side:.6g}" for side in (painting.sheet.width, painting.sheet.height))
        kept |= {"size": "x".join(sides) + "mm", "paper": PlanOptions.paper}
    kept = {name: value for name, value in kept.items() if name not in given}
    for name in FILES:  # of which a painting knows no more than the name
        if kept.get(name) is not None:
            raise InputError(f"it was planned with the file {kept[name]}; name that once more, with {option(name)}")
    return kept


def notes_on_files(painting: Painting, options: PlanOptions) -> list[str]:
    """Return sentences for people on files that a painting was planned with, and that options for it leave out."""
    were = {name: painting.provenance.options.get(name) for name in FILES if name not in _NOT_KEPT}
    return [
        f"it was planned with the file {file}, and these options leave that out; name it with {name} to keep it"
        for name, file in were.items()
        if file is not None and getattr(options, name) is None
    ]


def picture_near(painting: Painting, file: Path) -> Path | None:
    """Return the picture of a painting: of this folder, that of the painting's `file`, or the one above.

    None where it was planned from a text alone. Raises InputError where it is in none of them.
    """
    name, sha256 = painting.provenance.image, painting.provenance.image_sha256
    if name is None or sha256 is None:
        return None
    places = [folder / name for folder in (Path(), file.parent, file.parent.parent)]
    for path in [*places, demo_picture()]:
        if path.is_file() and file_sum(path) == sha256:
            return path
    raise InputError(f"there is no {name}, from which it was planned, here or beside {file}; name it, too")
