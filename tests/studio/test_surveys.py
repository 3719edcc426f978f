"""Surveys of the studio: put together from drawings, answered, thrown away; and all paths below /survey/."""

import asyncio
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest
from PIL import Image
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Mount
from starlette.types import Message, Scope

from maulstick.errors import InputError, MaulstickError
from maulstick.studio.server.gate import Gate
from maulstick.studio.server.survey_pages import survey_pages
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.survey_draft import Draft, HandDraft, PairDraft
from maulstick.studio.state.surveys import Surveys, address_of
from maulstick.studio.workers.desk import Desk
from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import build, read_survey
from maulstick.survey.questions import questions
from tests.survey.conftest import sources

PICTURES = ("ann", "bo", "robot-ann", "robot-bo")
KEYS = [f"pictures/{name}/picture.png" for name in PICTURES]


def whole() -> Draft:
    """Make a complete draft, with an empty row in each part."""
    hands = [HandDraft("Ann", KEYS[0], [KEYS[2]]), HandDraft("Bo", KEYS[1], [KEYS[3]]), HandDraft()]
    pairs = [PairDraft(KEYS[0], KEYS[2], KEYS[3]), PairDraft()]
    return Draft(" Strokes? ", "whose drawing", hands, 1, "loops", "lines", pairs)


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Folder]:
    """Folder of a studio with four pictures."""
    with Folder.opened(tmp_path / "studio") as opened:
        for name in PICTURES:
            (opened.root / "pictures" / name).mkdir()
            for file in ("picture.png", "small.jpg"):
                Image.new("RGB", (12, 8), "red").save(opened.root / "pictures" / name / file)
        yield opened


def without(change: Callable[[Draft], object]) -> Draft:
    """Return the complete draft with a change."""
    draft = whole()
    change(draft)
    return draft


@pytest.mark.parametrize(
    ("draft", "why"),
    [
        (Draft(), "the survey has no title yet"),
        (Draft(["Strokes?"]), "the survey asks nothing yet; choose"),
        (Draft("Strokes?"), "the survey asks nothing yet; choose drawings for at least one of its two parts"),
        (without(lambda draft: setattr(draft.hands[1], "name", " ")), "hand 2 has no name"),
        (without(lambda draft: setattr(draft.hands[1], "by_hand", None)), "Bo has no drawing by the person yet"),
        (without(lambda draft: draft.hands[0].by_machine.clear()), "Ann has no drawing by the machine yet"),
        (without(lambda draft: draft.hands.pop(1)), "Ann is the only hand; add another"),
        (without(lambda draft: setattr(draft.hands[1], "name", "Ann")), "two hands have one name"),
        (without(lambda draft: draft.hands[0].by_machine.append(KEYS[0])), "every hand needs as many drawings"),
        (
            without(lambda draft: setattr(draft, "hands_asked", 3)),
            "is asked about is 3; it must be a whole number from 1 to 2",
        ),
        (
            without(lambda draft: setattr(draft, "hands_asked", None)),
            "the number of hands that each person is asked about is nothing; it must be a whole number from 1 to 2",
        ),
        (without(lambda draft: setattr(draft, "pairs_asked", 2)), "the number of pictures that each person is asked"),
        (without(lambda draft: setattr(draft, "second_look", "")), "one of the two looks has no name yet"),
        (without(lambda draft: setattr(draft, "second_look", "loops")), "both looks have one name; give each its own"),
        (without(lambda draft: setattr(draft.pairs[0], "second", None)), "comparison 1 is not whole"),
        (
            without(lambda draft: setattr(draft.pairs[0], "first", "plans/gone/preview.png")),
            "there is no drawing plans/",
        ),
        (without(lambda draft: setattr(draft.pairs[0], "first", "../../../secret.png")), "there is no drawing ../"),
    ],
)
def test_what_is_missing_is_said_and_nothing_is_made(folder: Folder, draft: Draft, why: str) -> None:
    surveys = Surveys(folder, Desk())
    with pytest.raises(InputError) as refused:
        asyncio.run(surveys.make(draft))
    assert why in str(refused.value)
    assert "(got" not in str(refused.value), "it would be of Python, which people do not read"
    assert surveys.names() == []


