"""What came out of a survey, as it is worked out at the desk: its statistics take a moment."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.survey.questionnaire import read_survey
from maulstick.survey.results import Results, Rows, opinions_rows, results, right_rows


@dataclass(frozen=True)
class Told:
    """What came out of a survey. right, opinions: tables for people, of what was asked."""

    title: str
    results: Results
    right: Rows | None
    opinions: Rows | None


def told(folder: Path) -> Told:
    """What the participants of the survey in a folder said. Raises InputError where there is none."""
    found = results(folder)
    return Told(
        title=read_survey(folder).title,
        results=found,
        right=None if found.matching is None else right_rows(found.matching),
        opinions=None if found.systems is None else opinions_rows(found.systems, found.opinions),
    )
