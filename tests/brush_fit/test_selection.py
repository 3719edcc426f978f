from collections.abc import Iterator

import numpy as np
import pytest
import torch

from maulstick.brush_fit.descent import descend, stamped
from maulstick.brush_fit.evidence import Evidence, read_evidence
from maulstick.brush_fit.executed import Executed
from maulstick.brush_fit.initialise import first_guess
from maulstick.brush_fit.selection import Split, bend, choose
from maulstick.brush_fit.trials import Trial
from maulstick.painting.brush import Brush
from maulstick.rendering.threads import one_torch_thread
from maulstick.storage.arrays import Floats
from tests.support.brush_fit.simulated_trials import SCALE, Faults, draw_darkness
from tests.support.tolerances import FLOAT64_METRES

MARKER = Brush(name="truth", source="a test", alpha=1e-3, beta=0.7e-3, falloff=0.9, b_x=3e-4, b_y=-2e-4)
LAGGING = MARKER.model_copy(update={"lag": 1.2e-3, "touch": (5e-4, -3e-4)})
COUNT = 30


@pytest.fixture(scope="module", autouse=True)
def _as_in_a_fit() -> Iterator[None]:
    with one_torch_thread():
        yield


def quietly(stage: str, done: int, total: int) -> None:
    pass


def evidence_of(trials: list[Trial]) -> Evidence:
    return read_evidence(trials, SCALE, quietly)[0]


def arcs(heights: Floats) -> list[Floats]:
    t = np.linspace(0, 1, 21)
    return [np.stack([0.03 * t, 4 * height * t * (1 - t), np.full_like(t, 0.5)], axis=1) for height in heights]


@pytest.fixture(scope="module")
def scattered() -> Evidence:
    """Strokes of a machine that puts each of them 0.4 mm beside its place, and inks no two alike."""
    return evidence_of(draw_darkness(MARKER, COUNT, 3, Faults()))


@pytest.fixture(scope="module")
def found(scattered: Evidence) -> Executed:
    return Executed.of(descend(scattered.mosaic(), first_guess(scattered), 100, lambda: None), scattered, pales=False)


def test_a_bend_is_measured_from_the_straight_line_between_the_ends_and_no_further() -> None:
    (arc,) = arcs(np.array([0.004]))
    assert bend(arc) == pytest.approx(0.004, abs=FLOAT64_METRES)
    assert bend(arc[:1].repeat(5, axis=0)) == 0
    loop = np.array([[0, 0], [0.01, 0.0], [0.01, 0.01], [0, 0]])
    assert bend(loop) == pytest.approx(0.01 * np.sqrt(2)), "closed: from its start"


@pytest.mark.parametrize("count", [20, 33, 100])
def test_every_stroke_has_one_part_and_what_is_opened_bends_as_all_do(count: int) -> None:
    heights = np.random.default_rng(0).permutation(np.linspace(0, 0.01, count))
    split = Split.of(arcs(heights), seed=1)
    assert sorted([*split.choosing, *split.opened]) == list(range(count))
    assert len(split.opened) == count // 5
    assert heights[split.opened].mean() == pytest.approx(heights.mean(), rel=0.15)
    chosen_by = heights[split.choosing]
    assert chosen_by[split.bent].min() > chosen_by[~split.bent].max()
    assert chosen_by[split.mixed].mean() == pytest.approx(chosen_by[~split.mixed].mean(), rel=0.15)
    for half in (split.bent, split.mixed):
        assert abs(2 * half.sum() - len(chosen_by)) <= 1


def test_another_seed_opens_other_strokes() -> None:
    paths = arcs(np.linspace(0, 0.01, 50))
    assert set(Split.of(paths, seed=0).opened) == set(Split.of(paths, seed=0).opened)
    assert set(Split.of(paths, seed=0).opened) != set(Split.of(paths, seed=1).opened)


def test_of_too_few_strokes_none_is_held_out() -> None:
    split = Split.of(arcs(np.linspace(0, 0.01, 19)), seed=0)
    assert sorted(split.choosing) == sorted(split.opened) == list(range(19))


def test_a_stroke_is_judged_at_the_place_that_all_share_not_at_its_own(scattered: Evidence, found: Executed) -> None:
    mosaic = scattered.mosaic()
    with torch.no_grad():
        own = mosaic.l1(stamped(mosaic, found.unknowns))
    assert found.l1(scattered).mean() > 1.5 * own.mean()
    places = (found.unknowns.unit * found.unknowns.place).double().numpy()
    assert found.shift == pytest.approx(np.median(places, axis=0))


def test_a_judgement_does_not_depend_on_which_strokes_are_judged_together(scattered: Evidence, found: Executed) -> None:
    assert found.l1(scattered)[[4, 7]].tolist() == pytest.approx(found.l1(scattered.pick([4, 7])).tolist(), rel=1e-3)


def test_an_addition_that_moves_bent_strokes_to_a_wrong_place_is_refused() -> None:
    lagging, prompt = (draw_darkness(brush, COUNT, 3, Faults(place=1e-4)) for brush in (LAGGING, MARKER))
    bends = np.array([bend(trial.path) for trial in prompt])
    only_flat = [
        one if flat else other for one, other, flat in zip(lagging, prompt, bends < np.median(bends), strict=True)
    ]
    for trials, kept in ((lagging, ("lag",)), (only_flat, ())):
        evidence = evidence_of(trials)
        choice = choose(evidence, Split.of(evidence.paths, 0), ["lag"], quietly)
        assert choice.additions == kept
        assert (choice.l1 < choice.l1_paper) == bool(kept)
