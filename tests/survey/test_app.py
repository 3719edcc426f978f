import json
import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from starlette.applications import Starlette
from starlette.routing import Mount

from maulstick.survey.answers import Answers
from maulstick.survey.app import participants
from maulstick.survey.questionnaire import Match, build, read_survey
from maulstick.survey.questions import Question, questions
from tests.survey.conftest import NAMES, SYSTEMS, Server, sources


@pytest.fixture
def token(folder: Path) -> str:
    """Token of a participant who has not begun."""
    return Answers(folder).mint(1)[0]


@pytest.fixture
def begun(folder: Path, token: str) -> str:
    """Token of a participant who has begun."""
    Answers(folder).begin(token)
    return token


def asked_of(folder: Path, token: str) -> tuple[Question, ...]:
    person = Answers(folder).participant(token)
    assert person is not None
    return questions(read_survey(folder), person.seed)


def pixels(folder: Path, picture: Path) -> np.ndarray:
    with Image.open(folder / picture) as image:
        return np.array(image)


def test_a_participant_begins_answers_everything_and_is_thanked(server: Server, folder: Path, token: str) -> None:
    page = server.get(f"/{token}")
    assert page.status == 200
    assert "answer 7 questions" in page.text
    moved = server.post(f"/{token}", begin="yes")
    assert (moved.status, moved.headers["Location"]) == (303, f"/{token}")
    for number in range(7):
        assert f"Question {number + 1} of 7" in server.get(f"/{token}").text
        assert server.post(f"/{token}", number=number, chosen="B").status == 303
    assert "Thank you!" in server.get(f"/{token}").text
    chosen = [answer.chosen for answer in Answers(folder).all()]
    assert chosen == [question.choices[1].name for question in asked_of(folder, token)]


def test_whoever_has_finished_is_thanked_although_the_survey_asks_more_by_now(
    server: Server, folder: Path, begun: str
) -> None:
    for number in range(7):
        server.post(f"/{begun}", number=number, chosen="B")
    survey = json.loads((folder / "survey.json").read_text())
    survey["match"]["asked"] = 3
    (folder / "survey.json").write_text(json.dumps(survey))
    server.app = participants(folder, lambda: None)
    assert "answer 8 questions" in server.get(f"/{Answers(folder).mint(1)[0]}").text
    assert "Thank you!" in server.get(f"/{begun}").text


def test_a_page_is_the_same_when_it_is_loaded_again(server: Server, begun: str) -> None:
    assert server.get(f"/{begun}").body == server.get(f"/{begun}").body


def test_pictures_are_those_of_the_present_question_by_position(server: Server, folder: Path, begun: str) -> None:
    for number, question in enumerate(asked_of(folder, begun)):
        shown = (question.reference, *(choice.picture for choice in question.choices))
        for position, picture in enumerate(shown):
            served_one = server.get(f"/{begun}/picture/{position}").pixels
            np.testing.assert_array_equal(served_one, pixels(folder, picture))
        assert server.get(f"/{begun}/picture/{len(shown)}").status == 404
        server.post(f"/{begun}", number=number, chosen="A")
    assert server.get(f"/{begun}/picture/0").status == 404


def test_a_page_gives_no_name_of_a_hand_a_system_or_a_file_away(server: Server, folder: Path, begun: str) -> None:
    for number, question in enumerate(asked_of(folder, begun)):
        page = server.get(f"/{begun}").text
        names = [question.reference.name, *(choice.picture.name for choice in question.choices)]
        words = set(re.findall(r"[\w.-]+", page))
        assert not words & {*names, *NAMES, *SYSTEMS}
        server.post(f"/{begun}", number=number, chosen="A")


def test_there_are_no_pictures_before_the_beginning(server: Server, token: str) -> None:
    assert server.get(f"/{token}/picture/0").status == 404


def test_one_participants_link_does_not_lead_to_anothers_pictures(server: Server, folder: Path, begun: str) -> None:
    (other,) = Answers(folder).mint(1)
    assert server.get(f"/{begun}/picture/../../{other}/picture/0").status == 404
    assert server.get(f"/{other}/picture/0").status == 404
    assert server.get(f"/{begun}/picture/0").status == 200


