"""Results of a survey, computed at the desk since its statistics take a moment."""

from dataclasses import dataclass
from pathlib import Path

from maulstick.survey.questionnaire import read_survey
from maulstick.survey.results import Results, Rows, opinions_rows, results, right_rows


@dataclass(frozen=True)
class SurveyReport:
    """Results of a survey. right, opinions: tables for people; None where the survey has no such questionnaire."""

    title: str
    results: Results
    right: Rows | None
    opinions: Rows | None


def survey_report(folder: Path) -> SurveyReport:
    """Compute the results so far of the survey in a folder. Raises InputError where there is none."""
    found = results(folder)
    return SurveyReport(
        title=read_survey(folder).title,
        results=found,
        right=None if found.matching is None else right_rows(found.matching),
        opinions=None if found.systems is None else opinions_rows(found.systems, found.opinions),
    )
