"""Questions of one participant: in random order, with random sides, and the same whenever they come back."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Final, Literal

from maulstick.survey.questionnaire import Match, Opinions, Survey

Kind = Literal["match", "opinion"]

SAME_HAND: Final = "same hand"
"""Key of the question which of the machine's drawings has the strokes of a drawing by a person."""

WHOSE_DRAWING: Final = "whose drawing"
"""Key of the question in which person's hand the machine's drawing is, beside a whole drawing by each."""

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

    asks: `SAME_HAND`, `WHOSE_DRAWING`, or one of `OPINIONS`.
    about: the hand, or the file of the picture, that it is asked about.
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
    """Yield questions about random hands, each about one motif.

    A drawing by a person stands beside the motif in the style of every hand, as in a row of the paper's figure; or the
    motif in one style beside a drawing by every person.
    """
    for hand in rng.sample(match.hands, match.asked):
        motif = rng.randrange(len(hand.by_machine))
        if match.question == WHOSE_DRAWING:
            reference = hand.by_machine[motif]
            choices = tuple(Choice(each.name, each.by_hand) for each in match.hands)
        else:
            reference = hand.by_hand
            choices = tuple(Choice(each.name, each.by_machine[motif]) for each in match.hands)
        yield Question("match", match.question, hand.name, reference, tuple(rng.sample(choices, len(choices))))


def _opinions(opinions: Opinions, rng: Random) -> Iterator[Question]:
    """Yield the questions pair by pair; the sides of a pair stay, or one would look for what changed."""
    for pair in rng.sample(opinions.pairs, opinions.asked):
        looks = [Choice(system, look) for system, look in zip(opinions.systems, pair.looks, strict=True)]
        sides = tuple(rng.sample(looks, len(looks)))
        for asks in rng.sample(list(OPINIONS), len(OPINIONS)):
            yield Question("opinion", asks, pair.reference.name, pair.reference, sides)
