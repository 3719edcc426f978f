"""Cards of the styles: names, paths and descriptions, which are read without loading a style."""

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
"""Version of the format of cards that is written, and the only one that is read."""

FEWEST = 5
"""Least number of strokes that a style can be learned from."""

LARGEST = 256 * 2**20
"""Most bytes of a style's arrays."""

BUILT_IN = Path(__file__).with_name("built_in")
"""Folder of the styles that come with Maulstick."""

_FREE = "free"  # a style without a file: `maulstick.style.free`
STYLES = Library("style", "styles", BUILT_IN, taken=_FREE)
"""Library of the styles that come with Maulstick and of the user's own."""

_StyleName = Annotated[str, Field(pattern=f"^{NAME}$")]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ExemplarSettings(_Model):
    """Settings of an `Exemplar` (`maulstick.style.exemplar`)."""

    kind: Literal["exemplar"] = "exemplar"
    freedom: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]


class TrajVAESettings(_Model):
    """Settings of a `TrajVAE` (`maulstick.style.trajvae`): none, since its arrays hold everything."""

    kind: Literal["trajvae"] = "trajvae"


class StyleCard(_Model):
    """Contents of the JSON beside a style's arrays.

    source: what the style was learned from, for people.  strokes: number of strokes.  sha256: of the file of arrays.
    formerly: earlier names, the latest last; None where there are none.
    title: what a person calls it, in any script; None where that is its name.
    """

    version: Literal[1] = VERSION
    name: _StyleName
    source: Name
    strokes: Annotated[int, Field(ge=FEWEST)]
    settings: Annotated[ExemplarSettings | TrajVAESettings, Field(discriminator="kind")]
    sha256: str
    formerly: tuple[_StyleName, ...] | None = None
    title: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names that paintings may know it by, the latest last; its files have another where somebody renamed them."""
        return (*(self.formerly or ()), self.name)


def read_card(path: Path) -> StyleCard:
    """Return the card in a style's JSON. Raises InputError where it is not one."""
    return read_record(StyleCard, path, "style")


def style_path(name: str) -> Path:
    """Return the path of a style's JSON from the style's name, an earlier name of it, that in its card, or that path.

    Raises InputError where there is no such style.
    """
    paths = STYLES.paths()
    if name in paths:
        return paths[name]
    if Path(name).suffix == ".json":
        return file_to_read(name, "style")
    for path in paths.values():
        if name in _other_names(path):
            return path
    raise InputError.of_choice("style", name, [*paths, _FREE, "FILE.json"])


def rename_style(name: str, new: str) -> Path:
    """Give a style of the user's own another name, and return the path of its JSON.

    Its hash stays the same, and `style_path` still finds it by the old name, which paintings may contain.
    Raises InputError where the style is not the user's own or the name is not allowed, and OutputError where the name
    is in use or nothing can be written; the style then keeps its old name.
    """
    old = _own_path(name)
    path = STYLES.own() / f"{STYLES.check_name(new)}.json"
    with STYLES.writing_into(path.parent):
        if new in STYLES.paths() or os.path.lexists(path):
            raise OutputError(f"there is a style {new} already; choose another name")
        card = read_card(old)
        former = tuple(each for each in dict.fromkeys((*card.names, name)) if each != new)
        atomic_write(path.with_suffix(".safetensors"), read_whole(old.with_suffix(".safetensors"), "style", LARGEST))
        write_record(card.model_copy(update={"name": new, "formerly": former}), path)
        old.unlink()
        old.with_suffix(".safetensors").unlink()
    return path


def title_style(name: str, title: str) -> None:
    """Give a style of the user's own another title.

    Raises InputError where the style is not the user's own, OutputError where it cannot be written.
    """
    path = _own_path(name)
    with STYLES.writing_into(path.parent):
        write_record(read_card(path).model_copy(update={"title": title}), path)


def _own_path(name: str) -> Path:
    path = STYLES.paths().get(name)
    if path is None or STYLES.is_built_in(path):
        raise InputError(f"there is no style of your own called {name!r}; those that come with Maulstick keep theirs")
    return path


def _other_names(path: Path) -> tuple[str, ...]:
    """Return the names that paintings may know a style by, other than that of its file."""
    try:
        return read_card(path).names
    except InputError:  # reported when that style itself is loaded
        return ()
