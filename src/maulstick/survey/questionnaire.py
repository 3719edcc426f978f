"""Survey file: a folder with survey.json and its pictures, which can be copied and mailed.

Source: Spline-FRIDA, Human Evaluations: one questionnaire matches hands, the other asks for opinions on two systems.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Final, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.painting.ink_picture import ink_picture
from maulstick.painting.picture import encode_png, read_picture
from maulstick.storage.arrays import Image, kind_of
from maulstick.storage.files import atomic_write, file_to_read
from maulstick.storage.library import NAME
from maulstick.storage.records import read_record, write_record
from maulstick.storage.text import is_printable, made_printable
from maulstick.strokes.ink import KIND, read_ink

LONGEST_PX: Final = 1024
"""Longest side of a picture of a survey, pixels: two or three stand side by side on a page."""

MatchQuestion = Literal["same hand", "whose drawing"]
"""What the matching questionnaire asks."""

_RECORD = "survey.json"


def _printable(text: str) -> str:
    if not is_printable(text) or text != text.strip():
        raise ValueError("it must be plain text without line breaks, and not begin or end with a space")
    return text


_Name = Annotated[str, Field(min_length=1, max_length=60), AfterValidator(_printable)]
_Title = Annotated[str, Field(min_length=1, max_length=120), AfterValidator(_printable)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class SurveyHand(_Part):
    """A person's hand: a drawing by the person, and drawings by a machine in the person's style.

    by_hand: a picture, or ink, which is drawn as it was recorded.
    by_machine: one file per motif, with the same motifs in the same order for every hand of a survey.
    """

    name: _Name
    by_hand: Path
    by_machine: Annotated[tuple[Path, ...], Field(min_length=1, max_length=20)]


class Match(_Part):
    """Matching questionnaire: participants find out which drawings by a machine and by people belong together.

    question: ``same hand`` shows a drawing by a person, and asks which of the machine's has the same strokes; ``whose
    drawing`` shows one of the machine's, and asks which of the drawings by people is by the person whose hand it is in.
    asked: number of hands that one participant is asked about.
    """

    question: MatchQuestion = "same hand"
    hands: Annotated[tuple[SurveyHand, ...], Field(min_length=2, max_length=10)]
    asked: Annotated[int, Field(ge=1)] = 1

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if len({hand.name for hand in self.hands}) < len(self.hands):
            raise ValueError("two hands have one name; give each its own")
        if len({len(hand.by_machine) for hand in self.hands}) > 1:
            raise ValueError("every hand needs as many drawings by machine as the others, of the same motifs")
        if self.asked > len(self.hands):
            raise ValueError(f"asked is {self.asked}; it must be at most the {len(self.hands)} hands")
        return self


class Pair(_Part):
    """A picture, and one drawing of it by each of the two systems, in the order of the systems."""

    reference: Path
    looks: tuple[Path, Path]


class Opinions(_Part):
    """Questionnaire of opinions: how people compare the drawings of two systems of the same picture.

    asked: number of pairs that one participant is asked about, each with all the questions.
    """

    systems: tuple[_Name, _Name]
    pairs: Annotated[tuple[Pair, ...], Field(min_length=1, max_length=50)]
    asked: Annotated[int, Field(ge=1)] = 1

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.systems[0] == self.systems[1]:
            raise ValueError("both systems have one name; give each its own")
        if self.asked > len(self.pairs):
            raise ValueError(f"asked is {self.asked}; it must be at most the {len(self.pairs)} pairs")
        return self


class Survey(_Part):
    """Survey of one questionnaire or both. Its pictures are PNGs beside survey.json."""

    schema_version: Literal[1] = 1
    title: _Title
    match: Match | None = None
    opinions: Opinions | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.match is None and self.opinions is None:
            raise ValueError("a survey needs hands to match, or pairs for opinions")
        for picture in self.pictures():
            if not re.fullmatch(rf"{NAME}\.png", str(picture)):
                raise ValueError(f"{str(picture)!r} must be the name of a PNG beside it: of a-z, 0-9 and -, then .png")
        return self

    def pictures(self) -> Iterator[Path]:
        """Yield the file of every picture, relative to the folder."""
        for hand in self.match.hands if self.match else ():
            yield from (hand.by_hand, *hand.by_machine)
        for pair in self.opinions.pairs if self.opinions else ():
            yield from (pair.reference, *pair.looks)


def build(folder: str | Path, title: str, match: Match | None, opinions: Opinions | None) -> Survey:
    """Make a survey in a new folder, with copies of all pictures: their pixels alone, at most 1024 per side.

    Ink becomes a picture. The folder is written whole or not at all. Raises InputError where a picture cannot be read
    or the survey asks nothing, and OutputError where the folder has something in it or cannot be written.
    """
    folder = Path(folder)
    _check_new(folder)
    sources: dict[Path, Path] = {}
    try:
        survey = Survey(
            title=title, match=_with_new_names(match, sources), opinions=_with_new_pair_names(opinions, sources)
        )
    except ValidationError as error:
        raise InputError(f"this is not a survey: {validation_fault(error)}") from error
    pictures = {name: encode_png(_pixels(source)) for name, source in sources.items()}
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=".", dir=folder.parent) as temporary:
            made = Path(temporary) / folder.name
            made.mkdir()
            for name, content in pictures.items():
                atomic_write(made / name, content)
            write_record(survey, made / _RECORD)
            made.replace(folder)  # which fails where something came into it meanwhile
    except OutputError:
        raise
    except (OSError, ValueError) as error:  # the latter of letters that no name of a file has
        told = getattr(error, "strerror", None) or error
        raise OutputError(f"cannot make the folder {made_printable(str(folder))}: {told}; choose another") from error
    return survey


def read_survey(folder: str | Path) -> Survey:
    """Read the survey in a folder. Raises InputError where there is none, a picture is missing, or a file is a link."""
    folder = Path(folder)
    if folder.is_file():
        raise InputError(f"{folder} is a file; name the folder of the survey, the one with {_RECORD} in it")
    check_no_link(folder / _RECORD, "survey")
    survey = read_record(Survey, folder / _RECORD, "survey")
    for picture in survey.pictures():
        check_no_link(file_to_read(folder / picture, "picture"), "picture")
    return survey


def check_no_link(path: Path, what: str) -> None:
    """Raise InputError where a file of a survey is a link: one that came by mail could show, or change, any file."""
    if path.is_symlink():
        raise InputError(f"{path} is a link; put the {what} itself in its place")


def read_survey_to_show(folder: Path) -> Survey:
    """Read the survey in a folder. Raises InputError as `read_survey`, and where one of its pictures is damaged."""
    survey = read_survey(folder)
    for picture in survey.pictures():
        read_picture(folder / picture)
    return survey


def _check_new(folder: Path) -> None:
    try:
        taken = folder.exists() and (not folder.is_dir() or any(folder.iterdir()))
    except OSError as error:
        raise OutputError(f"cannot look into {folder}: {error.strerror}; choose another folder") from error
    if taken:
        raise OutputError(f"{folder} is already there; choose a new folder for the survey")


def _pixels(source: Path) -> Image:
    if source.is_file() and kind_of(source) == KIND:
        return ink_picture(read_ink(source), LONGEST_PX)
    return read_picture(source, LONGEST_PX)


def _with_new_names(match: Match | None, sources: dict[Path, Path]) -> Match | None:
    """Return the questionnaire with new, plain file names; put their sources into `sources`."""
    if match is None:
        return None
    hands = []
    for number, hand in enumerate(match.hands, start=1):
        by_hand = Path(f"hand-{number}.png")
        by_machine = {Path(f"hand-{number}-machine-{row}.png"): path for row, path in enumerate(hand.by_machine, 1)}
        sources |= {by_hand: hand.by_hand} | by_machine
        hands.append(SurveyHand(name=hand.name, by_hand=by_hand, by_machine=tuple(by_machine)))
    return match.model_copy(update={"hands": tuple(hands)})


def _with_new_pair_names(opinions: Opinions | None, sources: dict[Path, Path]) -> Opinions | None:
    """Return the questionnaire with new, plain file names; put their sources into `sources`."""
    if opinions is None:
        return None
    pairs = []
    for number, pair in enumerate(opinions.pairs, start=1):
        reference, *looks = (Path(f"pair-{number}{which}.png") for which in ("", "-look-1", "-look-2"))
        sources |= dict(zip((reference, *looks), (pair.reference, *pair.looks), strict=True))
        pairs.append(Pair(reference=reference, looks=(looks[0], looks[1])))
    return Opinions(systems=opinions.systems, pairs=tuple(pairs), asked=opinions.asked)
