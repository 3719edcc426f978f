import csv
import io
from pathlib import Path

import numpy as np
import pytest

from maulstick.errors import InputError
from maulstick.survey.answers import Answer, Answers, Shown
from maulstick.survey.questionnaire import read_survey
from maulstick.survey.questions import OPINIONS, questions
from maulstick.survey.results import (
    Matching,
    Opinion,
    Results,
    Tally,
    answers_csv,
    matching_rows,
    opinions_rows,
    results,
    right_rows,
)
from tests.support.tolerances import FOUR_DIGITS
from tests.survey.conftest import NAMES, SYSTEMS


def take_part(folder: Path, hands: dict[str, str], system: str) -> None:
    """A participant who takes each hand for another, and likes one system."""
    survey, store = read_survey(folder), Answers(folder)
    (token,) = store.mint(1)
    store.begin(token)
    person = store.participant(token)
    assert person is not None
    asked = questions(survey, person.seed)
    for number, question in enumerate(asked):
        chosen = hands[question.about] if question.kind == "match" else system
        assert store.answer(token, number, question, chosen, last=number + 1 == len(asked))


def test_the_confusion_matrix_has_a_row_for_who_drew_and_a_column_for_who_was_chosen(folder: Path) -> None:
    mistaken = {"Ada": "Ada", "Bo": "Cy", "Cy": "Cy"}
    for _ in range(6):
        take_part(folder, mistaken, "Splines")
    found = results(folder).matching
    assert found is not None
    assert found.hands == NAMES
    asked = found.counts.sum(axis=1)
    assert asked.sum() == 12
    np.testing.assert_array_equal(found.counts, [[asked[0], 0, 0], [0, 0, asked[1]], [0, 0, asked[2]]])
    assert found.all_right == Tally(int(asked[0] + asked[2]), 12, 1 / 3)
    assert found.right[1] == Tally(0, int(asked[1]), 1 / 3)


def test_opinions_are_counted_for_each_question_and_system(folder: Path) -> None:
    for system in ("Splines", "Splines", "Curves"):
        take_part(folder, dict(zip(NAMES, NAMES, strict=True)), system)
    found = results(folder)
    assert found.systems == SYSTEMS
    assert found.opinions == tuple(Opinion(asks, (1, 2)) for asks in OPINIONS)
    assert (found.links, found.begun, found.finished) == (3, 3, 3)


def test_a_survey_without_answers_has_results(folder: Path) -> None:
    Answers(folder).mint(2)
    found = results(folder)
    assert isinstance(found, Results)
    assert (found.links, found.begun, found.finished) == (2, 0, 0)
    assert found.matching is not None
    assert matching_rows(found.matching).rows[0] == ("Ada", "-", "-", "-")
    assert right_rows(found.matching).rows[-1] == ("all hands", "0 of 0", "-", "-", "-", "33%")
    assert opinions_rows(SYSTEMS, found.opinions).rows[0][1:] == ("0", "0", "-", "-", "-")


def test_answers_of_another_survey_are_refused(folder: Path) -> None:
    take_part(folder, {"Ada": "Ada", "Bo": "Cy", "Cy": "Cy"}, "Splines")
    record = folder / "survey.json"
    record.write_text(record.read_text().replace('"Splines"', '"Waves"'))
    with pytest.raises(InputError, match=r"an answer names the system 'Splines', which survey\.json does not"):
        results(folder)


# Newcombe, Two-sided confidence intervals for the single proportion, 1998, table I, method 3.
@pytest.mark.parametrize(
    ("count", "of", "low", "high"),
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_intervals_are_those_of_the_literature(count: int, of: int, low: float, high: float) -> None:
    assert Tally(count, of, 0.5).interval == pytest.approx((low, high), abs=FOUR_DIGITS)


def test_probabilities_are_those_that_one_counts_by_hand() -> None:
    assert Tally(8, 10, 1 / 2).p == pytest.approx(2 * (45 + 10 + 1) / 2**10)
    assert Tally(5, 5, 1 / 5).p == pytest.approx(1 / 5**5)
    assert Tally(5, 10, 1 / 2).p == 1.0


def test_no_answers_tell_nothing() -> None:
    none = Tally(0, 0, 1 / 5)
    assert np.isnan(none.share)
    assert none.interval == (0.0, 1.0)
    assert none.p == 1.0


def test_the_rows_tell_counts_shares_intervals_and_probabilities() -> None:
    matching = Matching(("Ada", "Bo"), np.array([[8, 2], [0, 0]]))
    assert matching_rows(matching).heads == ("drawn by", "Ada", "Bo")
    assert matching_rows(matching).rows == (("Ada", "8 (80%)", "2 (20%)"), ("Bo", "-", "-"))
    assert right_rows(matching).heads == ("drawn by", "right", "share", "95 % interval", "p", "by guessing")
    assert right_rows(matching).rows == (
        ("Ada", "8 of 10", "80%", "49% to 94%", "0.109", "50%"),
        ("Bo", "0 of 0", "-", "-", "-", "50%"),
        ("all hands", "8 of 10", "80%", "49% to 94%", "0.109", "50%"),
    )


def test_the_papers_table_of_opinions_is_told_as_it_is_printed_there() -> None:
    told = opinions_rows(("FRIDA", "Spline-FRIDA"), [Opinion("human", (27, 73)), Opinion("abstract", (40, 60))])
    assert told.heads == ("question", "FRIDA", "Spline-FRIDA", "share of FRIDA", "95 % interval", "p")
    assert told.rows[0][:4] == (OPINIONS["human"], "27", "73", "27%")
    assert told.rows[0][5] == "< 0.001"
    assert told.rows[1][5] == "0.057"


def test_the_csv_has_every_answer_and_no_link(folder: Path) -> None:
    take_part(folder, {"Ada": "Bo", "Bo": "Bo", "Cy": "Bo"}, "Curves")
    answers, (person,) = Answers(folder).all(), Answers(folder).participants()
    content = answers_csv(answers).decode()
    rows = list(csv.DictReader(io.StringIO(content)))
    assert [row["question"] for row in rows] == [str(number) for number in range(1, 8)]
    assert [row["chosen"] for row in rows] == ["Bo"] * 2 + ["Curves"] * 5
    assert set(rows[0]["shown"].split(" | ")) == set(NAMES)
    assert person.token not in content


def test_a_name_is_no_formula_in_a_spreadsheet() -> None:
    shown = Shown(about="=1+1", pictures=("a.png",), choices=("=1+1", "@x"))
    answer = Answer(
        participant=1, number=0, kind="match", asks="same hand", shown=shown, chosen="@x", seconds=2.0, moment=0.0
    )
    (row,) = csv.DictReader(io.StringIO(answers_csv([answer]).decode()))
    assert (row["about"], row["shown"], row["chosen"]) == ("'=1+1", "'=1+1 | @x", "'@x")
    assert row["moment"] == "1970-01-01T00:00:00+00:00"
