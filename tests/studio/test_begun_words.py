"""Words on plans and on paintings that were begun."""

from pathlib import Path

from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.status import PaintStatus
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.studio.panels.paint.paint import _begun_text
from maulstick.studio.panels.plan.card import _summary


def test_what_was_begun_says_by_which_machine() -> None:
    def said(machine: str, painted: int = 3) -> str:
        return _begun_text(PaintStatus(150, painted, None, PaintOptions(robot=machine)))

    rehearsed = "are painted. So far on the simulated easel: nothing of it is on paper."
    assert said("sim:real").endswith(rehearsed)
    assert said("sim", 150) == f"All 150 strokes {rehearsed}"
    assert said("axidraw", 150) == "All 150 strokes are painted."
    assert said("axidraw").endswith("are painted. Machine so far: AxiDraw.")
    assert said("grbl:/dev/ttyUSB0").endswith("Machine so far: Pen plotter with Grbl at /dev/ttyUSB0.")


def test_the_only_colour_of_a_pen_is_a_pen_the_only_stroke_is_one_and_tubes_that_are_not_mixed_are_named() -> None:
    pen = PlanOptions(text="a", brush="micron-01", paints=1)
    assert "1 pen," in _summary(PlanRequest(None, pen), "loops")
    assert "1 paint," in _summary(PlanRequest(None, PlanOptions(text="a", brush="marker", paints=1)), "loops")
    unmixed = PlanOptions(text="a", brush="marker", paints_from=Path("tubes.csv"))
    assert ", 1 stroke, " in _summary(PlanRequest(None, PlanOptions(text="a", strokes=1)), "loops")
    assert "400 strokes, the paints of your tubes," in _summary(PlanRequest(None, unmixed), "loops")
