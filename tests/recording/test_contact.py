import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.recording.mocap.contact import RELEASE, Contact, ContactOptions, find_contact, propose_threshold
from maulstick.storage.arrays import Floats

RATE = 100.0
MM = 1e-3
LOW = ContactOptions(threshold=0.5 * MM)


def contact(heights: list[float] | Floats, options: ContactOptions = LOW) -> Contact:
    """Of heights in millimetres at 100 Hz."""
    return find_contact(np.arange(len(heights)) / RATE, np.array(heights, dtype=float) * MM, options)


def bump(high: float, frames: int = 20) -> list[float]:
    """A lift, millimetres."""
    return (high * np.sin(np.linspace(0, np.pi, frames + 2)[1:-1]) ** 2).tolist()


REST = [0.0] * 30


def test_a_touch_lasts_while_the_tip_is_low() -> None:
    found = contact([5.0] * 10 + REST + [5.0] * 10)
    assert found.touches.tolist() == [[10, 40]]
    assert (len(found.merged), len(found.dropped)) == (0, 0)


@pytest.mark.parametrize(("high", "strokes"), [(0.4, 1), (0.9, 1), (1.1, 2), (5.0, 2)])
def test_a_stroke_ends_only_where_the_tip_rises_to_the_release(high: float, strokes: int) -> None:
    assert len(contact(REST + bump(high) + REST).touches) == strokes


def test_a_tip_that_hovers_between_threshold_and_release_never_touches() -> None:
    assert len(contact([0.7] * 100).touches) == 0


def test_ends_go_to_where_the_tip_leaves_the_paper() -> None:
    found = contact(REST + bump(5.0, 40) + REST)
    (_, end), (start, _) = found.touches
    assert 30 <= end <= 32  # at the threshold it would be 34
    assert 68 <= start <= 70


def test_short_lifts_are_merged_and_long_ones_not() -> None:
    heights = REST + [3.0] * 2 + REST + [3.0] * 8 + REST
    found = contact(heights, ContactOptions(0.5 * MM, merge=0.035))
    assert found.touches.tolist() == [[0, 62], [70, 100]]
    assert found.merged.tolist() == [[30, 32]]
    assert len(contact(heights, ContactOptions(0.5 * MM, merge=0)).touches) == 3


def test_short_touches_are_dropped_after_short_lifts_were_merged() -> None:
    heights = [5.0] * 9 + [0.0] * 4 + [5.0] + [0.0] * 4 + [5.0] * 9 + [0.0] * 4 + [5.0] * 9
    found = contact(heights, ContactOptions(0.5 * MM, merge=0.025, shortest=0.05))
    assert found.touches.tolist() == [[9, 18]]
    assert found.merged.tolist() == [[13, 14]]
    assert found.dropped.tolist() == [[27, 31]]


def test_a_touch_of_two_samples_is_none_however_long_they_last() -> None:
    found = find_contact(np.array([0.0, 1.0, 2.0, 3.0]), np.array([5, 0, 0, 5]) * MM, LOW)
    assert (len(found.touches), len(found.dropped)) == (0, 1)


def test_nothing_touches_where_the_height_is_not_known_and_nothing_is_merged_across() -> None:
    found = contact([*REST, np.nan, *REST], ContactOptions(0.5 * MM, merge=1))
    assert found.touches.tolist() == [[0, 30], [31, 61]]
    assert len(contact([np.nan] * 50).touches) == 0


heights_of_a_hand = st.lists(
    st.tuples(st.sampled_from([0.0, 0.2, 0.6, 0.8, 1.2, 4.0, float("nan")]), st.integers(1, 12)),
    min_size=1,
    max_size=25,
).map(lambda parts: [height for height, frames in parts for _ in range(frames)])


@settings(max_examples=60, deadline=None)
@given(heights_of_a_hand, st.sampled_from([0.0, 0.02, 0.1]), st.sampled_from([0.0, 0.03, 0.1]))
def test_touches_are_apart_in_order_and_the_same_backwards(heights: list[float], merge: float, shortest: float) -> None:
    options = ContactOptions(0.5 * MM, merge=merge, shortest=shortest)
    found = contact(heights, options)
    edges = found.touches.ravel()
    assert (np.diff(edges) > 0).all()
    assert all(0 <= edge <= len(heights) for edge in edges)
    for start, stop in found.touches:
        assert not np.isnan(heights[start:stop]).any()
    backwards = contact(heights[::-1], options)
    assert (len(heights) - backwards.touches[::-1, ::-1]).tolist() == found.touches.tolist()
    assert len(backwards.merged) == len(found.merged)
    assert len(backwards.dropped) == len(found.dropped)


@pytest.mark.parametrize("noise", [0.02, 0.06, 0.2])
@pytest.mark.parametrize("lifted", [0.1, 0.4, 0.7])
def test_the_proposed_threshold_lies_above_the_noise_and_below_the_lowest_lifts(noise: float, lifted: float) -> None:
    rng = np.random.default_rng(0)
    down = rng.normal(0, noise, round(10_000 * (1 - lifted)))
    up = np.concatenate([bump(high, 40) for high in rng.uniform(1.5, 8, round(10_000 * lifted / 40))])
    threshold = propose_threshold(np.concatenate([down, up + rng.normal(0, noise, len(up))]) * MM) / MM
    assert 3.5 * noise < threshold
    assert threshold < 1.5 / RELEASE or noise == 0.2
    assert threshold < max(0.55, 9 * noise)


def test_a_soft_brush_that_is_pressed_by_millimetres_gets_a_higher_threshold() -> None:
    rng = np.random.default_rng(0)
    lifts = rng.uniform(0, 8, 3000)
    soft = np.concatenate([rng.uniform(-1.0, 1.0, 10_000), lifts]) * MM
    assert propose_threshold(soft) > 0.9 * MM


@pytest.mark.parametrize("heights", [[], [float("nan")] * 5, [0.3], [0.0] * 1000])
def test_a_threshold_is_proposed_for_hardly_any_heights_too(heights: list[float]) -> None:
    assert 0.2 * MM < propose_threshold(np.array(heights)) < 1.0 * MM


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"threshold": 0.0}, "the threshold is 0 mm; it must be between 0.05 and 20 mm"),
        ({"threshold": 1.2}, "the threshold is 1200 mm; it must be between 0.05 and 20 mm"),
        ({"threshold": float("nan")}, "the threshold is nan mm; it must be"),
        ({"merge": -1.0}, "the longest lift to merge is -1 s; it must be between 0 and 10 s"),
        ({"shortest": 11.0}, "the shortest touch is 11 s; it must be between 0 and 10 s"),
    ],
)
def test_options_without_sense_are_refused(options: dict[str, float], text: str) -> None:
    with pytest.raises(InputError) as caught:
        ContactOptions(**options)
    assert text in str(caught.value)
