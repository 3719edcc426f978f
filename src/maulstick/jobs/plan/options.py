"""All that was asked of ``maulstick plan``, as it is written beside a plan in the making."""

import hashlib
import json
from dataclasses import field
from pathlib import Path
from typing import Any, Self

from pydantic import ConfigDict, JsonValue, TypeAdapter, ValidationError
from pydantic.dataclasses import dataclass

from maulstick.errors import InputError, validation_fault
from maulstick.storage.files import file_sum


@dataclass(frozen=True, config=ConfigDict(extra="forbid"))
class PlanRequest:
    """The words of the command line, checked as far as they can be by themselves; files as absolute paths."""

    photo: Path | None
    text: str | None
    look: Path | None
    weights: dict[str, float]
    clip: str | None
    clip_weights: Path | None
    clip_layers: tuple[int, ...] | None
    size: str
    paper: str
    canvas: Path | None
    fit: str
    strokes: int
    exact: bool
    paints: int | None
    ink: str | None
    paints_from: Path | None
    brush: str
    pressure: float | None
    style: str
    steps: int
    ask_every: int
    px: int | None
    seed: int
    tries: int
    video: str | None
    sums: dict[str, str] = field(default_factory=dict)

    @property
    def names_clip(self) -> bool:
        """Whether networks are asked to be CLIP, by any of its words."""
        return any(word is not None for word in (self.clip, self.clip_weights, self.clip_layers))

    def with_sums(self, more: dict[str, str]) -> "PlanRequest":
        """The same, knowing what is in its files, and `more` by which anything else is known."""
        return PlanRequest(**{**vars(self), "sums": {**{str(path): file_sum(path) for path in self._files()}, **more}})

    def as_json(self) -> dict[str, JsonValue]:
        """For a file."""
        plain: dict[str, JsonValue] = TypeAdapter(PlanRequest).dump_python(self, mode="json")
        return plain

    @classmethod
    def from_json(cls, plain: dict[str, JsonValue], source: Path) -> Self:
        """Out of a file. Raises InputError, naming it, where it is none of this version's."""
        try:
            return TypeAdapter(cls).validate_python(plain)
        except ValidationError as error:
            fault = validation_fault(error)
            raise InputError(f"{source} is of another version of Maulstick: {fault}; plan anew") from error

    def check_unchanged(self, sums: dict[str, str]) -> None:
        """Raise InputError where a file, the brush or the style is no longer what it was when planning began."""
        for name, was in self.sums.items():
            if sums.get(name) != was:
                raise InputError(f"{name} has changed since planning began; put it back, or plan anew with --overwrite")

    def _files(self) -> list[Path]:
        files = (self.photo, self.look, self.canvas, self.paints_from, self.clip_weights)
        return [file for file in files if file is not None]


def state_file(out: Path, seed: int) -> Path:
    """Where the plan from this seed is kept while it is made."""
    return out / f"plan-{seed}.npz"


def state_files(out: Path) -> list[Path]:
    """All plans in the making in the folder `out`."""
    return sorted(file for file in out.glob("plan-*.npz") if file.stem.removeprefix("plan-").isdigit())


def sum_of(plain: Any) -> str:
    """SHA-256 of something as JSON."""
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()
