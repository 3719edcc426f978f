import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from maulstick.brush_fit import fit as module
from maulstick.brush_fit import selection
from maulstick.brush_fit.evidence import Evidence, read_evidence
from maulstick.brush_fit.fit import Fit, fit_brush
from maulstick.brush_fit.selection import bend
from maulstick.brush_fit.trials import Trial, Trials
from maulstick.errors import InputError
from maulstick.painting.brush import CURVE_PRESSURES, Brush
from tests.support.brush_fit.simulated_trials import INK, PAPER, SCALE, Faults, draw_darkness, draw_trials
from tests.support.tolerances import (
    CLEAN_WIDTH,
    INK_COLOUR,
    KEPT_NUMBER,
    KEPT_WIDTH,
    MOVED_PX,
    OPACITY,
    SIGMAS,
)

MARKER = Brush(name="truth", source="a test", alpha=1e-3, beta=0.7e-3, falloff=0.9, opacity=0.9, b_x=3e-4, b_y=-2e-4)
PRESSES = np.array([0.2, 0.5, 0.9])


def fitted(trials: Sequence[Trial] | Trials, *additions: str, seed: int = 0) -> Fit:
    return fit_brush(trials, SCALE, "found", source="a test", additions=additions, seed=seed)


@pytest.fixture(scope="module")
def plain() -> Fit:
    """Noisy photographs of the paper's brush, strokes crossing, that may pale by chance."""
    return fitted(draw_trials(MARKER, 20, 1, Faults(specks=1)), "faint")


PRECISE = Faults(place=1e-4)
"""A machine that scatters little, since what it executes shows nothing that is finer than its scatter."""

NIB_PEN = MARKER.model_copy(update={"plateau": 0.5, "falloff": 1.5, "nib": (0.25, -0.1)})


@pytest.fixture(scope="module")
def of_nib() -> Fit:
    return fitted(draw_darkness(NIB_PEN, 30, 1, PRECISE), "plateau", "nib")


ROUND = MARKER.model_copy(
    update={
        "alpha": 1.6e-3,
        "curve": tuple(pressure**2 for pressure in CURVE_PRESSURES),
        "lag": 1.2e-3,
        "touch": (5e-4, -3e-4),
    }
)


@pytest.fixture(scope="module")
def of_round() -> Fit:
    return fitted(draw_darkness(ROUND, 30, 1, PRECISE), "curve", "lag")


