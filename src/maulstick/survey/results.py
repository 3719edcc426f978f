"""Results of a survey: the paper's confusion matrix and table of opinions, compared with guessing.

Intervals and probabilities assume that all answers are independent, which strictly holds only where each participant
was asked about one hand and one pair, as in the paper.
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

from maulstick.errors import InputError
from maulstick.storage.arrays import Floats, Ints
from maulstick.survey.answers import Answer, Answers
from maulstick.survey.questionnaire import read_survey
from maulstick.survey.questions import OPINIONS

_NOTHING = "-"
_STATISTICS = ("share", "95 % interval", "p")


@dataclass(frozen=True)
class Tally:
    """Number of answers of one kind, out of all. by_guessing: probability of such an answer by mere guessing."""

    count: int
    of: int
    by_guessing: float

    @property
    def share(self) -> float:
        """Share of the answers, in [0, 1]; nan where there were none."""
        return self.count / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the share: its lower and its upper end. Source: Wilson 1927."""
        if not self.of:
            return 0.0, 1.0
        from scipy.stats import binomtest  # takes a moment

        interval = binomtest(self.count, self.of).proportion_ci(0.95, method="wilson")
        return float(interval.low), float(interval.high)

    @property
    def p(self) -> float:
        """p-value against mere guessing: exact binomial test, two-sided."""
        if not self.of:
            return 1.0
        from scipy.stats import binomtest

        return float(binomtest(self.count, self.of, self.by_guessing).pvalue)


@dataclass(frozen=True)
class Matching:
    """Confusion matrix. counts: (k, k), one row per hand that drew, one column per hand that was chosen."""

    hands: tuple[str, ...]
    counts: Ints

    @property
    def shares(self) -> Floats:
        """Shares of the answers about each hand, (k, k); nan where there were none."""
        answers = self.counts.sum(axis=1, keepdims=True)
        shares = np.full(self.counts.shape, np.nan)
        np.divide(self.counts, answers, out=shares, where=answers > 0)
        return shares

    @property
    def right(self) -> tuple[Tally, ...]:
        """Right answers about each hand."""
        by_guessing = 1 / len(self.hands)
        return tuple(Tally(int(row[i]), int(row.sum()), by_guessing) for i, row in enumerate(self.counts))

    @property
    def all_right(self) -> Tally:
        """Right answers about all hands together."""
        return Tally(int(self.counts.trace()), int(self.counts.sum()), 1 / len(self.hands))


@dataclass(frozen=True)
class Opinion:
    """Answers to a question of opinion. asks: its key in `OPINIONS`.  counts: how often each system was chosen."""

    asks: str
    counts: tuple[int, int]

    @property
    def first(self) -> Tally:
        """Answers for the first system."""
        return Tally(self.counts[0], sum(self.counts), 1 / 2)


@dataclass(frozen=True)
class Results:
    """Results of a survey. links, begun, finished: how many participants have a link, have begun, have finished."""

    links: int
    begun: int
    finished: int
    matching: Matching | None
    systems: tuple[str, str] | None
    opinions: tuple[Opinion, ...]


@dataclass(frozen=True)
class Rows:
    """Table of text, to be shown to people."""

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def results(folder: Path) -> Results:
    """Compute the results so far of the survey in a folder; answers count even if the participant has not finished.

    Raises InputError where there is no survey, or the answers belong to another one.
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
    """Table of the confusion matrix: a row per hand that drew, with how many took it for each hand, and their share."""
    rows = zip(matching.hands, matching.counts, matching.shares, strict=True)
    return Rows(
        ("drawn by", *matching.hands), tuple((name, *map(_counted, counts, shares)) for name, counts, shares in rows)
    )


def right_rows(matching: Matching) -> Rows:
    """Table of how often the right hand was chosen: for each hand, and for all together."""
    tallies = zip((*matching.hands, "all hands"), (*matching.right, matching.all_right), strict=True)
    rows = tuple(
        (name, f"{tally.count} of {tally.of}", *_statistics(tally), f"{tally.by_guessing:.0%}")
        for name, tally in tallies
    )
    return Rows(("drawn by", "right", *_STATISTICS, "by guessing"), rows)


def opinions_rows(systems: tuple[str, str], opinions: Sequence[Opinion]) -> Rows:
    """Table of opinions: how many chose each system."""
    heads = ("question", *systems, f"share of {systems[0]}", *_STATISTICS[1:])
    return Rows(
        heads, tuple((OPINIONS[each.asks], *map(str, each.counts), *_statistics(each.first)) for each in opinions)
    )


def answers_csv(answers: Sequence[Answer]) -> bytes:
    """Encode all answers as CSV, one line per answer. Participants are numbers; their links are left out."""
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow(("participant", "question", "kind", "asks", "about", "shown", "chosen", "seconds", "moment"))
    for each in answers:
        moment = datetime.fromtimestamp(each.moment, UTC).isoformat(timespec="seconds")
        shown = " | ".join(each.shown.choices)
        texts = map(_without_formulas, (each.kind, each.asks, each.shown.about, shown, each.chosen))
        writer.writerow((each.participant, each.number + 1, *texts, f"{each.seconds:.1f}", moment))
    return file.getvalue().encode()


def _without_formulas(text: str) -> str:
    """Mark text that a spreadsheet would take for a formula as text: names may come by mail."""
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


def _statistics(tally: Tally) -> tuple[str, str, str]:
    """Return the share, its confidence interval and its p-value as text."""
    if not tally.of:
        return (_NOTHING,) * 3
    low, high = tally.interval
    return f"{tally.share:.0%}", f"{low:.0%} to {high:.0%}", f"{tally.p:.3f}" if tally.p >= 0.001 else "< 0.001"
