"""The surveys of the studio: built from drawings that are there, and what their participants said."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.survey_draft import Draft
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.survey_results import Told, told
from maulstick.survey.answers import Answers, Participant
from maulstick.survey.questionnaire import build
from maulstick.survey.results import answers_csv

_DRAWINGS = {
    "hands": {"hand.png": "by hand"},
    "plans": {"preview.png": "planned", "painting-painted.png": "painted"},
    "pictures": {"picture.png": "picture"},
}
"""What can be shown in a survey: by kind, the files, and what they are called."""

_SMALL = {"picture.png": "small.jpg"}
_PAUSE = 1.0  # seconds between two refreshes for answers: many may come at once


@final
class Surveys:
    """All of them by name. changed: when there are others, or somebody answered."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._pause: asyncio.TimerHandle | None = None
        self._telling = asyncio.Lock()
        self._waiting: dict[str, asyncio.Task[Told]] = {}

    def names(self) -> list[str]:
        """The surveys that there are, newest first."""
        names = reversed(self._folder.names("surveys"))
        return [name for name in names if (self._folder.of("surveys", name) / "survey.json").is_file()]

    def drawings(self) -> dict[str, str]:
        """What can be shown in a survey: a key of each, and its name for people."""
        return {
            f"{kind}/{name}/{file}": f"{name} ({called})"
            for kind, files in _DRAWINGS.items()
            for name in reversed(self._folder.names(kind))
            for file, called in files.items()
            if (self._folder.of(kind, name) / file).is_file()
        }

    async def make(self, draft: Draft) -> str:
        """Make the survey; its name. Raises InputError, saying what is still missing."""
        title = str(draft.title).strip()
        if not title:
            raise InputError("the survey has no title yet; give it one, participants will read it")
        match, opinions = draft.match(self._path), draft.opinions(self._path)
        if match is None and opinions is None:
            raise InputError("the survey asks nothing yet; choose drawings for at least one of its two parts")
        name = self._folder.free_name("surveys", title)
        await self._desk.do(build, self._folder.of("surveys", name), title, match, opinions)
        self.changed.emit()
        return name

    async def told(self, name: str) -> Told:
        """What its participants said so far. Raises InputError where there is no such survey."""
        if name not in self._waiting:
            self._waiting[name] = asyncio.create_task(self._tell(name))
        return await asyncio.shield(self._waiting[name])  # other pages wait for the same

    def somebody_progressed(self) -> None:
        """A participant began or answered; the pages are told once for all who do within a second."""
        if self._pause is None:
            self._pause = asyncio.get_running_loop().call_later(_PAUSE, self._tell_pages)

    async def people(self, name: str) -> list[Participant]:
        """Who has a link to it. Raises InputError where there is no such survey."""
        return await asyncio.to_thread(Answers(self._of(name)).participants)

    async def invite(self, name: str, count: int) -> None:
        """Make links for so many more participants. Raises InputError for fewer than 1 or more than 1000."""
        await asyncio.to_thread(Answers(self._of(name)).mint, count)
        self.changed.emit()

    async def csv(self, name: str) -> bytes:
        """Every answer as a line of CSV. Raises InputError where there is no such survey."""
        answers = await asyncio.to_thread(Answers(self._of(name)).all)
        return answers_csv(answers)

    def throw_away(self, name: str) -> Path:
        """Put it into the trash with its answers; where it is there. Raises InputError where there is none."""
        grave = self._folder.throw_away(self._of(name))
        self.changed.emit()
        return grave

    def take_back(self, grave: Path) -> None:
        """Take it out of the trash. Raises OutputError where another has its name."""
        self._folder.take_back(grave, self._folder.root / "surveys")
        self.changed.emit()

    def _tell_pages(self) -> None:
        self._pause = None
        self.changed.emit()

    async def _tell(self, name: str) -> Told:
        async with self._telling:  # or surveys alone could keep the desk busy
            del self._waiting[name]  # whoever asks from here on may know of more answers
            return await self._desk.do(told, self._of(name))

    def _of(self, name: str) -> Path:
        path = self._folder.of("surveys", name)
        if not (path / "survey.json").is_file():
            raise InputError(f"there is no survey {name} any more")
        return path

    def _path(self, drawing: str) -> Path:
        """The file of a drawing. Raises InputError where there is none any more."""
        if drawing not in self.drawings():
            raise InputError(f"there is no drawing {drawing} any more; choose another")
        kind, name, file = drawing.split("/")
        return self._folder.of(kind, name) / file


def address_of(drawing: str) -> str:
    """Where the page finds a drawing, by its key."""
    kind, name, file = drawing.split("/")
    return f"/picture/{kind}/{name}/{_SMALL.get(file, file)}"