@pytest.fixture(scope="module")
def spoilt(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """A folder of eleven trials, of which six can be used."""
    folder = tmp_path_factory.mktemp("spoilt") / "trials"
    trials = Trials.make(folder, medium="a marker", pixels_per_metre=SCALE)
    for i, trial in enumerate(draw_trials(MARKER, 11, 1, Faults())):
        path, before, after = trial.path, trial.before, trial.after
        if i == 2:
            after = before
        if i == 4:
            after = np.ones_like(after)
        if i == 6:
            path = path + np.array([1, 0, 0])
        if i == 9:
            after = ndimage.shift(after, (4, -3, 0), order=1, mode="nearest")
        trials.begin(before)
        trials.append(path, after)
    last = sorted(folder.glob("*.png"))[-1]
    last.write_bytes(last.read_bytes()[:400])
    return fitted(Trials.open(folder))


@pytest.fixture(scope="module")
def dark() -> Fit:
    return fitted(draw_darkness(MARKER, 6, 1, Faults()))


@pytest.fixture(scope="module")
def flat() -> Fit:
    """Strokes of one pressure, each on a sheet of its own."""
    return fitted(draw_trials(MARKER, 5, 2, sheet_of=1, pressure=lambda pressure: np.full_like(pressure, 0.5)))


def test_the_numbers_of_a_brush_are_found_within_their_standard_errors(plain: Fit) -> None:
    for name in ("m_x", "m_y", "b_x", "b_y", "alpha", "beta", "falloff"):
        off = getattr(plain.brush, name) - getattr(MARKER, name)
        assert abs(off) < SIGMAS * plain.errors[name], name
    assert plain.errors["alpha"] < 0.05 * MARKER.alpha
    assert plain.errors["beta"] < 0.05 * MARKER.beta
    assert plain.errors["falloff"] < 0.1


def test_strokes_that_lie_beside_their_places_do_not_widen_the_brush(plain: Fit) -> None:
    found = plain.brush.half_width(PRESSES)
    assert found == pytest.approx(MARKER.half_width(PRESSES), rel=CLEAN_WIDTH)
    assert plain.place_scatter == pytest.approx(Faults().place, rel=0.4)
    assert plain.ink_scatter == pytest.approx(Faults().ink, rel=0.6)


def test_ink_that_shines_through_is_found_with_its_colour(plain: Fit) -> None:
    assert plain.ink == pytest.approx(INK, abs=INK_COLOUR)
    assert plain.brush.opacity == pytest.approx(MARKER.opacity, abs=OPACITY)
    assert 0 < plain.errors["opacity"] < OPACITY


def test_a_brush_that_is_the_papers_gets_no_additions(plain: Fit) -> None:
    assert plain.kept == ()
    assert plain.l1 == plain.l1_paper
    assert plain.brush.faint == 1
    assert (plain.warnings, plain.left_out, plain.strokes) == ((), (), 20)


def test_held_out_strokes_are_shown_with_what_was_predicted(plain: Fit) -> None:
    assert len(plain.views) == 4
    for view in plain.views:
        assert view.after.shape == view.predicted.shape
        assert 0.2 * plain.l1 < np.abs(view.after - view.predicted).mean() < 3 * plain.l1


def test_strokes_are_shown_from_the_flattest_to_the_most_bent(monkeypatch: pytest.MonkeyPatch) -> None:
    trials = draw_darkness(MARKER, 7, 1)
    by_bend = sorted(trials, key=lambda trial: bend(trial.path))
    monkeypatch.setattr(module, "_VIEWS", 3)
    assert [view.name for view in fitted(trials).views] == [by_bend[i].name for i in (0, 3, 6)]


def test_a_plateau_and_a_nib_are_found(of_nib: Fit) -> None:
    assert sorted(of_nib.kept) == ["nib", "plateau"]
    assert of_nib.l1 < 0.8 * of_nib.l1_paper
    found = of_nib.brush
    assert (*found.nib, found.plateau, found.falloff) == pytest.approx(
        (*NIB_PEN.nib, NIB_PEN.plateau, NIB_PEN.falloff), abs=0.02
    )
    assert found.half_width(PRESSES) == pytest.approx(NIB_PEN.half_width(PRESSES), rel=KEPT_WIDTH)


def test_a_curve_and_a_lag_are_found(of_round: Fit) -> None:
    assert sorted(of_round.kept) == ["curve", "lag"]
    found = of_round.brush
    assert found.half_width(PRESSES) == pytest.approx(ROUND.half_width(PRESSES), rel=KEPT_WIDTH)
    assert (found.lag, *found.touch) == pytest.approx((ROUND.lag, *ROUND.touch), abs=KEPT_NUMBER)
    assert {"curve[0]", "curve[6]", "lag", "touch[0]"} <= set(of_round.errors)


def test_trials_that_cannot_be_used_are_named_and_the_others_still_fit(spoilt: Fit) -> None:
    assert spoilt.strokes == 6
    assert [reason.split(":")[0].split(" ")[1] for reason in spoilt.left_out] == ["3", "5", "7", "10", "11"]
    no_mark, blank, beside, moved, broken = spoilt.left_out
    assert no_mark.startswith("stroke 3 left no mark that can be seen near its path; ")
    assert blank == "stroke 5 cannot be seen: its photograph after it is all white; was it overexposed?"
    assert beside.startswith("stroke 7 lies beside its photographs; ")
    assert float(moved.split(" moved by ")[1].split()[0]) == pytest.approx(5, abs=MOVED_PX)
    assert broken.startswith("stroke 11: ")
    assert spoilt.brush.widest == pytest.approx(MARKER.widest, rel=KEPT_WIDTH)


def test_with_few_strokes_nothing_is_tried_and_that_is_said(spoilt: Fit) -> None:
    assert spoilt.warnings[0].startswith("only 6 strokes could be used: nothing was held out and nothing tried beyond")
    assert spoilt.kept == ()


def test_photographs_and_darkness_images_of_the_same_strokes_give_the_same_brush(dark: Fit, spoilt: Fit) -> None:
    assert dark.ink == (1,)
    assert dark.brush.half_width(PRESSES) == pytest.approx(spoilt.brush.half_width(PRESSES), rel=2 * KEPT_WIDTH)


def test_a_fit_is_the_same_to_the_bit_when_it_is_run_again(dark: Fit) -> None:
    again = fitted(draw_darkness(MARKER, 6, 1, Faults()))
    assert (again.brush, again.errors, again.l1, again.ink_scatter) == (
        *(dark.brush, dark.errors),
        *(dark.l1, dark.ink_scatter),
    )


def test_what_strokes_of_one_pressure_that_never_cross_leave_open_is_said(flat: Fit) -> None:
    for start in (
        "all strokes were drawn at pressure 0.50: how width depends on pressure is not known, alpha is 0",
        "no stroke crosses an older one, so a translucent ink cannot be told from a paler one: opacity is 1",
    ):
        assert any(warning.startswith(start) for warning in flat.warnings), start


def test_strokes_that_all_go_along_one_axis_tell_nothing_of_the_other_scale(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "STEPS", 20)
    monkeypatch.setattr(selection, "STEPS", 20)
    level = [replace(trial, path=trial.path * [1, 0, 1] + [0, 0.014, 0]) for trial in draw_darkness(MARKER, 6, 1)]
    found = fitted(level)
    assert found.brush.m_y == 1
    assert "m_x" in found.errors
    assert "m_y" not in found.errors
    assert "no stroke goes along y: m_y is not known and stays 1; draw some that do" in found.warnings


@pytest.mark.parametrize(("pixels", "is_told"), [(0.6, False), (1.5, False), (3.0, True)])
def test_a_mark_whose_pixels_are_too_few_to_tell_its_numbers_is_doubted(pixels: float, is_told: bool) -> None:
    thin = MARKER.model_copy(update={"alpha": 0.0, "beta": pixels / 2 / SCALE})
    found = fitted(draw_darkness(thin, 6, 1))
    said = [text for text in found.warnings if re.match(r"the mark is [\d.]+ pixels wide in the photographs", text)]
    assert (abs(found.brush.falloff / MARKER.falloff - 1) < 0.1) is is_told
    assert (said == []) is is_told
    assert all(text.endswith("cannot be told apart; photograph the strokes from nearer") for text in said)


@pytest.mark.parametrize(("pixels", "and_nearer"), [(1.5, ""), (0.3, ", and photograph them from nearer")])
def test_a_thin_mark_in_photographs_that_long_strokes_made_coarse_asks_for_shorter_ones(
    monkeypatch: pytest.MonkeyPatch, pixels: float, and_nearer: str
) -> None:
    def read_reduced(*given: Any) -> tuple[Evidence, list[str]]:
        evidence, left_out = read_evidence(*given)
        return replace(evidence, reduced=2), left_out

    monkeypatch.setattr(module, "read_evidence", read_reduced)
    thin = MARKER.model_copy(update={"alpha": 0.0, "beta": pixels / 2 / SCALE})
    (said,) = (text for text in fitted(draw_darkness(thin, 6, 1)).warnings if text.startswith("the mark is "))
    shorter = "; draw shorter strokes, whose photographs need not be reduced as these were, to 1/2 of their size"
    assert said.endswith(f"{shorter}{and_nearer}")


def cut_out(trial: Trial, turned: bool) -> Trial:
    """The trial in photographs of its stroke alone, as a machine's are cut out, and perhaps turned by 180 degrees."""
    corner, end = (np.round(f(trial.path[:, :2], axis=0) * SCALE).astype(int) for f in (np.min, np.max))
    room = 12  # pixels
    (left, top), (right, bottom) = (corner - room).clip(min=0), end + room
    step = -1 if turned else 1
    before, after = (x[top:bottom, left:right][::step, ::step] for x in (trial.before, trial.after))
    return replace(trial, path=trial.path - [left / SCALE, top / SCALE, 0], before=before, after=after)


@pytest.mark.parametrize("turned", [True, False])
def test_photographs_that_are_turned_by_180_degrees_are_doubted_and_others_not(
    monkeypatch: pytest.MonkeyPatch, turned: bool
) -> None:
    monkeypatch.setattr(module, "STEPS", 20)
    monkeypatch.setattr(selection, "STEPS", 20)
    found = fitted([cut_out(trial, turned) for trial in draw_trials(MARKER, 6, 1, Faults())])
    assert any("turned by 180 degrees" in warning for warning in found.warnings) == turned


def test_strokes_of_one_pressure_tell_one_width(flat: Fit) -> None:
    assert flat.brush.alpha == 0
    assert flat.brush.beta == pytest.approx(MARKER.half_width(np.array(0.5)), rel=CLEAN_WIDTH)
    assert flat.brush.lightest == pytest.approx(0.5)


def test_ink_that_never_crosses_itself_is_taken_for_opaque(flat: Fit) -> None:
    assert flat.brush.opacity == 1
    assert "opacity" not in flat.errors
    seen = 0.1 * np.array(PAPER) + 0.9 * np.array(INK)
    assert flat.ink == pytest.approx(seen.tolist(), abs=INK_COLOUR)


def test_fewer_than_five_strokes_are_refused_with_what_is_wrong_with_the_others() -> None:
    trials = draw_trials(MARKER, 5, 2, Faults())
    trials[3] = replace(trials[3], after=np.zeros_like(trials[3].after))
    text = "4 of 5 trials can be used, and 5 are needed: stroke 4 cannot be seen: its photograph after it is all black"
    with pytest.raises(InputError, match=f"^{text}"):
        fitted(trials)
    with pytest.raises(InputError, match=r"^0 of 0 trials can be used, and 5 are needed: draw more$"):
        fitted([])


def test_strokes_are_used_where_none_of_those_that_are_looked_at_first_can_be() -> None:
    trials = draw_darkness(MARKER, 24, 1)
    looked_at_first = np.linspace(0, 23, 12).astype(int).tolist()
    for number in looked_at_first:
        trials[number] = replace(trials[number], after=trials[number].before)
    evidence, left_out = read_evidence(trials, SCALE, lambda stage, done, total: None)
    assert (len(evidence), len(left_out)) == (12, 12)


@pytest.mark.parametrize("dark_first", [True, False])
def test_photographs_and_darkness_images_are_not_fitted_together(dark_first: bool) -> None:
    dark, photographs = draw_darkness(MARKER, 3, 1), draw_trials(MARKER, 3, 2)
    text = "3 trials are darkness images, as stroke 1 is, and 3 are photographs; one fit takes one kind"
    with pytest.raises(InputError, match=f"^{text}"):
        fitted([*dark, *photographs] if dark_first else [*photographs, *dark])
    with pytest.raises(
        InputError, match=r"^1 trial is a darkness image, as stroke 1 is, and 4 are photographs; one fit"
    ):
        fitted([dark[0], *draw_trials(MARKER, 4, 2)])
