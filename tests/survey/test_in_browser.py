"""Survey as participants take it, in a real browser, by keyboard alone."""

import shutil
from pathlib import Path

import pytest

from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import read_survey
from maulstick.survey.questions import OPINIONS, questions
from maulstick.survey.results import Opinion, results
from tests.survey.conftest import SYSTEMS, Server

CHROMIUM = shutil.which("chromium")


def test_two_people_answer_everything_by_keyboard_and_the_tables_show_it(folder: Path, server: Server) -> None:
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    playwright = pytest.importorskip("playwright.sync_api")
    tokens = Answers(folder).mint(2)
    complaints: list[str] = []
    with playwright.sync_playwright() as player:
        browser = player.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        for token, likes in zip(tokens, SYSTEMS, strict=True):
            page = browser.new_context().new_page()
            page.on("console", lambda message: complaints.append(message.text))
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.goto(f"{server.address}/{token}")
            page.keyboard.press("Tab")
            page.keyboard.press("Enter")
            person = Answers(folder).participant(token)
            assert person is not None
            for number, question in enumerate(questions(read_survey(folder), person.seed)):
                page.get_by_text(f"Question {number + 1} of 7").wait_for()
                page.wait_for_load_state()
                assert page.evaluate("[...document.images].every(image => image.naturalWidth > 0)")
                wanted = question.about if question.kind == "match" else likes
                page.keyboard.press("Tab")  # to the link that shows the reference larger
                page.keyboard.press("Tab")
                page.keyboard.press("Space")
                for _ in range([choice.name for choice in question.choices].index(wanted)):
                    page.keyboard.press("ArrowDown")
                page.keyboard.press("Enter")
            page.get_by_text("Thank you!").wait_for()
        browser.close()
    assert complaints == []
    found = results(folder)
    assert (found.begun, found.finished) == (2, 2)
    assert found.matching is not None
    assert found.matching.all_right.count == found.matching.all_right.of == 4
    assert found.opinions == tuple(Opinion(asks, (1, 1)) for asks in OPINIONS)
