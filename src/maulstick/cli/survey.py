"""``maulstick survey``: links for the participants of a survey, their pages, and its results."""

import re
from contextlib import suppress
from ipaddress import ip_address
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from maulstick.errors import InputError, how_to_add
from maulstick.storage.files import atomic_write
from maulstick.storage.text import counted
from maulstick.studio.server.link import pages_at
from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import check_no_link, read_survey_to_show


def survey(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of the survey, with its survey.json.")],
    links: Annotated[
        int | None, typer.Option(metavar="N", help="Make and print links for N more participants.")
    ] = None,
    results: Annotated[
        bool, typer.Option("--results", metavar="", help="Print the results, and write answers.csv into the folder.")
    ] = False,
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Address of this computer for participants.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(metavar="N", help="Port of the pages, from 1 to 65535.")] = 8338,
) -> None:
    """Ask people about drawings on the pages of a survey, until Ctrl-C.

    Every participant needs a link of their own, which leads to their questions and to nothing else: `--links 20` makes
    twenty links and ends. `--results` prints the results so far and ends. Answers are kept in answers.sqlite in the
    folder.

    Example: maulstick survey my-survey --links 20
    """
    if not 1 <= port <= 65535:
        raise InputError.of_range("the port", port, "from 1 to 65535")
    if not _is_address(host):
        raise InputError.of_range("--host", repr(host), "an address or a name of this computer, as in 192.168.1.20")
    if results and links is not None:
        raise InputError("--links and --results were both given; run one after the other")
    if results:
        _print_results(folder)
        return
    read_survey_to_show(folder)
    if links is not None:
        for token in Answers(folder).mint(links):
            print(f"{pages_at(host, port)}{token}")
    else:
        _serve(folder, host, port)


def _is_address(host: str) -> bool:
    """Return whether links can lead to a host: a page's whole address does not, nor a name that ends in a number."""
    with suppress(ValueError):
        ip_address(host)
        return True
    return re.fullmatch(r"([a-z0-9_-]+\.)*(?!\d+$)[a-z0-9_-]+", host, re.IGNORECASE) is not None


def _serve(folder: Path, host: str, port: int) -> None:
    try:
        from maulstick.survey.serve import listening, serve
    except ImportError:
        raise InputError(f"a web server is needed, and not installed; {how_to_add('studio')}") from None
    people = Answers(folder).participants()
    if not people:
        raise InputError(f"nobody has a link to {folder} yet; make some with --links 20, then run this again")
    with listening(host, port) as at:
        waiting = [person for person in people if not person.finished]
        for person in waiting:
            print(f"{pages_at(host, port)}{person.token}")
        print(f"{len(people) - len(waiting)} of {len(people)} participants have finished; Ctrl-C ends", flush=True)
        serve(folder, at)


def _print_results(folder: Path) -> None:
    from maulstick.survey.results import Rows, answers_csv, matching_rows, opinions_rows, right_rows
    from maulstick.survey.results import results as results_of

    def show(title: str, told: Rows) -> None:
        table = Table(title=title, title_justify="left")
        for number, head in enumerate(told.heads):
            table.add_column(Text(head), justify="right" if number else "left", overflow="fold")
        for row in told.rows:
            table.add_row(*map(Text, row))
        console.print(table)

    out = folder / "answers.csv"
    check_no_link(out, "table")
    found = results_of(folder)
    console = Console()
    print(f"{counted(found.links, 'link')}, {found.begun} began, {found.finished} finished")
    if found.matching is not None:
        show("Which hand was chosen", matching_rows(found.matching))
        show("How often it was the right one", right_rows(found.matching))
    if found.systems is not None:
        show("Opinions", opinions_rows(found.systems, found.opinions))
    atomic_write(out, answers_csv(Answers(folder).all()))
    print(out, flush=True)
