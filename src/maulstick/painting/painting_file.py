"""Files of paintings: painting.json, one stroke per line."""

import json
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.painting.painting import SCHEMA_VERSION, Painting
from maulstick.storage.files import atomic_write, file_to_read

_PICTURES = (b"\xff\xd8\xff", b"\x89PNG", b"GIF8", b"RIFF", b"BM", b"II*\0", b"MM\0*")  # beginnings of their files
_LARGEST_FILE = 256 * 2**20  # bytes: some 250,000 strokes


def write_painting(painting: Painting, path: str | Path) -> None:
    """Write `painting` as JSON with one entry per line (so one stroke per line), the same bytes for the same painting.

    Raises OutputError where that fails; what was at `path` is then still there.
    """
    left_out = {"strokes"} if painting.literal else {"strokes", "literal"}
    fields = _said(painting.model_dump(mode="json", exclude=left_out))
    fields["sheet"] = _said(fields["sheet"])
    fields["paints"] = [_said(entry) for entry in fields["paints"]]
    fields["strokes"] = [stroke.model_dump(mode="json", exclude_defaults=True) for stroke in painting.strokes]
    body = ",\n".join(f"  {json.dumps(name)}: {_one_entry_per_line(value)}" for name, value in fields.items())
    atomic_write(path, f"{{\n{body}\n}}\n".encode())


def read_painting(path: str | Path) -> Painting:
    """Return the painting in the file at `path`.

    Raises InputError, naming the file and the field, where there is none or it is not a painting of this schema.
    """
    path = file_to_read(path, "painting")
    if path.stat().st_size > _LARGEST_FILE:
        raise InputError(f"{path} is larger than {_LARGEST_FILE >> 20} MiB; no painting is; name a painting.json")
    try:
        content = path.read_bytes()
        painting = Painting.model_validate_json(content, strict=True)
    except ValidationError as error:
        if content.startswith(_PICTURES):
            raise InputError(f"{path} is a picture; plan it first, with maulstick plan {path}") from error
        if path.suffix.lower() in (".svg", ".svgz"):
            raise InputError(f"{path} is an SVG, and a painting is needed; name the painting.json of a plan") from error
        raise InputError(f"{path} is not a painting: {painting_fault(error)}") from error
    except OSError as error:
        raise InputError(f"cannot read the painting {path}: {error.strerror}") from error
    if "schema_version" not in painting.model_fields_set:
        raise InputError(f"{path} is not a painting: schema_version: it is missing; write {SCHEMA_VERSION}")
    return painting


def _said(fields: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if value is not None}


def _one_entry_per_line(value: Any) -> str:
    if isinstance(value, dict):
        lines = [f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in value.items()]
    elif isinstance(value, list):
        lines = [json.dumps(entry) for entry in value]
    else:
        return json.dumps(value)
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{opening}\n    " + ",\n    ".join(lines) + f"\n  {closing}" if lines else opening + closing


def painting_fault(error: ValidationError) -> str:
    """Return what is wrong with a painting, of an error that making one raised."""
    for fault in error.errors(include_url=False):
        if fault["loc"] == ("schema_version",) and isinstance(came := fault["input"], int):
            remedy = "update Maulstick" if came > SCHEMA_VERSION else "write the painting again"
            return f"schema_version: it is {came}, and this Maulstick reads versions 1 to {SCHEMA_VERSION}; {remedy}"
    return validation_fault(error)
