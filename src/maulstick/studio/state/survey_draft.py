"""Draft of a survey, parts of which may still be missing."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from maulstick.errors import InputError, validation_fault
from maulstick.studio.state.typed_numbers import whole_number
from maulstick.survey.questionnaire import Match, Opinions, Pair, SurveyHand
from maulstick.survey.questions import SAME_HAND

_ASKED = "the number of {} that each person is asked about"

_Part = TypeVar("_Part", bound=BaseModel)


@dataclass
class HandDraft:
    """Draft of a hand: drawings by the person and in the person's style, as keys of `Surveys.drawings`."""

    name: str = ""
    by_hand: str | None = None
    by_machine: list[str] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        """Whether nothing is filled in."""
        return not (self.name.strip() or self.by_hand or self.by_machine)


@dataclass
class PairDraft:
    """Draft of a comparison: a picture and two drawings of it, as keys of `Surveys.drawings`."""

    reference: str | None = None
    first: str | None = None
    second: str | None = None

    @property
    def is_empty(self) -> bool:
        """Whether nothing is filled in."""
        return not (self.reference or self.first or self.second)


@dataclass
class Draft:
    """Draft of a survey. Empty rows do not count; a questionnaire without rows is left out.

    question: what is asked about the hands, see `Match`.  hands_asked, pairs_asked: None where nothing is filled in.
    """

    title: str = ""
    question: str = SAME_HAND
    hands: list[HandDraft] = field(default_factory=lambda: [HandDraft(), HandDraft()])
    hands_asked: float | None = 1
    first_look: str = ""
    second_look: str = ""
    pairs: list[PairDraft] = field(default_factory=lambda: [PairDraft()])
    pairs_asked: float | None = 1

    def match(self, path_of: Callable[[str], Path]) -> Match | None:
        """Make the matching questionnaire. path_of: file of a drawing. Raises InputError where something is missing."""
        rows = [hand for hand in self.hands if not hand.is_empty]
        if not rows:
            return None
        hands = []
        for number, row in enumerate(rows, start=1):
            name = row.name.strip()
            if not name:
                raise InputError(f"hand {number} has no name; give it one, participants will not see it")
            if row.by_hand is None:
                raise InputError(f"{name} has no drawing by the person yet; choose one")
            if not row.by_machine:
                raise InputError(f"{name} has no drawing by the machine yet; choose at least one")
            machines = tuple(map(path_of, row.by_machine))
            hands.append(_made(SurveyHand, name=name, by_hand=path_of(row.by_hand), by_machine=machines))
        if len(hands) == 1:
            raise InputError(
                f"{hands[0].name} is the only hand; add another, so that there is something to choose from"
            )
        asked = whole_number(self.hands_asked, _ASKED.format("hands"), 1, len(hands))
        return _made(Match, question=self.question, hands=tuple(hands), asked=asked)

    def opinions(self, path_of: Callable[[str], Path]) -> Opinions | None:
        """Make the questionnaire of opinions. path_of: file of a drawing. Raises InputError where it is not whole."""
        rows = [pair for pair in self.pairs if not pair.is_empty]
        if not rows:
            return None
        looks = self.first_look.strip(), self.second_look.strip()
        if not all(looks):
            raise InputError("one of the two looks has no name yet; give it one, participants will not see it")
        if looks[0] == looks[1]:
            raise InputError("both looks have one name; give each its own")
        pairs = []
        for number, row in enumerate(rows, start=1):
            if row.reference is None or row.first is None or row.second is None:
                raise InputError(f"comparison {number} is not whole; choose a picture and a drawing in each look")
            drawn = path_of(row.first), path_of(row.second)
            pairs.append(_made(Pair, reference=path_of(row.reference), looks=drawn))
        asked = whole_number(self.pairs_asked, _ASKED.format("pictures"), 1, len(pairs))
        return _made(Opinions, systems=looks, pairs=tuple(pairs), asked=asked)


def _made(kind: type[_Part], **fields: object) -> _Part:
    try:
        return kind.model_validate(fields)
    except ValidationError as error:
        raise InputError(f"the survey cannot be made like this: {validation_fault(error)}") from error
