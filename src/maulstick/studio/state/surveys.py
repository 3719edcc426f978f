"""Surveys of the studio: built from drawings in its folder, with the results so far."""

import asyncio
from pathlib import Path
from typing import final

from nicegui import Event

from maulstick.errors import InputError
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.survey_draft import Draft
from maulstick.studio.state.titles import clean_title, retitle, title_of
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.survey_results import SurveyReport, survey_report
from maulstick.survey.answers import Answers, Participant
from maulstick.survey.questionnaire import build
from maulstick.survey.results import answers_csv

_DRAWINGS = {
    "hands": {"hand.png": "by hand"},
    "plans": {"preview.png": "planned", "painting-painted.png": "painted"},
    "pictures": {"picture.png": "picture"},
}
"""Files that can be shown in a survey, by kind, with their names for people."""

_SMALL = {"picture.png": "small.jpg"}  # thumbnails for the page
_MOST_LETTERS = 120  # of the title that participants read, as `build` takes it
_PAUSE = 1.0  # seconds between two refreshes for answers: many may come at once


@final
class Surveys:
    """Surveys by their names. changed: emitted after one was added or removed, or somebody answered."""

    def __init__(self, folder: Folder, desk: Desk) -> None:
        self.changed = Event[[]]()
        self._folder, self._desk = folder, desk
        self._pause: asyncio.TimerHandle | None = None
        self._reporting = asyncio.Lock()
        self._waiting: dict[str, asyncio.Task[SurveyReport]] = {}

    def names(self) -> list[str]:
        """Return the names of all surveys, newest first."""
        names = reversed(self._folder.names("surveys"))
        return [name for name in names if (self._folder.of("surveys", name) / "survey.json").is_file()]

    def titles(self) -> dict[str, str]:
        """Return the titles of all surveys by name, newest first, told apart."""
        titles = self._folder.titles("surveys")
        return {name: titles[name] for name in self.names() if name in titles}

    def own_title(self, name: str) -> str:
        """Return the title of a survey, as it was written. Raises InputError where there is no such survey."""
        return title_of(self._of(name))

    def retitle(self, name: str, title: str) -> None:
        """Give a survey another title on the page; participants go on reading the one that it was made with.

        Raises InputError as `titles.retitle`, and where there is no such survey.
        """
        retitle(self._of(name), title)
        self.changed.emit()

    def drawings(self) -> dict[str, str]:
        """Return the drawings that can be shown in a survey: their keys, and their names for people."""
        return {
            f"{kind}/{name}/{file}": f"{title} ({called})"
            for kind, files in _DRAWINGS.items()
            for name, title in reversed(self._folder.titles(kind).items())
            for file, called in files.items()
            if (self._folder.of(kind, name) / file).is_file()
        }

    async def make(self, draft: Draft) -> str:
        """Make the survey and return its name. Raises InputError where something is still missing."""
        title = clean_title(str(draft.title), _MOST_LETTERS)
        if not title:
            raise InputError("the survey has no title yet; give it one, participants will read it")
        match, opinions = draft.match(self._path), draft.opinions(self._path)
        if match is None and opinions is None:
            raise InputError("the survey asks nothing yet; choose drawings for at least one of its two parts")
        name = self._folder.free_name("surveys", title)
        await self._desk.do(build, folder := self._folder.of("surveys", name), title, match, opinions)
        retitle(folder, title)
        self.changed.emit()
        return name

    async def report(self, name: str) -> SurveyReport:
        """Return the results of a survey so far. Raises InputError where there is no such survey."""
        if name not in self._waiting:
            self._waiting[name] = asyncio.create_task(self._report(name))
        return await asyncio.shield(self._waiting[name])  # other pages wait for the same

    def note_progress(self) -> None:
        """Note that a participant began or answered; pages are refreshed at most once per second."""
        if self._pause is None:
            self._pause = asyncio.get_running_loop().call_later(_PAUSE, self._refresh_pages)

    async def people(self, name: str) -> list[Participant]:
        """Return all participants of a survey. Raises InputError where there is no such survey."""
        return await asyncio.to_thread(Answers(self._of(name)).participants)

    async def invite(self, name: str, count: int) -> None:
        """Make links for `count` more participants. Raises InputError for fewer than 1 or more than 1000."""
        await asyncio.to_thread(Answers(self._of(name)).mint, count)
        self.changed.emit()

    async def csv(self, name: str) -> bytes:
        """Encode all answers as CSV, one line per answer. Raises InputError where there is no such survey."""
        answers = await asyncio.to_thread(Answers(self._of(name)).all)
        return answers_csv(answers)

    def throw_away(self, name: str) -> Path:
        """Move a survey and its answers into the trash; return its place. Raises InputError for an unknown one."""
        trashed = self._folder.throw_away(self._of(name))
        self.changed.emit()
        return trashed

    def take_back(self, trashed: Path, name: str = "") -> None:
        """Move a survey back out of the trash; raises, and name, as `Folder.take_back`."""
        self._folder.take_back(trashed, self._folder.root / "surveys", name)
        self.changed.emit()

    def _refresh_pages(self) -> None:
        self._pause = None
        self.changed.emit()

    async def _report(self, name: str) -> SurveyReport:
        async with self._reporting:  # or surveys alone could keep the desk busy
            del self._waiting[name]  # a later caller may know of more answers
            return await self._desk.do(survey_report, self._of(name))

    def _of(self, name: str) -> Path:
        path = self._folder.of("surveys", name)
        if not (path / "survey.json").is_file():
            raise InputError(f"there is no survey {name} any more")
        return path

    def _path(self, drawing: str) -> Path:
        """Return the file of a drawing. Raises InputError where it is gone."""
        if drawing not in self.drawings():
            raise InputError(f"there is no drawing {drawing} any more; choose another")
        kind, name, file = drawing.split("/")
        return self._folder.of(kind, name) / file


def address_of(drawing: str) -> str:
    """Return the address of a drawing for the page, by its key."""
    kind, name, file = drawing.split("/")
    return f"/picture/{kind}/{name}/{_SMALL.get(file, file)}"
