from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from maulstick.survey.questions import OPINIONS, SAME_HAND, WHOSE_DRAWING, questions
from tests.support.tolerances import SURVEY_BALANCE
from tests.survey.conftest import named

SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS)
def test_the_same_seed_gives_the_same_questions(seed: int) -> None:
    assert questions(named(), seed) == questions(named(), seed)


@given(SEEDS, st.integers(2, 10), st.integers(1, 4), st.integers(1, 2))
def test_every_match_shows_one_motif_in_the_style_of_every_hand(seed: int, hands: int, motifs: int, asked: int) -> None:
    survey = named(hands=hands, motifs=motifs, asked=asked)
    assert survey.match is not None
    matches = [question for question in questions(survey, seed) if question.kind == "match"]
    assert len({question.about for question in matches}) == len(matches) == asked
    for question in matches:
        assert question.asks == SAME_HAND
        assert sorted(choice.name for choice in question.choices) == sorted(hand.name for hand in survey.match.hands)
        (motif,) = {choice.picture.stem.partition("-m")[2] for choice in question.choices}
        for choice in question.choices:
            assert choice.picture.name == f"h{choice.name.removeprefix('hand ')}-m{motif}.png"
        assert question.reference.name == f"h{question.about.removeprefix('hand ')}.png"


@given(SEEDS, st.integers(2, 10), st.integers(1, 4), st.integers(1, 2))
def test_every_drawing_of_unknown_hand_stands_beside_a_drawing_by_each_person(
    seed: int, hands: int, motifs: int, asked: int
) -> None:
    survey = named(hands=hands, motifs=motifs, asked=asked)
    assert survey.match is not None
    match = survey.match.model_copy(update={"question": WHOSE_DRAWING})
    drawn = [each for each in questions(survey.model_copy(update={"match": match}), seed) if each.kind == "match"]
    assert len({question.about for question in drawn}) == len(drawn) == asked
    for question in drawn:
        assert question.asks == WHOSE_DRAWING
        assert question.reference.name.partition("-m")[0] == f"h{question.about.removeprefix('hand ')}"
        assert sorted(choice.name for choice in question.choices) == sorted(hand.name for hand in match.hands)
        for choice in question.choices:
            assert choice.picture.name == f"h{choice.name.removeprefix('hand ')}.png"


@given(SEEDS, st.integers(2, 6), st.integers(1, 2))
def test_every_opinion_is_asked_once_of_each_pair_whose_sides_stay(seed: int, pairs: int, asked: int) -> None:
    opinions = [q for q in questions(named(pairs=pairs, asked=asked), seed) if q.kind == "opinion"]
    assert len(opinions) == asked * len(OPINIONS)
    for first in range(0, len(opinions), len(OPINIONS)):
        block = opinions[first : first + len(OPINIONS)]
        assert sorted(question.asks for question in block) == sorted(OPINIONS)
        assert len({(question.about, question.choices) for question in block}) == 1
        for choice in block[0].choices:
            assert choice.picture.name == block[0].reference.name.replace(".png", f"-{choice.name}.png")
    assert len({question.about for question in opinions}) == asked


@given(SEEDS)
def test_hands_are_matched_before_opinions_are_asked(seed: int) -> None:
    kinds = [question.kind for question in questions(named(), seed)]
    assert kinds == ["match"] * 2 + ["opinion"] * 10


def test_sides_places_hands_motifs_and_order_are_all_as_often_as_each_other() -> None:
    drawn = [questions(named(asked=1), seed) for seed in range(2000)]
    matches, opinions = [asked[0] for asked in drawn], [asked[1] for asked in drawn]
    right = Counter([choice.name for choice in match.choices].index(match.about) for match in matches)
    for counted, of in (
        (right, 5),
        (Counter(match.about for match in matches), 5),
        (Counter(match.choices[0].picture.stem.partition("-m")[2] for match in matches), 3),
        (Counter(opinion.choices[0].name for opinion in opinions), 2),
        (Counter(opinion.about for opinion in opinions), 4),
        (Counter(opinion.asks for opinion in opinions), 5),
    ):
        assert len(counted) == of
        assert all(abs(count / len(drawn) - 1 / of) < SURVEY_BALANCE for count in counted.values())
