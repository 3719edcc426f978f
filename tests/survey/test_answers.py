import re
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest

from maulstick.errors import InputError, OutputError
from maulstick.survey.answers import Answers, Participant
from maulstick.survey.questions import questions
from tests.survey.conftest import named

QUESTIONS = questions(named(), 7)


def answer(store: Answers, token: str, number: int, choice: int = 0) -> bool:
    question = QUESTIONS[number]
    return store.answer(token, number, question, question.choices[choice].name, last=number + 1 == len(QUESTIONS))


@pytest.fixture
def store(tmp_path: Path) -> Answers:
    return Answers(tmp_path)


def test_links_are_secret_and_nobody_shares_one(store: Answers) -> None:
    tokens = [*store.mint(20), *store.mint(5)]
    assert len(set(tokens)) == 25
    assert all(re.fullmatch(r"[\w-]{22}", token) for token in tokens)
    assert [person.token for person in store.participants()] == tokens
    assert len({person.seed for person in store.participants()}) == 25


@pytest.mark.parametrize("count", [0, -1, 1001])
def test_a_number_of_links_is_sensible(store: Answers, count: int) -> None:
    with pytest.raises(InputError, match=f"the number of new links is {count}; it must be from 1 to 1000"):
        store.mint(count)


def test_answers_survive_closing_and_opening_again(store: Answers, tmp_path: Path) -> None:
    (token,) = store.mint(1)
    store.begin(token)
    for number in range(len(QUESTIONS)):
        assert answer(store, token, number, choice=1)
    again = Answers(tmp_path)
    person = again.participant(token)
    assert person == Participant(1, token, person.seed if person else 0, True, True, len(QUESTIONS))
    kept = again.all()
    assert [each.number for each in kept] == list(range(len(QUESTIONS)))
    for each, question in zip(kept, QUESTIONS, strict=True):
        assert (each.kind, each.asks, each.shown.about) == (question.kind, question.asks, question.about)
        assert each.shown.choices == tuple(choice.name for choice in question.choices)
        assert each.shown.pictures[0] == question.reference.name
        assert each.shown.pictures[1:] == tuple(choice.picture.name for choice in question.choices)
        assert each.chosen == question.choices[1].name
        assert each.seconds >= 0


def test_an_answer_counts_once_in_order_and_only_of_one_who_began(store: Answers) -> None:
    (token,) = store.mint(1)
    assert not answer(store, token, 0)
    store.begin(token)
    assert not answer(store, token, 1)
    assert answer(store, token, 0, choice=0)
    assert not answer(store, token, 0, choice=1)
    assert not answer(store, "nobody", 0)
    (kept,) = store.all()
    assert kept.chosen == QUESTIONS[0].choices[0].name


def test_nothing_is_taken_after_the_last_answer(store: Answers) -> None:
    (token,) = store.mint(1)
    store.begin(token)
    assert store.answer(token, 0, QUESTIONS[0], QUESTIONS[0].choices[0].name, last=True)
    assert not answer(store, token, 1)


def test_seconds_add_up_to_the_time_since_the_beginning(store: Answers) -> None:
    (token,) = store.mint(1)
    store.begin(token)
    with closing(sqlite3.connect(store.path)) as database, database:
        database.execute("UPDATE participants SET begun = begun - 100")
    answer(store, token, 0)
    answer(store, token, 1)
    first, second = store.all()
    assert first.seconds >= 100 > second.seconds


def test_beginning_twice_changes_nothing(store: Answers) -> None:
    (token,) = store.mint(1)
    store.begin(token)
    with closing(sqlite3.connect(store.path)) as database:
        begun = database.execute("SELECT begun FROM participants").fetchall()
        store.begin(token)
        assert database.execute("SELECT begun FROM participants").fetchall() == begun


def test_many_answer_at_once_from_threads_and_each_answer_is_kept_once(tmp_path: Path) -> None:
    tokens = Answers(tmp_path).mint(4)

    def one(token: str) -> int:
        store = Answers(tmp_path)
        store.begin(token)
        return sum(answer(store, token, number) for number in range(len(QUESTIONS)))

    with ThreadPoolExecutor(8) as threads:  # everyone submits everything twice, at the same time
        kept = list(threads.map(one, tokens * 2))
    assert sum(kept) == len(tokens) * len(QUESTIONS)
    assert len(Answers(tmp_path).all()) == len(tokens) * len(QUESTIONS)
    assert all(person.finished for person in Answers(tmp_path).participants())


def test_a_file_that_is_no_database_is_named(store: Answers) -> None:
    store.path.write_bytes(b"not a database, but long enough to be looked at as one" * 30)
    with pytest.raises(InputError, match=r"answers\.sqlite is not a database of answers"):
        store.participants()


def test_a_newer_database_asks_for_a_newer_maulstick(store: Answers) -> None:
    store.mint(1)
    with closing(sqlite3.connect(store.path)) as database:
        database.execute("PRAGMA user_version = 2")
    with pytest.raises(InputError, match="has version 2, and this Maulstick knows 1; update Maulstick"):
        store.participants()


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"cannot use .*answers\.sqlite"):
        Answers(tmp_path / "none").mint(1)


def test_answers_that_were_tampered_with_are_refused(store: Answers) -> None:
    (token,) = store.mint(1)
    store.begin(token)
    answer(store, token, 0)
    with closing(sqlite3.connect(store.path)) as database, database:
        database.execute("UPDATE answers SET shown = '{}'")
    with pytest.raises(InputError, match="does not hold answers of a survey"):
        store.all()
