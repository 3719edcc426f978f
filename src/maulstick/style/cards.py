"""What is known of the styles without loading any: their names, where they are, and the card of each."""

import os
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from maulstick.errors import InputError, OutputError
from maulstick.painting.brush import Name
from maulstick.storage.files import atomic_write, file_to_read, read_whole
from maulstick.storage.library import NAME, Library
from maulstick.storage.records import read_record, write_record

VERSION: Final = 1
FEWEST = 5
"""Strokes that a style can be learned from."""

LARGEST = 256 * 2**20
"""Bytes of a style's arrays."""

BUILT_IN = Path(__file__).with_name("built_in")
_FREE = "free"
STYLES = Library("style", "styles", BUILT_IN, taken=_FREE)

_StyleName = Annotated[str, Field(pattern=f"^{NAME}$")]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ExemplarSettings(_Model):
    """See `maulstick.style.exemplar.Exemplar`."""

    kind: Literal["exemplar"] = "exemplar"
    freedom: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


class TrajVAESettings(_Model):
    """All that a `maulstick.style.trajvae.TrajVAE` is lies in its arrays."""

    kind: Literal["trajvae"] = "trajvae"


class StyleCard(_Model):
    """What the JSON beside a style's arrays says.

    source: what the style was learned from, for people.  strokes: how many of them.  sha256: of the file of arrays.
    formerly: the names that it had before, the last one last; None where it always had this one.
    """

    version: Literal[1] = VERSION
    name: _StyleName
    source: Name
    strokes: Annotated[int, Field(ge=FEWEST)]
    settings: Annotated[ExemplarSettings | TrajVAESettings, Field(discriminator="kind")]
    sha256: str
    formerly: tuple[_StyleName, ...] | None = None


def read_card(path: Path) -> StyleCard:
    """What a style's JSON says. Raises InputError where it is not one."""
    return read_record(StyleCard, path, "style")


def style_path(name: str) -> Path:
    """The JSON of the style with this name, or at this path; also by a name that it had before.

    Raises InputError where there is no such style.
    """
    paths = STYLES.paths()
    if name in paths:
        return paths[name]
    if Path(name).suffix == ".json":
        return file_to_read(name, "style")
    for path in paths.values():
        if name in _former_names(path):
            return path
    raise InputError.of_choice("style", name, [*paths, _FREE, "FILE.json"])


def rename_style(name: str, new: str) -> Path:
    """Give the user's own style another name; the path of its JSON.

    Its hash stays, since that is of its strokes and not of its name, and `style_path` still finds it by the old one,
    for plans that ask for it. Raises InputError where it is none of the user's own or the name cannot be one, and
    OutputError where the name is in use or nothing can be written; the style is then still there under its own.
    """
    old = STYLES.paths().get(name)
    if old is None or STYLES.is_built_in(old):
        raise InputError(f"there is no style of your own called {name!r}; those that come with Maulstick keep theirs")
    path = STYLES.own() / f"{STYLES.check_name(new)}.json"
    if new in STYLES.paths() or os.path.lexists(path):
        raise OutputError(f"there is a style {new} already; choose another name")
    card = read_card(old)
    former = tuple(each for each in (*(card.formerly or ()), name) if each != new)
    atomic_write(path.with_suffix(".safetensors"), read_whole(old.with_suffix(".safetensors"), "style", LARGEST))
    write_record(card.model_copy(update={"name": new, "formerly": former}), path)
    old.unlink()
    old.with_suffix(".safetensors").unlink()
    return path


def _former_names(path: Path) -> tuple[str, ...]:
    try:
        return read_card(path).formerly or ()
    except InputError:  # whoever wants that style itself is told
        return ()
