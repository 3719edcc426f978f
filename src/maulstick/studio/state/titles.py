"""Titles that people give things: in any script, in a record beside their files, whose folder has a plain name."""

import os
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict

from maulstick.errors import InputError
from maulstick.storage.records import read_record, write_record
from maulstick.storage.text import JOINERS

MOST_LETTERS = 80
"""Most letters of a title."""

MOST_OF_A_NOTE = 300
"""Most letters of a note."""

_RECORD = "title.json"  # in the folder of a thing
_LONGEST_NAME, _ROOM = 40, 32  # letters of a name, and of a name before a number is added
_LONGEST_FILE = 200  # bytes of a title in a file's name, which systems limit to 255
_UNSEEN = {"Cc", "Cf", "Cs", "Co"}  # categories of Unicode: controls, what turns writing around, parts of no letter
_RIGHT_TO_LEFT = {"R", "AL"}
_UNLIKE_ASCII = str.maketrans(
    {
        "ø": "o",
        "đ": "d",
        "ð": "d",
        "þ": "th",
        "æ": "ae",
        "œ": "oe",
        "ł": "l",
        "ħ": "h",
        "ŋ": "n",
        "\N{LATIN SMALL LETTER DOTLESS I}": "i",
    }
)  # Latin letters that are no letter with an accent
_ENDING = re.compile(
    r"(\.ink)?\.(jpe?g|png|hei[cf]|webp|tiff?|gif|bmp|csv|uim|will|inkml|svgz?|json|npz)$", re.IGNORECASE
)


Stamp = tuple[int, int, int]
"""What differs whenever a file is written: its time, number and size."""


class Label(BaseModel):
    """Content of title.json. note: a line of text about the thing.  starred: whether it is one of the best."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: Literal[1] = 1
    title: str = ""
    note: str = ""
    starred: bool = False


def clean_title(typed: str, most: int = MOST_LETTERS) -> str:
    """Return a text as one line of at most `most` letters in Unicode's form C; "" where nothing of it can be seen.

    Controls and what turns writing around are left out.
    """
    kept = (letter for letter in typed if letter in JOINERS or letter.isspace() or _category(letter) not in _UNSEEN)
    text = " ".join(unicodedata.normalize("NFC", "".join(kept)).split())
    return _cut(text, most) if any(_category(letter)[0] not in "CMZ" for letter in text) else ""


def title_of_file(name: str) -> str:
    """Return the title that a file's name gives: its last part, without an ending that the studio knows."""
    return clean_title(_ENDING.sub("", re.split(r"[/\\]", name)[-1]))


def plain_name(title: str) -> str:
    """Return a title as a valid name: accents are left out, and so is all that is no Latin letter or digit."""
    letters = unicodedata.normalize("NFKD", title).casefold().translate(_UNLIKE_ASCII)
    unaccented = "".join(letter for letter in letters if not unicodedata.combining(letter))
    return re.sub(r"[^a-z0-9]+", "-", unaccented).strip("-")[:_LONGEST_NAME].strip("-")


def label_of(thing: Path) -> Label:
    """Read the label in the folder of a thing, which may have none."""
    stamp = stamp_of(path := thing / _RECORD)
    return Label() if stamp is None else _read(path, stamp)


def title_of(thing: Path) -> str:
    """Return the title of a thing by its folder: the folder's name where nobody gave it one."""
    return label_of(thing).title or thing.name


def retitle(thing: Path, title: str) -> str:
    """Give the thing in a folder this title; return it as it is kept.

    Raises InputError where nothing of it can be seen, and as `relabel`.
    """
    relabel(thing, title=(kept := checked_title(title)))
    return kept


def relabel(thing: Path, **changes: str | bool) -> None:
    """Change fields of the label in the folder of a thing, which is as old as before.

    Raises InputError where the thing is thrown away meanwhile, OutputError where the label cannot be written.
    """
    label = label_of(thing).model_copy(update=changes)
    try:
        age = thing.stat()
    except FileNotFoundError as error:
        raise InputError(f"{thing.name} is there no more; look in the trash") from error
    write_record(label, thing / _RECORD)
    os.utime(thing, ns=(age.st_atime_ns, age.st_mtime_ns))


def checked_title(typed: str) -> str:
    """Return a typed title as it is kept. Raises InputError where nothing of it can be seen."""
    if not (title := clean_title(typed)):
        raise InputError("there is no title yet; write one")
    return title


def titles_apart(titles: dict[str, str]) -> dict[str, str]:
    """Return titles by name for a page, with the name beside those that several things have."""
    times = Counter(titles.values())
    return {
        name: _isolated(title) if times[title] == 1 or title == name else f"{_isolated(title)} ({name})"
        for name, title in titles.items()
    }


def titles_of(things: Iterable[Path]) -> dict[str, str]:
    """Return the titles of things in folders by the folders' names, told apart as by `titles_apart`."""
    return titles_apart({thing.name: title_of(thing) for thing in things})


def numbered(title: str, taken: Iterable[str]) -> str:
    """Return the title, with a number where a thing has it already."""
    others, number, free = set(taken), 1, title
    while free in others:
        number += 1
        free = f"{_cut(title, MOST_LETTERS - len(str(number)) - 1)} {number}"
    return free


def free_among(taken: Iterable[str], title: str, word: str) -> str:
    """Return a name like the title that is none of those taken: for "My cät", my-cat or my-cat-2.

    word: for the thing, which the name of a title in another script, or of a number alone, begins with.
    """
    plain = plain_name(title)
    if not re.search("[a-z]", plain):
        plain = f"{word}-{plain}"
    plain = plain[:_ROOM].strip("-")
    others, number, name = set(taken), 1, plain
    while name in others:
        number += 1
        name = f"{plain}-{number}"
    return name


def stamp_of(path: Path) -> Stamp | None:
    """Return the stamp of a file; None where there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ino, status.st_size


def file_name(title: str, end: str) -> str:
    """Return the name of a downloaded file: the title, without what some system refuses in one, and an ending."""
    allowed = re.sub(r'[\\/:*?"<>|]+', "-", title).strip(" .-")
    while len(allowed.encode()) > _LONGEST_FILE:
        allowed = allowed[:-1]
    return f"{allowed or 'maulstick'}{end}"


@lru_cache(maxsize=4096)
def _read(path: Path, stamp: Stamp) -> Label:
    """Read the label in a file, again for each stamp."""
    try:
        label = read_record(Label, path, "title")
    except InputError:
        return Label()
    return label.model_copy(update={"title": clean_title(label.title), "note": clean_title(label.note, MOST_OF_A_NOTE)})


def _cut(text: str, most: int) -> str:
    """Return the first letters of a text, none of them without its accents."""
    end = min(most, len(text))
    while 0 < end < len(text) and _belong_together(text[end - 1], text[end]):
        end -= 1
    return text[: end or most].strip()


def _belong_together(before: str, after: str) -> bool:
    return "\N{ZERO WIDTH JOINER}" in (before, after) or _category(after) in ("Mn", "Mc", "Me", "Sk")


def _isolated(title: str) -> str:
    """Return a title that does not turn the words around it where it is written from right to left."""
    if any(unicodedata.bidirectional(letter) in _RIGHT_TO_LEFT for letter in title):
        return f"\N{FIRST STRONG ISOLATE}{title}\N{POP DIRECTIONAL ISOLATE}"
    return title


def _category(letter: str) -> str:
    return unicodedata.category(letter)