def test_a_survey_is_made_answered_thrown_away_and_taken_back(folder: Folder) -> None:
    async def live() -> None:
        desk = Desk()
        surveys = Surveys(folder, desk)
        try:
            assert await surveys.make(whole()) == "strokes"
            assert await surveys.make(whole()) == "strokes-2"
            assert set(surveys.names()) == {"strokes", "strokes-2"}
            made = read_survey(folder.of("surveys", "strokes"))
            assert made.title == "Strokes?"
            assert made.match is not None
            assert made.opinions is not None
            assert made.match.question == "whose drawing"
            assert [hand.name for hand in made.match.hands] == ["Ann", "Bo"]
            assert len(made.opinions.pairs) == 1

            await surveys.invite("strokes", 2)
            with pytest.raises(InputError, match="the number of new links is 0; it must be from 1 to 1000"):
                await surveys.invite("strokes", 0)
            first, second = await surveys.people("strokes")
            store = Answers(folder.of("surveys", "strokes"))
            store.begin(first.token)
            store.answer(first.token, 0, questions(made, first.seed)[0], "Ann", last=False)
            told = await surveys.report("strokes")
            assert (told.title, told.results.links, told.results.begun, told.results.finished) == ("Strokes?", 2, 1, 0)
            assert told.results.matching is not None
            assert told.results.matching.counts[:, 0].sum() == told.results.matching.counts.sum() == 1
            assert told.right is not None
            assert told.opinions is not None
            assert (await surveys.csv("strokes")).count(b"\n") == 2
            assert second.token not in (await surveys.csv("strokes")).decode()

            trashed = surveys.throw_away("strokes")
            with pytest.raises(InputError, match="there is no survey strokes any more"):
                await surveys.report("strokes")
            surveys.take_back(trashed)
            assert await surveys.people("strokes") == [store.participant(first.token), second]
        finally:
            desk.close()

    asyncio.run(live())


def test_hands_plans_and_pictures_can_be_shown(folder: Folder) -> None:
    plan = ("preview.png", "painting-painted.png", "request.json")
    for path in ("hands/me/hand.png", *(f"plans/cat/{name}" for name in plan)):
        file = folder.root / path
        file.parent.mkdir(exist_ok=True)
        file.touch()
    told = Surveys(folder, Desk()).drawings()
    assert set(told) == {
        "hands/me/hand.png", "plans/cat/preview.png", "plans/cat/painting-painted.png", *KEYS,
    }  # fmt: skip
    assert told["plans/cat/preview.png"] == "cat (planned)"
    assert address_of(KEYS[0]) == "/picture/pictures/ann/small.jpg"


@pytest.mark.parametrize("name", ["../hands", "", "none", "strokes/../strokes"])
def test_a_survey_that_is_none_is_refused(folder: Folder, name: str) -> None:
    with pytest.raises(MaulstickError):
        Surveys(folder, Desk()).throw_away(name)


SECRET = "the studio itself"


def answered(
    folder: Folder, path: str, kind: str = "http", form: bytes | None = None, progressed: Callable[[], None] = print
) -> tuple[int, str]:
    """Send a request without the studio's token; return the status, or the code that closes a socket, and the body.

    form: is sent, where there is one.  progressed: as `Surveys.note_progress`.
    """
    inside = Starlette(routes=[Mount("/survey", survey_pages()), Mount("/", PlainTextResponse(SECRET))])
    inside.state.studio = SimpleNamespace(folder=folder, surveys=SimpleNamespace(note_progress=progressed))
    app, sent = Gate(inside, "token", is_local=False), []
    scope: Scope = {
        "type": kind, "method": "GET" if form is None else "POST", "path": path, "raw_path": path.encode(),
        "root_path": "", "query_string": b"",
        "headers": [(b"host", b"studio"), (b"origin", b"http://studio")], "scheme": "http", "http_version": "1.1",
        "server": ("studio", 80),
    }  # fmt: skip

    async def receive() -> Message:
        return {"type": "websocket.connect"} if kind == "websocket" else {"type": "http.request", "body": form or b""}

    async def send(message: Message) -> None:
        sent.append(message)

    asyncio.run(app(scope, receive, send))
    if kind == "websocket":
        return sent[0]["code"], ""
    return sent[0]["status"], b"".join(message.get("body", b"") for message in sent[1:]).decode()


