"""Web application for participants: their own page, the pictures of their current question, and nothing else."""

import logging
import re
from collections.abc import Callable
from pathlib import Path
from typing import Final, final
from urllib.parse import parse_qsl

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from maulstick.errors import MaulstickError
from maulstick.storage.files import read_whole
from maulstick.survey.answers import Answers, Participant
from maulstick.survey.pages import ICON, STYLE, apology, asking, beginning, letters, thanks
from maulstick.survey.questionnaire import read_survey_to_show
from maulstick.survey.questions import Question, questions

_HEADERS: Final = {
    "Content-Security-Policy": "default-src 'none'; img-src 'self'; style-src 'self'; form-action 'self'; "
    "frame-ancestors 'none'; base-uri 'none'",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
}
_LARGEST_FORM = 4096  # bytes; the forms of these pages have less than a hundred
_LARGEST_PICTURE = 2**24  # bytes; a PNG of 1024 x 1024 pixels, which `build` makes at most, has less
_NUMBER = r"[0-9]{1,3}"
_FORMS = ({"begin"}, {"number"}, {"number", "chosen"})
_NOT_OURS = "There is no such page. Please check the link that you were given: it must be whole."
_NOT_UNDERSTOOD = "That answer could not be understood, and nothing has changed. Please open your link again."
_SENTENCES: Final = {
    403: "That answer came from another site, and nothing has changed. Please open your link again.",
    404: _NOT_OURS,
    405: _NOT_OURS,
    503: "The survey cannot be reached at the moment. Please try again later; all answers given so far are kept.",
}


def participants(folder: Path, progressed: Callable[[], None]) -> Starlette:
    """Make the web application of the survey in `folder`, with a page /TOKEN per participant.

    progressed: called, in any thread, after a participant has begun and after each answer that is stored.
    Raises InputError where there is no survey in the folder.
    """
    pages = _Pages(folder, progressed)
    app = Starlette(
        routes=[
            Route("/survey.css", _style),
            Route("/icon.svg", _icon),
            Route("/{token}", pages.show, methods=["GET"]),
            Route("/{token}", pages.take, methods=["POST"]),
            Route("/{token}/picture/{position}", pages.picture, methods=["GET"]),
        ],
        exception_handlers={HTTPException: _refused, MaulstickError: _broken},
    )
    app.router.redirect_slashes = False  # it would redirect to whatever host the request names
    return app


@final
class _Pages:
    """Handlers of the requests of participants, who are known by their tokens."""

    def __init__(self, folder: Path, progressed: Callable[[], None]) -> None:
        self._folder, self._progressed = folder, progressed
        self._survey = read_survey_to_show(folder)
        self._answers = Answers(folder)

    def show(self, request: Request) -> Response:
        person, their_questions = self._participant_of(request)
        return self._page(request, person, their_questions, again=False)

    async def take(self, request: Request) -> Response:
        fields = await _fields(request)
        return await run_in_threadpool(self._take, request, fields)

    def picture(self, request: Request) -> Response:
        person, their_questions = self._participant_of(request)
        if not person.begun or person.answered >= len(their_questions):
            raise HTTPException(404)
        question = their_questions[person.answered]
        pictures = (question.reference, *(choice.picture for choice in question.choices))
        position = request.path_params["position"]
        if not re.fullmatch(_NUMBER, position) or int(position) >= len(pictures):
            raise HTTPException(404)
        content = read_whole(self._folder / pictures[int(position)], "picture", _LARGEST_PICTURE)
        return Response(content, media_type="image/png", headers=_HEADERS)

    def _participant_of(self, request: Request) -> tuple[Participant, tuple[Question, ...]]:
        """Return the participant who asks, and all questions of theirs."""
        person = self._answers.participant(request.path_params["token"])
        if person is None:
            raise HTTPException(404)
        return person, questions(self._survey, person.seed)

    def _page(
        self, request: Request, person: Participant, their_questions: tuple[Question, ...], again: bool
    ) -> Response:
        root = _root(request)
        if not person.begun:
            page = beginning(self._survey, len(their_questions), root)
        elif not person.finished and person.answered < len(their_questions):
            page = asking(self._survey, person.answered, their_questions, person.token, root, again=again)
        else:
            page = thanks(self._survey, root)
        return HTMLResponse(page, headers=_HEADERS)

    def _take(self, request: Request, fields: dict[str, str]) -> Response:
        person, their_questions = self._participant_of(request)
        if "begin" in fields:
            self._answers.begin(person.token)
            if not person.begun:
                self._progressed()
        elif not re.fullmatch(_NUMBER, fields["number"]):
            raise HTTPException(400)
        elif person.begun and person.answered == int(fields["number"]) < len(their_questions):
            if "chosen" not in fields:
                return self._page(request, person, their_questions, again=True)
            self._keep(person, their_questions, fields["chosen"])
        return RedirectResponse(f"{_root(request)}/{person.token}", status_code=303, headers=_HEADERS)

    def _keep(self, person: Participant, their_questions: tuple[Question, ...], letter: str) -> None:
        number = person.answered
        chosen = dict(zip(letters(their_questions[number]), their_questions[number].choices, strict=True)).get(letter)
        if chosen is None:
            raise HTTPException(400)
        if self._answers.answer(
            person.token, number, their_questions[number], chosen.name, last=number + 1 == len(their_questions)
        ):
            self._progressed()


async def _fields(request: Request) -> dict[str, str]:
    """Read the fields of one of the forms of these pages; refuse any other form."""
    origin = request.headers.get("origin")
    if origin is not None and origin.partition("://")[2] != request.headers.get("host"):
        raise HTTPException(403)
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > _LARGEST_FORM:
            raise HTTPException(413)
    try:
        pairs = parse_qsl(body.decode("ascii"), strict_parsing=True, max_num_fields=2, errors="strict")
    except ValueError as error:
        raise HTTPException(400) from error
    fields = dict(pairs)
    if len(fields) < len(pairs) or fields.keys() not in _FORMS:
        raise HTTPException(400)
    return fields


def _root(request: Request) -> str:
    return str(request.scope.get("root_path", ""))


def _style(_: Request) -> Response:
    return Response(STYLE, media_type="text/css", headers=_HEADERS)


def _icon(_: Request) -> Response:
    return Response(ICON, media_type="image/svg+xml", headers=_HEADERS)


def _refused(request: Request, error: Exception) -> Response:
    status = error.status_code if isinstance(error, HTTPException) else 500
    sentence = _SENTENCES.get(status, _NOT_UNDERSTOOD)
    return HTMLResponse(apology(sentence, _root(request)), status_code=status, headers=_HEADERS)


def _broken(request: Request, error: Exception) -> Response:
    logging.getLogger(__name__).error("%s", error)  # for whoever serves the survey; a participant cannot mend it
    return HTMLResponse(apology(_SENTENCES[503], _root(request)), status_code=503, headers=_HEADERS)
