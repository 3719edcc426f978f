import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from maulstick.painting.fields import Point
from maulstick.painting.painting import OFF_SHEET, Paint, Painting, Provenance, Sheet, Stroke, StyleUse
from maulstick.painting.refined import refined
from maulstick.storage.arrays import Floats
from tests.support.nominal import nominal

SIDE = 0.1
STYLE = StyleUse(name="loops", hash="0", code=(1.0,), pose=(0.0, 0.0, 0.0))
BOW: tuple[Point, ...] = ((0.01, 0.02, 0.0), (0.05, 0.04, 0.5), (0.09, 0.02, 1.0))


def painting_of(*strokes: Stroke) -> Painting:
    return Painting(
        sheet=Sheet(width=SIDE, height=SIDE),
        provenance=Provenance(version="1"),
        brushes={"pen": nominal("fineliner")},
        paints=(Paint(colour=(0, 0, 0), brush="pen"), Paint(colour=(1, 0, 0), brush="pen")),
        strokes=strokes,
    )


def test_a_refined_stroke_differs_in_its_points_and_speeds_only() -> None:
    bow = Stroke(id=7, paint=1, trajectory=BOW, speed=(0.1, 0.3, 0.2), style=STYLE)
    dot = Stroke(id=3, paint=0, trajectory=BOW[:1], speed=(0.1,))
    painting = painting_of(bow, Stroke(id=5, paint=0, trajectory=BOW), dot)
    finer = refined(painting)
    assert [(s.id, s.paint, s.style, s.speed is None) for s in finer.strokes] == [
        (7, 1, STYLE, False),
        (5, 0, None, True),
        (3, 0, None, False),
    ]
    assert finer.strokes[2] == dot
    assert finer.strokes[0].trajectory == finer.strokes[1].trajectory
    speed = finer.strokes[0].speed
    assert speed is not None
    assert len(speed) == len(finer.strokes[0].trajectory) > len(BOW)
    assert (min(speed), max(speed)) == (0.1, 0.3)
    assert set(BOW) < set(finer.strokes[0].trajectory)
    assert finer.model_copy(update={"strokes": painting.strokes}) == painting


def test_an_empty_painting_stays_empty() -> None:
    assert refined(painting_of()) == painting_of()


@given(arrays(np.float64, (8, 2), elements=st.floats(-OFF_SHEET, SIDE + OFF_SHEET)))
def test_a_refined_painting_keeps_to_its_sheet_as_the_painting_does(points: Floats) -> None:
    painting = painting_of(Stroke(id=1, paint=0, trajectory=tuple((x, y, 0.5) for x, y in points.tolist())))
    finer = refined(painting)
    overhang, before = (p.sheet.overhang(p.trajectories()[..., :2]) for p in (finer, painting))
    assert (overhang <= np.maximum(before, 0)).all()
    Painting.model_validate(finer.model_dump())
