"""Surveys as participants take them, in a real browser, by keyboard alone."""

from pathlib import Path

import pytest

from maulstick.survey.answers import Answers
from maulstick.survey.app import participants
from maulstick.survey.questionnaire import read_survey
from maulstick.survey.questions import OPINIONS, questions
from maulstick.survey.results import Opinion, results, right_rows
from tests.support.chromium import chromium
from tests.support.whole_drawings import HANDS, build_of_whole_drawings
from tests.survey.conftest import SYSTEMS, Server


def test_two_people_answer_everything_by_keyboard_and_the_tables_show_it(folder: Path, server: Server) -> None:
    tokens = Answers(folder).mint(2)
    complaints: list[str] = []
    with chromium() as browser:
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
    assert complaints == []
    found = results(folder)
    assert (found.begun, found.finished) == (2, 2)
    assert found.matching is not None
    assert found.matching.all_right.count == found.matching.all_right.of == 4
    assert found.opinions == tuple(Opinion(asks, (1, 1)) for asks in OPINIONS)


@pytest.mark.filterwarnings("ignore:.* of the ink that the picture needs")
def test_people_say_whose_drawing_a_plan_is_beside_whole_drawings_by_all(running: Server, tmp_path: Path) -> None:
    folder = tmp_path / "survey"
    survey = build_of_whole_drawings(folder, tmp_path)
    tokens = Answers(folder).mint(3)
    running.app = participants(folder, lambda: None)
    complaints: list[str] = []
    with chromium() as browser:
        for token in tokens:
            page = browser.new_context().new_page()
            page.on("console", lambda message: complaints.append(message.text))
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.goto(f"{running.address}/{token}")
            page.get_by_text("in whose hand the machine drew").wait_for()
            page.get_by_role("button", name="Begin").click()
            page.get_by_role("heading", name="In whose hand is this drawing?").wait_for()
            page.get_by_role("img", name="Drawn by a machine").wait_for()
            page.wait_for_load_state()
            assert page.evaluate("[...document.images].map(image => image.naturalWidth > 100)") == [True] * 3
            person = Answers(folder).participant(token)
            assert person is not None
            (question,) = questions(survey, person.seed)
            taken_for = HANDS[0]  # by everybody, whosever it is
            letter = "AB"[[choice.name for choice in question.choices].index(taken_for)]
            page.get_by_role("radio", name=f"Drawing {letter}").check()
            page.get_by_role("button", name="Finish").click()
            page.get_by_text("Thank you!").wait_for()
    assert complaints == []
    found = results(folder).matching
    assert found is not None
    right = sum(answer.shown.about == HANDS[0] for answer in Answers(folder).all())
    assert right_rows(found).rows[-1][:2] == ("all hands", f"{right} of 3")
    assert right_rows(found).rows[-1][-1] == "50%"
