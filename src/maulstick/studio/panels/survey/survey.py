"""Panel of surveys: a form for a new one, and the links and the results of each."""

import asyncio
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from nicegui import background_tasks, html, ui

from maulstick.errors import MaulstickError
from maulstick.storage.text import counted
from maulstick.studio.panels.survey.form import SurveyForm
from maulstick.studio.panels.survey.results import confusion_table, opinions_table, right_table
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.titles import file_name
from maulstick.studio.state.typed_numbers import whole_number
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.renaming import ask_for_title
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.widgets.undoing import offer_undo
from maulstick.studio.wording import error_text
from maulstick.studio.workers.survey_results import SurveyReport
from maulstick.survey.answers import MOST_LINKS, Participant

_STYLE = Path(__file__).with_name("survey.css")
_MOST_SHOWN = 40  # links; all of them can be copied
_PAUSE = 1.0  # seconds without the button after a click, longer than a double click takes
_COPY = "try { await navigator.clipboard.writeText(TEXT); return true; } catch { return false; }"
_LONGEST_COPY = 10.0  # seconds for the page to answer
_COPIED_LINKS = "links.txt"


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the panel. query: not used."""
    ui.add_css(_STYLE)
    html.h1("Ask people")
    html.p(
        "Can they tell whose hand it is? Which of two looks do they prefer? Everyone gets a link of their own."
    ).classes("hint")
    with ui.element().classes("desk survey"):
        _Panel(studio)


class _Panel:
    """List of surveys, and next to it the chosen one, or the form for a new one."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._address = studio, str(ui.context.client.request.base_url)
        self._chosen: str | None = next(iter(studio.surveys.names()), None)
        with html.nav().classes("side sheet").props('aria-label="Surveys"') as self._side:
            html.h2("Your surveys")
            self._list = ui.element().classes("survey-list")
            ui.button("A new survey", icon="add", on_click=lambda: self._choose(None)).props("outline")
        self._wide = ui.element().classes("wide")
        self._show()
        shown_by(self._side, studio.surveys.changed, self._follow)

    def _choose(self, name: str | None) -> None:
        if name != self._chosen:
            self._chosen = name
            self._show()

    def _show(self) -> None:
        name = self._chosen
        self._wide.clear()
        with self._wide:
            if name is None:
                SurveyForm(self._studio, made=self._choose)
            else:
                _Survey(self._studio, name, self._address)
        self._follow()

    def _follow(self) -> None:
        titles = self._studio.surveys.titles()
        names = list(titles)
        if self._chosen is not None and self._chosen not in names:
            self._choose(next(iter(names), None))
            return
        self._list.clear()
        with self._list:
            if not names:
                ui.label("There is none yet.").classes("hint")
            for name in names:
                each = html.button(titles[name]).props("type=button").classes("survey-name")
                each.on("click", lambda name=name: self._choose(name))
                if name == self._chosen:
                    each.props('aria-current="true"')


