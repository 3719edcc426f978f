"""What came out of a survey: the paper's confusion matrix and table of opinions, with what chance would have done.

Intervals and probabilities take all answers for independent: strictly that holds where a participant was asked about
one hand and one pair, as in the paper.
"""

import csv
import io
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError
from maulstick.survey.answers import Answer, Answers
from maulstick.survey.questionnaire import read_survey
from maulstick.survey.questions import OPINIONS

_NOTHING = "-"
_TOLD = ("share", "95 % interval", "p")


@dataclass(frozen=True)
class Tally:
    """How many of some answers were of one kind, and the chance of each had they been thrown like dice."""

    count: int
    of: int
    rng: float

    @property
    def share(self) -> float:
        """The share of them, in [0, 1]; nan where there were no answers."""
        return self.count / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Between which shares the true one lies, with 95 % confidence. Source: Wilson 1927."""
        if not self.of:
            return 0.0, 1.0
        from scipy.stats import binomtest  # takes a moment

        interval = binomtest(self.count, self.of).proportion_ci(0.95, method="wilson")
        return float(interval.low), float(interval.high)

    @property
    def p(self) -> float:
        """The probability that chance alone is at least as far off: exact binomial test, two-sided."""
        if not self.of:
            return 1.0
        from scipy.stats import binomtest

        return float(binomtest(self.count, self.of, self.rng).pvalue)


@dataclass(frozen=True)
class Matching:
    """The confusion matrix. counts: (k, k), a row for the hand that drew, a column for the hand that was chosen."""

    hands: tuple[str, ...]
    counts: NDArray[np.int64]

    @property
    def shares(self) -> NDArray[np.float64]:
        """(k, k): of the answers about each hand; nan where there were none."""
        answers = self.counts.sum(axis=1, keepdims=True)
        shares = np.full(self.counts.shape, np.nan)
        np.divide(self.counts, answers, out=shares, where=answers > 0)
        return shares

    @property
    def right(self) -> tuple[Tally, ...]:
        """The right answers about each hand."""
        rng = 1 / len(self.hands)
        return tuple(Tally(int(row[i]), int(row.sum()), rng) for i, row in enumerate(self.counts))

    @property
    def all_right(self) -> Tally:
        """The right answers about all hands."""
        return Tally(int(self.counts.trace()), int(self.counts.sum()), 1 / len(self.hands))


@dataclass(frozen=True)
class Opinion:
    """How many chose each of the two systems. asks: one of `OPINIONS`."""

    asks: str
    counts: tuple[int, int]

    @property
    def first(self) -> Tally:
        """The answers for the first system."""
        return Tally(self.counts[0], sum(self.counts), 1 / 2)


@dataclass(frozen=True)
class Results:
    """All results. links, begun, finished: how many participants there are, have begun, and have answered all."""

    links: int
    begun: int
    finished: int
    matching: Matching | None
    systems: tuple[str, str] | None
    opinions: tuple[Opinion, ...]


@dataclass(frozen=True)
class Rows:
    """A table for people."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def results(folder: Path) -> Results:
    """The results so far of the survey in a folder; an answer counts whether or not its participant finished.

    Raises InputError where there is no survey, or the answers are not its own.
    """
    survey = read_survey(folder)
    store = Answers(folder)
    answers, people = store.all(), store.participants()
    return Results(
        links=len(people),
        begun=sum(person.begun for person in people),
        finished=sum(person.finished for person in people),
        matching=None if survey.match is None else _matching([hand.name for hand in survey.match.hands], answers),
        systems=None if survey.opinions is None else survey.opinions.systems,
        opinions=() if survey.opinions is None else _opinions(survey.opinions.systems, answers),
    )


def matching_rows(matching: Matching) -> Rows:
    """The confusion matrix: in the row of the hand that drew, how many took it for each hand, and their share."""
    rows = zip(matching.hands, matching.counts, matching.shares, strict=True)
    return Rows(
        ("drawn by", *matching.hands), tuple((name, *map(_counted, counts, shares)) for name, counts, shares in rows)
    )


def right_rows(matching: Matching) -> Rows:
    """How often the right hand was chosen: for each hand, and for all together."""
    tallies = zip((*matching.hands, "all hands"), (*matching.right, matching.all_right), strict=True)
    rows = tuple((name, f"{tally.count} of {tally.of}", *_told(tally)) for name, tally in tallies)
    return Rows(("drawn by", "right", *_TOLD), rows)


def opinions_rows(systems: tuple[str, str], opinions: Sequence[Opinion]) -> Rows:
    """The table of opinions: how many chose each system."""
    heads = ("question", *systems, f"share of {systems[0]}", *_TOLD[1:])
    return Rows(heads, tuple((OPINIONS[each.asks], *map(str, each.counts), *_told(each.first)) for each in opinions))


def answers_csv(answers: Sequence[Answer]) -> bytes:
    """Every answer as a line of CSV. Participants are numbers; their links are not told."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(("participant", "question", "kind", "asks", "about", "shown", "chosen", "seconds", "moment"))
    for each in answers:
        moment = datetime.fromtimestamp(each.moment, UTC).isoformat(timespec="seconds")
        shown = " | ".join(each.shown.choices)
        texts = map(_harmless, (each.kind, each.asks, each.shown.about, shown, each.chosen))
        writer.writerow((each.participant, each.number + 1, *texts, f"{each.seconds:.1f}", moment))
    return file.getvalue().encode()


def _harmless(text: str) -> str:
    """A spreadsheet would take what begins so for a formula, and names may come by mail."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text


def _matching(hands: Sequence[str], answers: Sequence[Answer]) -> Matching:
    counts = np.zeros((len(hands), len(hands)), dtype=np.int64)
    for each in answers:
        if each.kind == "match":
            counts[_place(each.shown.about, hands, "hand"), _place(each.chosen, hands, "hand")] += 1
    return Matching(tuple(hands), counts)


def _opinions(systems: tuple[str, str], answers: Sequence[Answer]) -> tuple[Opinion, ...]:
    counts: Counter[tuple[str, int]] = Counter(
        (each.asks, _place(each.chosen, systems, "system")) for each in answers if each.kind == "opinion"
    )
    return tuple(Opinion(asks, (counts[asks, 0], counts[asks, 1])) for asks in OPINIONS)


def _place(name: str, names: Sequence[str], what: str) -> int:
    if name not in names:
        raise InputError(f"an answer names the {what} {name!r}, which survey.json does not; put that survey back")
    return names.index(name)


def _counted(count: int, share: float) -> str:
    return _NOTHING if math.isnan(share) else f"{count} ({share:.0%})"


def _told(tally: Tally) -> tuple[str, str, str]:
    """The share, its interval, and the probability that chance did it."""
    if not tally.of:
        return (_NOTHING,) * 3
    low, high = tally.interval
    return f"{tally.share:.0%}", f"{low:.0%} to {high:.0%}", f"{tally.p:.3f}" if tally.p >= 0.001 else "< 0.001"
