"""Participants of a survey and their answers: an SQLite database beside survey.json, used in short transactions."""

import secrets
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import final

from pydantic import BaseModel, ConfigDict, ValidationError

from maulstick.errors import InputError, OutputError, validation_fault
from maulstick.survey.questionnaire import check_no_link
from maulstick.survey.questions import Kind, Question

MOST_LINKS = 1000
"""Most links that one call makes, so that a slip of the finger does not fill the page."""

_VERSION = 1  # of the tables below; a database of another version is refused
_PATIENCE = 10.0  # seconds to wait for another process that writes
_TABLES = f"""
BEGIN IMMEDIATE;
CREATE TABLE IF NOT EXISTS participants (
    number INTEGER PRIMARY KEY, token TEXT NOT NULL UNIQUE, seed INTEGER NOT NULL,
    made REAL NOT NULL, begun REAL, finished REAL
);
CREATE TABLE IF NOT EXISTS answers (
    participant INTEGER NOT NULL REFERENCES participants, number INTEGER NOT NULL, kind TEXT NOT NULL,
    asks TEXT NOT NULL, shown TEXT NOT NULL, chosen TEXT NOT NULL, seconds REAL NOT NULL, moment REAL NOT NULL,
    PRIMARY KEY (participant, number)
);
PRAGMA user_version = {_VERSION};
COMMIT;
"""
_PARTICIPANTS = """
SELECT number, token, seed, begun IS NOT NULL AS begun, finished IS NOT NULL AS finished,
    (SELECT count(*) FROM answers WHERE participant = participants.number) AS answered
FROM participants
"""


@dataclass(frozen=True)
class Participant:
    """Person who has a link to the survey.

    token: the secret part of the link.  seed: of the order of their questions.  answered: number of questions
    answered so far, from the first on.
    """

    number: int
    token: str
    seed: int
    begun: bool
    finished: bool
    answered: int


class Shown(BaseModel):
    """Record of what a participant was shown with a question.

    about: as in `Question`.  pictures: file names, the reference first.  choices: names of the hands or the systems,
    in the order in which they were shown.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    about: str
    pictures: tuple[str, ...]
    choices: tuple[str, ...]


class Answer(BaseModel):
    """Answer of a participant to a question. chosen: name of the hand or the system.

    participant: number from 1.  number: of the question, from 0.
    seconds: since the answer before, or since they began.  moment: seconds since 1970.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    participant: int
    number: int
    kind: Kind
    asks: str
    shown: Shown
    chosen: str
    seconds: float
    moment: float


@final
class Answers:
    """Answers in the folder of a survey; usable from any thread and any process.

    All methods raise OutputError where the database cannot be written, and InputError where it holds something else.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / "answers.sqlite"

    def mint(self, count: int) -> list[str]:
        """Add `count` participants and return their tokens. Raises InputError for fewer than 1 or more than 1000."""
        if not 1 <= count <= MOST_LINKS:
            raise InputError.of_range("the number of new links", count, f"from 1 to {MOST_LINKS}")
        made = [(secrets.token_urlsafe(16), secrets.randbits(32), time.time()) for _ in range(count)]
        with self._opened() as database:
            database.executemany("INSERT INTO participants (token, seed, made) VALUES (?, ?, ?)", made)
        return [token for token, _, _ in made]

    def participants(self) -> list[Participant]:
        """Return all participants, in the order in which their links were made."""
        with self._opened() as database:
            return [Participant(**row) for row in database.execute(f"{_PARTICIPANTS} ORDER BY number")]

    def participant(self, token: str) -> Participant | None:
        """Return the participant whose link has this token, or None."""
        with self._opened() as database:
            return _find(database, token)

    def begin(self, token: str) -> None:
        """Record that the participant begins; calling it again changes nothing."""
        with self._opened() as database:
            database.execute(
                "UPDATE participants SET begun = ? WHERE token = ? AND begun IS NULL", (time.time(), token)
            )

    def answer(self, token: str, number: int, question: Question, chosen: str, last: bool) -> bool:
        """Store the answer to question `number` if that one is due; return whether it was stored."""
        shown = Shown(
            about=question.about,
            pictures=(question.reference.name, *(choice.picture.name for choice in question.choices)),
            choices=tuple(choice.name for choice in question.choices),
        )
        with self._opened() as database:
            database.execute("BEGIN IMMEDIATE")
            person = _find(database, token)
            if person is None or not person.begun or person.finished or person.answered != number:
                return False
            now = time.time()
            (before,) = database.execute(
                "SELECT max(coalesce(max(moment), 0), begun) FROM participants LEFT JOIN answers"
                " ON participant = participants.number WHERE participants.number = ?",
                (person.number,),
            ).fetchone()
            database.execute(
                "INSERT INTO answers VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (person.number, number, question.kind, question.asks, shown.model_dump_json(), chosen,
                 max(0.0, now - before), now),
            )  # fmt: skip
            if last:
                database.execute("UPDATE participants SET finished = ? WHERE number = ?", (now, person.number))
        return True

    def all(self) -> list[Answer]:
        """Return all answers, ordered by participant and then by question."""
        with self._opened() as database:
            rows = [dict(row) for row in database.execute("SELECT * FROM answers ORDER BY participant, number")]
        try:
            return [Answer.model_validate(row | {"shown": Shown.model_validate_json(row["shown"])}) for row in rows]
        except ValidationError as error:
            raise InputError(f"{self.path} does not hold answers of a survey: {validation_fault(error)}") from error

    @contextmanager
    def _opened(self) -> Iterator[sqlite3.Connection]:
        check_no_link(self.path, "database")
        try:
            with closing(sqlite3.connect(self.path, timeout=_PATIENCE)) as database, database:
                database.row_factory = sqlite3.Row
                database.execute("PRAGMA trusted_schema = OFF")  # a survey may come by mail
                self._check(database)
                yield database
        except sqlite3.OperationalError as error:
            raise OutputError(f"cannot use {self.path}: {error}; is there room, and may you write there?") from error
        except sqlite3.DatabaseError as error:
            raise InputError(f"{self.path} is not a database of answers: {error}; put the right one back") from error

    def _check(self, database: sqlite3.Connection) -> None:
        (version,) = database.execute("PRAGMA user_version").fetchone()
        if version == 0:
            database.executescript(_TABLES)
        elif version != _VERSION:
            raise InputError(
                f"{self.path} has version {version}, and this Maulstick knows {_VERSION}; update Maulstick"
            )


def _find(database: sqlite3.Connection, token: str) -> Participant | None:
    row = database.execute(f"{_PARTICIPANTS} WHERE token = ?", (token,)).fetchone()
    return None if row is None else Participant(**row)
