"""Pages of a survey for participants: plain HTML, without scripts."""

from pathlib import Path
from string import ascii_uppercase
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from maulstick.survey.questionnaire import Survey
from maulstick.survey.questions import OPINIONS, Question

_FOLDER = Path(__file__).with_name("templates")
_TEMPLATES = Environment(
    loader=FileSystemLoader(_FOLDER), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
)

STYLE: Final = (_FOLDER / "survey.css").read_bytes()
ICON: Final = (_FOLDER / "icon.svg").read_bytes()
"""Files that all pages ask for, at `root`/survey.css and `root`/icon.svg."""


def letters(question: Question) -> str:
    """Return the letters that name the choices on the page, from A on."""
    return ascii_uppercase[: len(question.choices)]


def beginning(survey: Survey, count: int, root: str) -> str:
    """Render the page before the first of `count` questions. root: path below which the pages of the survey are."""
    return _TEMPLATES.get_template("beginning.html").render(survey=survey, count=count, root=root)


def asking(
    survey: Survey, number: int, all_questions: tuple[Question, ...], token: str, root: str, *, again: bool
) -> str:
    """Render the page of question `number`, from 0. again: tell the participant to choose a drawing first."""
    question = all_questions[number]
    return _TEMPLATES.get_template("question.html").render(
        survey=survey,
        question=question,
        text=OPINIONS.get(question.asks, ""),
        letters=letters(question),
        number=number,
        count=len(all_questions),
        pictures=f"{root}/{token}/picture",
        again=again,
        root=root,
    )


def thanks(survey: Survey, root: str) -> str:
    """Render the page after the last question."""
    return _TEMPLATES.get_template("thanks.html").render(survey=survey, root=root)


def apology(sentence: str, root: str) -> str:
    """Render the page of an error. sentence: what is wrong, for the participant."""
    return _TEMPLATES.get_template("apology.html").render(sentence=sentence, root=root)