class _Survey:
    """Survey of the studio: its links and its results."""

    def __init__(self, studio: Studio, name: str, address: str) -> None:
        self._surveys, self._name, self._under = studio.surveys, name, f"{address}survey/{name}"
        self._people: list[Participant] | None = None
        with html.section().classes("sheet").props('aria-label="Links"') as self._root:
            with html.h2():
                self._title = ui.label(studio.surveys.titles().get(name, name))
            self._read = ui.label().classes("hint")
            self._read.visible = False
            self._count = ui.label("Counting the answers …").classes("figure").props('role="status"')
            with ui.element().classes("line"):
                self._more = NumberField("How many people?", value=10, min=1, max=MOST_LINKS)
                self._more.props("outlined dense").classes("how-many")
                self._make = ui.button("Make their links", icon="add_link", on_click=self._invite)
                self._all = ui.button("Copy all links", icon="content_copy", on_click=self._copy_all).props("outline")
                ui.button("Rename", icon="edit", on_click=self._ask_for_title).props("flat")
                ui.button("Throw away", icon="delete", on_click=self._throw_away).props("flat")
            if "//127." in address or "//localhost" in address:
                html.p(
                    "These links open on this computer only. For people elsewhere: ask whoever installed Maulstick to "
                    "open it to your network (--host), and make the links there."
                ).classes("hint")
            self._links = html.ul().classes("links")
        with html.section().classes("sheet").props('aria-label="Results"') as self._said:
            with ui.element().classes("line"):
                html.h2("What they said")
                ui.button("All answers as CSV", icon="download", on_click=self._download).props("outline")
            self._results = ui.element().classes("results")
        self._said.visible = False  # until the links are there, which would push it down
        shown_by(self._root, studio.surveys.changed, lambda: background_tasks.create(self._show(), context=self._root))

    async def _show(self) -> None:
        try:
            report, people = await self._surveys.report(self._name), await self._surveys.people(self._name)
        except MaulstickError as error:
            self._count.text, self._said.visible = error_text(error), True
            return
        if self._root.is_deleted:
            return
        begun, finished = sum(person.begun for person in people), sum(person.finished for person in people)
        self._show_title(report.title)
        self._count.text = (
            f"{counted(len(people), 'link')} · {counted(begun, 'has begun', 'have begun')} · "
            f"{counted(finished, 'has finished', 'have finished')}"
        )
        if people != self._people:
            self._people = people
            self._show_links([person for person in people if not person.finished])
        self._said.visible = True
        self._results.clear()
        with self._results:
            _tables(report)

    def _show_title(self, read: str) -> None:
        """Show the title. read: the one that participants read."""
        self._title.text = title = self._surveys.titles().get(self._name, read)
        self._read.text, self._read.visible = f"People read: {read}", read not in title

    def _ask_for_title(self) -> None:
        hint = "This is its name on this page; people go on reading the one that it was made with."
        ask_for_title(self._surveys.own_title(self._name), lambda typed: self._surveys.retitle(self._name, typed), hint)

    def _show_links(self, waiting: list[Participant]) -> None:
        self._all.visible = bool(waiting)
        self._links.clear()
        with self._links:
            for person in waiting[:_MOST_SHOWN]:
                link = self._link(person)
                with html.li():
                    state = f"{person.answered} answered" if person.begun else "not begun"
                    ui.label(f"Person {person.number}, {state}").classes("who figure")
                    ui.input(value=link).props("readonly dense outlined").props(f'aria-label="Link {person.number}"')
                    copy = ui.button("Copy", on_click=lambda link=link: _copy([link], "The link is copied."))
                    copy.props("flat").props(f'aria-label="Copy link {person.number}"')
            if len(waiting) > _MOST_SHOWN:
                html.li(f"and {len(waiting) - _MOST_SHOWN} more, which “Copy all links” copies too").classes("hint")

    def _link(self, person: Participant) -> str:
        return f"{self._under}/{person.token}"

    async def _invite(self) -> None:
        count = whole_number(self._more.value, "the number of people", 1, MOST_LINKS)
        self._make.disable()  # or a double click would make them twice
        try:
            await asyncio.gather(self._surveys.invite(self._name, count), asyncio.sleep(_PAUSE))
        finally:
            self._make.enable()
        ui.notify("The links are made. Give each to one person.")

    async def _copy_all(self) -> None:
        waiting = [person for person in self._people or () if not person.finished]
        await _copy([*map(self._link, waiting)], f"Copied, one per line: {len(waiting)}.")

    async def _download(self) -> None:
        csv = await self._surveys.csv(self._name)
        ui.download.content(csv, file_name(self._surveys.own_title(self._name), ".csv"), "text/csv")

    def _throw_away(self) -> None:
        title = self._surveys.titles().get(self._name, self._name)
        trashed = self._surveys.throw_away(self._name)
        offer_undo(
            self._root.client,
            f"{title} and its answers are thrown away.",
            lambda: self._surveys.take_back(trashed),
        )


async def _copy(links: Sequence[str], done: str) -> None:
    """Copy links, one per line, and say `done`; save them as a file where the browser lets the page copy nothing."""
    page, text, is_copied = ui.context.client, "\n".join(links), False
    with suppress(TimeoutError):
        is_copied = await page.run_javascript(_COPY.replace("TEXT", json.dumps(text)), timeout=_LONGEST_COPY)
    with page:  # the button may be gone
        if is_copied:
            ui.notify(done)
            return
        ui.download.content(text, _COPIED_LINKS, "text/plain")
        ui.notify(f"The browser lets this page copy nothing; saved as {_COPIED_LINKS} instead.")


def _tables(report: SurveyReport) -> None:
    found = report.results
    if not found.begun:
        ui.label("Nobody has answered yet. The tables fill in as people do.").classes("hint")
        return
    if found.matching is not None and report.right is not None:
        confusion_table(found.matching)
        right_table(report.right)
    if report.opinions is not None:
        opinions_table(report.opinions)
    html.p(
        "With 95 % certainty the true share lies in the interval; the more people answer, the narrower it is. p is how "
        "likely mere chance would have looked like this, or more so."
    ).classes("hint")
