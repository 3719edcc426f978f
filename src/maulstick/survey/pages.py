"""The pages that participants see: plain HTML, without scripts."""

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
"""What all pages have in common, and look for at `root`/survey.css and `root`/icon.svg."""


def letters(question: Question) -> str:
    """What the choices are called, from the first on."""
    return ascii_uppercase[: len(question.choices)]


def beginning(survey: Survey, count: int, root: str) -> str:
    """The page before the first of `count` questions. root: the path below which the survey's pages are."""
    return _TEMPLATES.get_template("beginning.html").render(survey=survey, count=count, root=root)


def asking(survey: Survey, number: int, asked: tuple[Question, ...], token: str, root: str, *, again: bool) -> str:
    """The page of question `number`, from 0. again: nothing was chosen, and that has to be said."""
    question = asked[number]
    return _TEMPLATES.get_template("question.html").render(
        survey=survey,
        question=question,
        words=OPINIONS.get(question.asks, ""),
        letters=letters(question),
        number=number,
        count=len(asked),
        pictures=f"{root}/{token}/picture",
        again=again,
        root=root,
    )


def thanks(survey: Survey, root: str) -> str:
    """The page after the last question."""
    return _TEMPLATES.get_template("thanks.html").render(survey=survey, root=root)


def apology(sentence: str, root: str) -> str:
    """The page where there is none to show, and why."""
    return _TEMPLATES.get_template("apology.html").render(sentence=sentence, root=root)
