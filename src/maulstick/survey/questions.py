"""Questions of one participant: in random order, with random sides, and the same whenever they come back."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Final, Literal

from maulstick.survey.questionnaire import Match, Opinions, Survey

Kind = Literal["match", "opinion"]

SAME_HAND: Final = "same hand"
"""Key of the question of the matching questionnaire."""

OPINIONS: Final = {
    "human": "Which drawing looks more like it was drawn by a human (rather than a robot)?",
    "better": "Which drawing looks better overall?",
    "reference": "Which drawing better matches the reference image?",
    "artistic": "Which drawing is more artistic?",
    "abstract": "Which drawing is more abstract?",
}
"""Questions asked about each pair of drawings, by their keys. Source: Spline-FRIDA, table of opinions."""


@dataclass(frozen=True)
class Choice:
    """Drawing that can be chosen. name: of the hand or the system that it stands for."""

    name: str
    picture: Path


@dataclass(frozen=True)
class Question:
    """Question of a participant.

    asks: `SAME_HAND`, or one of `OPINIONS`.  about: the hand, or the file of the picture, that it is asked about.
    reference: picture that the choices are compared with.  choices: in the order in which they are shown.
    """

    kind: Kind
    asks: str
    about: str
    reference: Path
    choices: tuple[Choice, ...]


def questions(survey: Survey, seed: int) -> tuple[Question, ...]:
    """Return all questions of the participant with this seed: first those that match hands, then the opinions."""
    rng = Random(seed)
    matches = () if survey.match is None else _matches(survey.match, rng)
    opinions = () if survey.opinions is None else _opinions(survey.opinions, rng)
    return (*matches, *opinions)


def _matches(match: Match, rng: Random) -> Iterator[Question]:
    """Yield questions with a random hand beside one motif in the style of every hand: a row of the paper's figure."""
    for hand in rng.sample(match.hands, match.asked):
        motif = rng.randrange(len(hand.by_machine))
        choices = tuple(Choice(each.name, each.by_machine[motif]) for each in match.hands)
        yield Question("match", SAME_HAND, hand.name, hand.by_hand, tuple(rng.sample(choices, len(choices))))


def _opinions(opinions: Opinions, rng: Random) -> Iterator[Question]:
    """Yield the questions pair by pair; the sides of a pair stay, or one would look for what changed."""
    for pair in rng.sample(opinions.pairs, opinions.asked):
        looks = [Choice(system, look) for system, look in zip(opinions.systems, pair.looks, strict=True)]
        sides = tuple(rng.sample(looks, len(looks)))
        for asks in rng.sample(list(OPINIONS), len(OPINIONS)):
            yield Question("opinion", asks, pair.reference.name, pair.reference, sides)