def test_a_link_that_is_not_known_gets_a_kind_sentence(server: Server) -> None:
    for path in ("/", "/AAAAAAAAAAAAAAAAAAAAAA", "/x/picture/0", "/favicon.ico", "/docs", "/%00", "/a'%20OR%201=1"):
        page = server.get(path)
        assert page.status == 404
        assert "Please check the link that you were given" in page.text
    assert server.post("/AAAAAAAAAAAAAAAAAAAAAA", begin="yes").status == 404


@pytest.mark.parametrize(
    "way",
    [
        "survey.json", "../survey.json", "..%2fsurvey.json", "%2e%2e/survey.json", "%2e%2e%2fsurvey.json",
        "..%5csurvey.json", "....//survey.json", "%252e%252e%252fsurvey.json", "answers.sqlite", "hand-1.png",
        "/etc/passwd", "%2fetc%2fpasswd", "-1", "0x0", "0.png", "0%00", "00000", "9" * 5000, "%D9%A1", "",
    ],
)  # fmt: skip
def test_no_path_leads_to_a_file(server: Server, begun: str, way: str) -> None:
    for path in (f"/{way}", f"/{begun}/{way}", f"/{begun}/picture/{way}"):
        page = server.get(path)
        assert page.status == 404, path
        assert b"schema_version" not in page.body
        assert not page.body.startswith((b"SQLite", b"\x89PNG", b"root:"))


@pytest.mark.parametrize(
    "origin", ["https://elsewhere.example", "null", "http://127.0.0.1", "", "http://elsewhere.example@127.0.0.1"]
)
def test_a_form_of_another_site_changes_nothing(server: Server, folder: Path, begun: str, origin: str) -> None:
    page = server.ask("POST", f"/{begun}", "number=0&chosen=A", Origin=origin)
    assert page.status == 403
    assert "came from another site" in page.text
    assert Answers(folder).all() == []


def test_a_browser_that_tells_no_origin_may_answer(server: Server, folder: Path, begun: str) -> None:
    assert server.ask("POST", f"/{begun}", "number=0&chosen=A").status == 303
    assert len(Answers(folder).all()) == 1


@pytest.mark.parametrize("chunked", [False, True])
def test_a_form_that_is_too_large_is_refused(server: Server, folder: Path, begun: str, chunked: bool) -> None:
    body = b"number=0&chosen=" + b"A" * 5000
    headers = {"Transfer-Encoding": "chunked"} if chunked else {}
    content = b"%x\r\n%s\r\n0\r\n\r\n" % (len(body), body) if chunked else body
    assert server.ask("POST", f"/{begun}", content, **headers).status == 413
    assert Answers(folder).all() == []


@pytest.mark.parametrize(
    "body",
    [
        "", "chosen=A", "number=0&chosen=A&more=1", "number=0&other=A", "number=0&number=0", "begin=yes&number=0",
        "number=zero&chosen=A", "number=-1&chosen=A", "number=%C2%B2&chosen=A", "number=0&chosen=Z",
        "number=0&chosen=Ada", "number=0&chosen=AB", "number=0&chosen", b"number=0&chosen=\xff", "number=0&chosen=%FF",
        '{"number": 0}',
    ],
)  # fmt: skip
def test_a_form_that_is_not_ours_is_refused(server: Server, folder: Path, begun: str, body: str | bytes) -> None:
    page = server.ask("POST", f"/{begun}", body)
    assert page.status == 400
    assert "could not be understood" in page.text
    assert Answers(folder).all() == []


def test_choosing_nothing_is_told_and_asked_again(server: Server, folder: Path, begun: str) -> None:
    page = server.post(f"/{begun}", number=0)
    assert page.status == 200
    assert "Please choose one of the drawings first." in page.text
    assert "Question 1 of 7" in page.text
    assert Answers(folder).all() == []


def test_submitting_twice_or_after_going_back_changes_nothing(server: Server, folder: Path, begun: str) -> None:
    first = asked_of(folder, begun)[0]
    server.post(f"/{begun}", number=0, chosen="A")
    assert server.post(f"/{begun}", number=0, chosen="B").status == 303
    assert server.post(f"/{begun}", number=5, chosen="A").status == 303
    (kept,) = Answers(folder).all()
    assert (kept.number, kept.chosen) == (0, first.choices[0].name)
    assert "Question 2 of 7" in server.get(f"/{begun}").text