@pytest.fixture
def token(folder: Folder, tmp_path: Path) -> str:
    """Token of a participant of the survey `strokes`."""
    path = folder.of("surveys", "strokes")
    build(path, "Whose strokes?", *sources(tmp_path / "sources"))
    return Answers(path).mint(1)[0]


def test_a_participant_finds_their_page_and_its_looks(folder: Folder, token: str) -> None:
    status, page = answered(folder, f"/survey/strokes/{token}")
    assert (status, "Whose strokes?" in page) == (200, True)
    assert 'href="/survey/strokes/survey.css"' in page
    assert answered(folder, "/survey/strokes/survey.css")[0] == 200


@pytest.mark.parametrize(
    "path",
    ["/survey/", "/survey//", "/survey/strokes", "/survey/strokes/", "/survey/none/x", "/survey/strokes/survey.json",
     "/survey/strokes/answers.sqlite", "/survey/strokes/hand-1.png", "/survey/../", "/survey/../stop",
     "/survey/strokes/../../picture/pictures/ann/small.jpg", "/survey/../hands/x", "/survey/./strokes/x",
     "/survey/_nicegui/x", "/survey/strokes/\0", "/survey/" + "a" * 500, "/survey/strokes\\..\\..\\x"],
)  # fmt: skip
def test_participants_reach_nothing_but_their_own_pages(folder: Folder, token: str, path: str) -> None:
    status, body = answered(folder, path)
    assert status == 404
    assert SECRET not in body
    assert token not in body


@pytest.mark.parametrize("rest", ["", "/", "/nobody", "/nobody/picture/0", "/a/b/c", "/survey.css", "/icon.svg"])
@pytest.mark.parametrize("form", [None, b"", b"begin=1", b"x"])
def test_nobody_learns_which_surveys_there_are(folder: Folder, token: str, rest: str, form: bytes | None) -> None:
    assert token
    known, unknown = (answered(folder, f"/survey/{name}{rest}", form=form) for name in ("strokes", "nothing"))
    assert (known[0], known[1].replace("strokes", "")) == (unknown[0], unknown[1].replace("nothing", ""))


def test_pages_are_told_of_what_was_taken_and_of_nothing_else(folder: Folder, token: str) -> None:
    told: list[bytes] = []
    early, begin, answer = b"number=0&chosen=B", b"begin=1", b"number=0&chosen=A"
    for_nothing = b"number=0", b"number=5&chosen=A", b"number=0&chosen=?", b""
    forms: tuple[bytes, ...] = (early, begin, begin, *for_nothing, answer, answer)
    for form in forms:
        for whose in ("nobody", token):
            answered(folder, f"/survey/strokes/{whose}", form=form, progressed=partial(told.append, form))
    assert told == [begin, answer]


def test_many_answers_are_one_refresh_and_all_who_wait_share_one_result(folder: Folder, token: str) -> None:
    async def live() -> tuple[int, bool]:
        desk, refreshed = Desk(), asyncio.Event()
        surveys = Surveys(folder, desk)
        times: list[int] = []
        surveys.changed.subscribe(lambda: times.append(1))
        surveys.changed.subscribe(refreshed.set)
        try:
            for _ in range(5):
                surveys.note_progress()
            first, second, _ = await asyncio.gather(
                surveys.report("strokes"), surveys.report("strokes"), asyncio.wait_for(refreshed.wait(), 60)
            )
            return len(times), first is second
        finally:
            desk.close()

    assert asyncio.run(live()) == (1, True)


@pytest.mark.parametrize("path", ["/survey", "/", "/surveys/strokes", "/picture/pictures/ann/small.jpg"])
def test_participants_do_not_reach_the_studio(folder: Folder, path: str) -> None:
    status, body = answered(folder, path)
    assert status == 403
    assert "with its token" in body


def test_no_socket_opens_below_the_survey(folder: Folder, token: str) -> None:
    for path in ("/survey/", "/survey/_nicegui_ws/socket.io/", f"/survey/strokes/{token}"):
        assert answered(folder, path, "websocket") == (1008, "")
