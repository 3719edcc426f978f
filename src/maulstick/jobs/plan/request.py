"""Request of a plan, as it is kept with the plan in the making."""

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, Self

from pydantic import ConfigDict, JsonValue, TypeAdapter, ValidationError

from maulstick.errors import InputError, option, validation_fault
from maulstick.jobs.plan.options import FILES, MOST_SEED, PlanOptions
from maulstick.kinds import check_whole
from maulstick.painting.video import Video
from maulstick.robot.journal import latest_journal
from maulstick.storage.files import file_sum

MOST_TRIES: Final = 64
"""Largest number of tries: each takes as long as a plan, and on the command line a process of its own."""

MOST_WORKERS: Final = 32
"""Largest number of workers: what all of them keep to go on from must fit into one file."""


@dataclass(frozen=True)
class PlanRequest:
    """A picture, or None where there is only a text, and options; files as absolute paths.

    tries: plans from so many seeds, of which the best is kept.  video: the format to record the planning in, if any.
    workers: processes that plan windows of a large canvas at the same time; None for one per core,
    at most `MOST_WORKERS`.
    sums: SHA-256 of each file, and of the brush and the style, by name.

    Raises InputError for a value that is out of its range, and for a video of several tries.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    picture: Path | None
    options: PlanOptions = field(default_factory=PlanOptions)
    tries: int = 1
    video: str | None = None
    workers: int | None = None
    sums: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.picture is not None:
            object.__setattr__(self, "picture", self.picture.absolute())
        check_whole("tries", self.tries, 1, MOST_TRIES)
        if self.options.seed + self.tries - 1 > MOST_SEED:
            raise InputError.of_range(option("seed"), self.options.seed, f"from 0 to {MOST_SEED + 1 - self.tries}")
        if self.workers is not None:
            check_whole("workers", self.workers, 1, MOST_WORKERS)
        if self.video is not None:
            Video(self.video)
            if self.tries > 1:
                raise InputError(
                    f"{option('video')} records one plan, and {option('tries')} makes several; leave one of them out"
                )

    def with_sums(self, more: dict[str, str], sum_file: Callable[[Path], str] = file_sum) -> "PlanRequest":
        """Return the same with the sums of its files, and `more` sums by name."""
        return replace(self, sums={**{str(path): sum_file(path) for path in self.files}, **more})

    def as_json(self) -> dict[str, JsonValue]:
        """Return the request as JSON, for a file."""
        plain: dict[str, JsonValue] = TypeAdapter(PlanRequest).dump_python(self, mode="json")
        return plain

    @property
    def provenance_options(self) -> dict[str, JsonValue]:
        """Options for a painting's provenance: files by their names alone, and the number of paints that were mixed."""
        named = {
            name: Path(value.name) if isinstance(value, Path) else value
            for name, value in asdict(self.options).items()
            if name != "weights"
        }
        plain: dict[str, JsonValue] = TypeAdapter(dict[str, Any]).dump_python(named, mode="json")
        return {**plain, "paints": self.options.mixed_paints, "tries": self.tries}

    @classmethod
    def from_json(cls, plain: dict[str, JsonValue], source: Path) -> Self:
        """Return the request read from the file `source`. Raises InputError, naming it, for one of another version."""
        try:
            return TypeAdapter(cls).validate_python(plain)
        except ValidationError as error:
            fault = validation_fault(error)
            raise InputError(f"{source} is of another version of Maulstick: {fault}; plan anew") from error

    def changed_in(self, sums: Mapping[str, str]) -> str | None:
        """Return the name of the first file, the brush or the style whose sum is another now, or None."""
        return next((name for name in {**sums, **self.sums} if sums.get(name) != self.sums.get(name)), None)

    def check_unchanged(self, sums: Mapping[str, str]) -> None:
        """Raise InputError where a file, the brush or the style is no longer what it was when planning began."""
        if (name := self.changed_in(sums)) is not None:
            raise InputError(
                f"{name} has changed since planning began; put it back, or plan anew with {option('overwrite')}"
            )

    @property
    def files(self) -> list[Path]:
        """Files that it names: the picture, and those of the options; and the journal of what is on a photograph."""
        files = (self.picture, *(getattr(self.options, name) for name in FILES), self._journal)
        return [file for file in files if file is not None]

    @property
    def _journal(self) -> Path | None:
        if self.options.again is None or self.options.background is None:
            return None
        return latest_journal(self.options.again)


def demo_picture() -> Path:
    """Return the path of the demo portrait, which is part of scikit-image: Eileen Collins, by NASA."""
    return Path(str(files("skimage.data").joinpath("astronaut.png")))


def state_file(out: Path, seed: int) -> Path:
    """Return the path of the file that keeps the plan from this seed while it is made."""
    return out / f"plan-{seed}.npz"


def state_files(out: Path) -> list[Path]:
    """Return the files of all plans in the making in the folder `out`."""
    return sorted(file for file in out.glob("plan-*.npz") if file.stem.removeprefix("plan-").isdigit())


def sum_of(plain: Any) -> str:
    """Return the SHA-256 of a value as JSON."""
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()
