"""Title of the page's tab, without a page."""

from types import SimpleNamespace
from typing import Any

import pytest

from maulstick.studio.panels.tab_title import news_of
from maulstick.studio.state.plan import Phase
from maulstick.studio.state.run import State
from maulstick.studio.workers.messages import RunProgress

HALF = RunProgress("painting", 3, 6, 0.2, 0.4, 5.0, 0, None)
LONG = "see that the pen stands 10 mm from the left and 20 mm from the upper edge of the sheet"


@pytest.mark.parametrize(
    ("state", "phase", "title"),
    [
        (State(), Phase.PLANNED, ""),
        (State(), Phase.PLANNING, "37% The cat"),
        (State("painting", "dog", progress=HALF), Phase.PLANNING, "50% A dog"),
        (State("starting", "dog"), Phase.PLANNED, "0% A dog"),
        (State("painting", "dog", progress=HALF, question="put in black"), Phase.PLANNING, "Put in black"),
        (State("painting", "dog", question=LONG), Phase.PLANNED, "See that the pen stands 10 mm from the …"),
        (State("ended", "dog", progress=HALF), Phase.PLANNED, ""),
    ],
)
def test_the_title_says_what_waits_for_a_person_then_how_far_it_is(state: State, phase: Phase, title: str) -> None:
    plan = SimpleNamespace(phase=phase, done=0.37, name="cat", title="The cat")
    studio: Any = SimpleNamespace(
        run=SimpleNamespace(state=state, title="A dog"), plans=SimpleNamespace(plans={"cat": plan})
    )
    assert news_of(studio) == title