def test_submitting_many_times_at_once_keeps_one_answer(server: Server, folder: Path, begun: str) -> None:
    with ThreadPoolExecutor(8) as threads:
        list(threads.map(lambda letter: server.post(f"/{begun}", number=0, chosen=letter), "ABCABCAB"))
    assert len(Answers(folder).all()) == 1


def test_nothing_is_answered_before_the_beginning(server: Server, folder: Path, token: str) -> None:
    assert server.post(f"/{token}", number=0, chosen="A").status == 303
    assert Answers(folder).all() == []


@pytest.mark.parametrize(
    "ask",
    [
        lambda server, token: server.get(f"/{token}"),
        lambda server, token: server.get(f"/{token}/picture/0"),
        lambda server, token: server.post(f"/{token}", number=0, chosen="A"),
        lambda server, _: server.get("/survey.css"),
        lambda server, _: server.get("/icon.svg"),
        lambda server, _: server.get("/none"),
        lambda server, token: server.ask("DELETE", f"/{token}"),
        lambda server, token: server.ask("POST", f"/{token}", "x"),
    ],
)
def test_every_answer_keeps_other_sites_out(server: Server, begun: str, ask: Callable[..., object]) -> None:
    headers = ask(server, begun).headers  # type: ignore[attr-defined]
    policy = headers["Content-Security-Policy"].split("; ")
    assert {"default-src 'none'", "form-action 'self'", "frame-ancestors 'none'", "base-uri 'none'"} <= set(policy)
    assert not any("unsafe" in rule or "*" in rule for rule in policy)
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cache-Control"] == "no-store"
    assert headers["Referrer-Policy"] == "same-origin"
    assert headers["Set-Cookie"] is None


def test_a_script_in_a_title_or_a_name_stays_text(server: Server, tmp_path: Path) -> None:
    script = "<script>alert('x')</script>\"'"
    match, opinions = sources(tmp_path / "others")
    match = Match(hands=tuple(hand.model_copy(update={"name": hand.name + script}) for hand in match.hands), asked=1)
    build(tmp_path / "other", script, match, opinions.model_copy(update={"systems": (script, "<b>new")}))
    (token,) = Answers(tmp_path / "other").mint(1)
    server.app = participants(tmp_path / "other", lambda: None)
    pages = [server.get(f"/{token}").text]
    server.post(f"/{token}", begin="yes")
    for number in range(6):
        pages.append(server.get(f"/{token}").text)
        server.post(f"/{token}", number=number, chosen="A")
    assert all("&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt;" in page for page in pages)
    assert not any("<script" in page or "<b>" in page for page in pages)


def test_a_survey_that_is_part_of_another_site_links_to_itself(server: Server, begun: str) -> None:
    server.app = Starlette(routes=[Mount("/survey/own", server.app)])
    page = server.get(f"/survey/own/{begun}").text
    links = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(links) == 2 + 4 + 4
    for link in links:
        assert link.startswith("/survey/own/")
        assert server.get(link).status == 200
    moved = server.post(f"/survey/own/{begun}", number=0, chosen="A")
    assert moved.headers["Location"] == f"/survey/own/{begun}"
    assert server.get(f"/survey/own/{begun}/").status == 404


def test_a_broken_database_is_a_kind_sentence_for_a_participant_and_a_clear_one_for_the_owner(
    server: Server, folder: Path, begun: str, caplog: pytest.LogCaptureFixture
) -> None:
    (folder / "answers.sqlite").write_bytes(b"not a database, but long enough to be looked at as one" * 30)
    page = server.get(f"/{begun}")
    assert page.status == 503
    assert "Please try again later" in page.text
    assert str(folder) not in page.text
    assert "is not a database of answers" in caplog.text


def test_a_question_that_is_gone_is_not_asked(server: Server, folder: Path, begun: str) -> None:
    for number in range(2):
        server.post(f"/{begun}", number=number, chosen="A")
    record = json.loads((folder / "survey.json").read_text())
    del record["opinions"]
    (folder / "survey.json").write_text(json.dumps(record))
    server.app = participants(folder, lambda: None)
    assert "Thank you!" in server.get(f"/{begun}").text
    assert server.post(f"/{begun}", number=2, chosen="A").status == 303
    assert len(Answers(folder).all()) == 2
