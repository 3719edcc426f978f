"""What a person is told of, without a page."""

from types import SimpleNamespace
from typing import Any

import pytest

from maulstick.studio.panels.bell import Moment, News, news_between
from maulstick.studio.state.plan import Phase
from maulstick.studio.state.run import State

PAINTS, ASKS = State("painting", "dog"), State("painting", "dog", question="put in black", question_number=3)
WAITS = News("Dog waits for you", "Please put in black.", "run")


@pytest.mark.parametrize(
    ("before", "now", "news"),
    [
        (Phase.WAITING, Phase.PLANNING, []),
        (Phase.PLANNING, Phase.PLANNING, []),
        (Phase.PLANNING, Phase.PLANNED, [News("A cat is planned", "5 strokes, 1 paint", "plan cat")]),
        (Phase.PLANNING, Phase.FAILED, [News("A cat was not planned", "no room", "plan cat")]),
        (Phase.STOPPING, Phase.STOPPED, []),
        (Phase.PLANNED, Phase.PLANNED, []),
        (None, Phase.PLANNED, []),  # taken back out of the trash
    ],
)
def test_of_a_plan_a_person_is_told_its_end_unless_they_stopped_it(
    before: Phase | None, now: Phase, news: list[News]
) -> None:
    phases = {} if before is None else {"cat": before}
    assert [*news_between(Moment(phases, State()), Moment({"cat": now}, State()), studio())] == news


@pytest.mark.parametrize(
    ("before", "now", "news"),
    [
        (State(), PAINTS, []),
        (PAINTS, ASKS, [WAITS]),
        (ASKS, ASKS, []),
        (State("painting", "dog", question="put in black", question_number=2), ASKS, [WAITS]),
        (ASKS, PAINTS, []),
        (PAINTS, State("ended", "dog", sentence="Dog is painted."), [News("Dog is painted", "Dog is painted.", "run")]),
        (
            PAINTS,
            State("ended", "dog", sentence="It stopped: no power.", fault=True),
            [News("Dog stopped", "It stopped: no power.", "run")],
        ),
        (State("stopping", "dog"), State("ended", "dog", sentence="You stopped it."), []),
        (State("checking", "dog"), State("ended", "dog", sentence="It fits."), []),
    ],
)
def test_of_a_machine_a_person_is_told_when_it_waits_and_its_end_unless_they_stopped_it(
    before: State, now: State, news: list[News]
) -> None:
    assert [*news_between(Moment({}, before), Moment({}, now), studio())] == news


def studio() -> Any:
    """Return what has a plan and a machine."""
    cat = SimpleNamespace(metrics=("5 strokes", "1 paint"), why="no room")
    plans = SimpleNamespace(plans={"cat": cat}, titles=lambda: {"cat": "A cat"})
    return SimpleNamespace(plans=plans, run=SimpleNamespace(title="Dog"))
