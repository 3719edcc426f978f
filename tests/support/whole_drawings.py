"""A survey of whole drawings: two that come with Maulstick as ink, and plans of one picture in their hands."""

from pathlib import Path

import numpy as np

import maulstick
from maulstick.strokes.ink import Ink, write_ink
from maulstick.style.cards import style_path
from maulstick.style.store import read_style
from maulstick.survey.questionnaire import Match, Survey, SurveyHand, build
from tests.support.planned import picture

HANDS = ("elephant", "moscow")
_MARGIN = 0.01  # metres


def build_of_whole_drawings(folder: Path, root: Path) -> Survey:
    """Build the survey in `folder`, from files that are made in the folder `root`."""
    hands = tuple(_hand(name, root) for name in HANDS)
    return build(folder, "Whose drawing is this?", Match(question="whose drawing", hands=hands), None)


def _hand(name: str, root: Path) -> SurveyHand:
    arrangement = read_style(style_path(name)).arrangement
    assert arrangement is not None
    places = arrangement.paths - arrangement.paths.min(axis=(0, 1)) + _MARGIN
    timed = [np.column_stack([np.arange(len(path)), path, np.full(len(path), np.nan)]) for path in places]
    width, height = (places.max(axis=(0, 1)) + _MARGIN).tolist()
    write_ink(Ink.of(timed, (width, height), name), root / f"{name}.ink.npz")
    painting = maulstick.plan(
        picture(),
        style=name,
        brush="fineliner",
        ink="black",
        strokes=60,
        size="100x100mm",
        hand_size=0.5,
        steps=30,
        px=64,
    )
    maulstick.render(painting, px=400).save(root / f"{name}.png")
    return SurveyHand(name=name, by_hand=root / f"{name}.ink.npz", by_machine=(root / f"{name}.png",))
