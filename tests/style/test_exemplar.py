from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.spatial.distance import cdist
from scipy.stats import ks_2samp
from torch import Tensor

from maulstick.style import Style, exemplar, shape
from maulstick.style.compare import CURVINESS, describe, energy_distance
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands, pool
from maulstick.style.shape import GIST, RESIDUAL
from maulstick.style.trait_costs import gist_and_roughness
from tests.support.style.synthetic_hands import (
    Drawing,
    all_hands,
    arc,
    circle,
    drawn,
    exemplar_of,
    hand_of,
    line,
    line_or_arc,
    strokes_of,
    zigzag,
)
from tests.support.tolerances import CODE_LOGARITHM, FLOAT32_ROUND_TRIP, FLOAT64_ROUND_TRIP

NUMBERS = GIST + RESIDUAL
KINDS = (circle, zigzag, arc, line_or_arc)
HANDS = all_hands()
STYLES = {one: exemplar_of(one) for one in KINDS}
OTHERS = {one: drawn(one, 60, seed=99) for one in KINDS}
STYLE = STYLES[circle]


def torch_rng(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def even(count: int) -> Tensor:
    """Press that costs nothing where none was recorded."""
    return torch.full((count, 4), 0.5)


def own(style: Exemplar) -> Tensor:
    """Codes of the hand's own strokes."""
    return style.encode(torch.from_numpy(style.hand.paths))


def costs(style: Style, codes: Tensor) -> np.ndarray:
    return style.cost(codes, even(len(codes))).numpy()


def descriptions() -> dict[Drawing, np.ndarray]:
    """Of the other strokes of each hand, standardised over all hands."""
    return {one: standard(paths) for one, paths in OTHERS.items()}


def standard(paths: np.ndarray) -> np.ndarray:
    usual = np.concatenate([describe(each) for each in OTHERS.values()])
    return (describe(paths) - usual.mean(axis=0)) / usual.std(axis=0)


def sharpest(paths: np.ndarray) -> np.ndarray:
    """Radians (N,) that three joints of a path turn by together, at most."""
    steps = np.diff(paths, axis=1)
    heading = np.unwrap(np.arctan2(steps[..., 1], steps[..., 0]), axis=1)
    return np.asarray(np.abs(heading[:, 3:] - heading[:, :-3]).max(axis=1))


def residual_directions(codes: Tensor) -> Tensor:
    """Residuals (N, 47) of codes, each of length 1."""
    numbers = codes.double() * torch.from_numpy(HANDS.units)
    return torch.nn.functional.normalize(numbers[:, GIST:], dim=1)


def longer(style: Exemplar, by: float) -> Tensor:
    """Codes of the hand's strokes, each `by` times as long."""
    return style.encode(by * torch.from_numpy(style.hand.paths))


@pytest.mark.parametrize("one", KINDS)
def test_samples_are_like_the_other_strokes_of_their_hand_and_unlike_those_of_others(one: Drawing) -> None:
    codes, _ = STYLES[one].sample(60, torch_rng())
    sampled, others = standard(STYLES[one].decode(codes).double().numpy()), descriptions()
    likeness = {name: energy_distance(sampled, other) for name, other in others.items()}
    assert likeness[one] < 0.3
    assert min(likeness[name] for name in KINDS if name != one) > max(4 * likeness[one], 0.8)


@pytest.mark.parametrize("one", KINDS)
def test_samples_are_not_copies(one: Drawing) -> None:
    style = STYLES[one]
    codes, _ = style.sample(60, torch_rng())
    apart = torch.cdist(codes[:, :GIST], own(style)[:, :GIST].float()).amin(dim=1)
    among = torch.cdist(own(style)[:, :GIST], own(style)[:, :GIST]).fill_diagonal_(torch.inf).amin(dim=1)
    assert apart.median() > 0.2 * among.median()
    assert apart.min() > 0


@pytest.mark.parametrize("one", KINDS)
def test_no_sample_is_longer_or_rougher_than_every_stroke_of_the_hand(one: Drawing) -> None:
    codes, _ = STYLES[one].sample(300, torch_rng())
    units = torch.from_numpy(HANDS.units)
    sampled, drawn = (gist_and_roughness(*shape.parts(each.double() * units)) for each in (codes, own(STYLES[one])))
    for number in (0, GIST):
        assert sampled[:, number].max() < drawn[:, number].max() + CODE_LOGARITHM
        assert sampled[:, number].min() > drawn[:, number].min() - CODE_LOGARITHM


def test_a_generator_repeats_samples_to_the_bit_and_no_other_chance_is_taken() -> None:
    before = torch.random.get_rng_state()
    (codes, pressure), (again, press_again), (other, _) = (STYLE.sample(9, torch_rng(seed)) for seed in (5, 5, 6))
    assert torch.equal(torch.random.get_rng_state(), before)
    assert torch.equal(again, codes)
    assert torch.equal(press_again, pressure)
    assert not torch.equal(other, codes)
    assert codes.dtype == pressure.dtype == torch.float32
    assert (codes.shape, pressure.shape) == ((9, NUMBERS), (9, 4))


def test_the_longest_sample_goes_where_there_is_most_room_and_keeps_its_length() -> None:
    room = torch.tensor([0.5, 0.001, 3.0, 0.01])
    codes, pressure = STYLE.sample_for(room, torch_rng(3))
    drawn_anyway, press_anyway = STYLE.sample(4, torch_rng(3))
    order = drawn_anyway[:, 0].argsort()
    assert torch.equal(codes[room.argsort()], drawn_anyway[order])
    assert torch.equal(pressure[room.argsort()], press_anyway[order])


def test_a_stroke_of_the_hand_is_nearest_to_itself() -> None:
    paths = torch.from_numpy(STYLE.hand.paths)
    for drawn_paths in (paths, paths.float()):
        assert STYLE.nearest(drawn_paths).tolist() == list(range(len(paths)))


def test_strokes_are_drawn_around_those_of_the_hand_that_are_asked_for_and_the_longest_has_most_room() -> None:
    room, rows = torch.tensor([0.5, 0.001, 3.0, 0.01]), torch.tensor([7, 7, 2, 2])
    codes, pressure = STYLE.sample_for(room, torch_rng(3), rows)
    around, press_around = STYLE.sample_around(rows, torch_rng(3))
    order = around[:, 0].argsort()
    assert torch.equal(codes[room.argsort()], around[order])
    assert torch.equal(pressure[room.argsort()], press_around[order])


def test_no_strokes_are_no_codes_and_cost_nothing() -> None:
    codes, pressure = STYLE.sample(0, torch_rng())
    assert STYLE.decode(codes).shape == (0, 32, 2)
    assert STYLE.cost(codes, pressure).shape == (0,)


def test_strokes_are_found_again_in_their_codes_exactly() -> None:
    for paths in (STYLE.hand.paths, OTHERS[zigzag]):
        exact = torch.from_numpy(paths)
        again = STYLE.decode(STYLE.encode(exact))
        assert (again - exact).abs().max() < FLOAT64_ROUND_TRIP
        single = STYLE.decode(STYLE.encode(exact.float()))
        assert (single - exact).abs().max() < FLOAT32_ROUND_TRIP * exact.abs().max()


def test_a_1_in_any_number_of_a_code_is_what_is_usual_among_hands() -> None:
    codes = torch.cat([own(STYLES[one]) for one in KINDS])
    within = torch.stack([own(STYLES[one])[:, :GIST].std(dim=0) for one in KINDS]).square().mean(dim=0).sqrt()
    assert within.median().item() == pytest.approx(1, abs=0.5)
    assert codes[:, GIST:].square().mean(dim=0).sqrt().median().item() == pytest.approx(1, abs=0.3)


def test_decoding_has_the_gradient_of_finite_differences_in_its_gist() -> None:
    codes = own(STYLE)[:3]

    def decode(gist: Tensor) -> Tensor:
        return STYLE.decode(torch.cat([gist, codes[:, GIST:]], dim=1))

    assert torch.autograd.gradcheck(decode, codes[:, :GIST].clone().requires_grad_())


def test_no_gradient_of_a_path_flows_into_its_residual() -> None:
    codes = own(STYLE).requires_grad_()
    weights = torch.rand(len(codes), 32, 2, generator=torch_rng())
    (gradient,) = torch.autograd.grad((STYLE.decode(codes) * weights).sum(), codes)
    assert (gradient[:, :GIST] != 0).all()
    assert not gradient[:, GIST:].any()
    moved = codes.detach() + torch.cat([torch.zeros(GIST), torch.ones(RESIDUAL)])
    assert not torch.equal(STYLE.decode(moved), STYLE.decode(codes)), "it is drawn all the same"


def test_cost_has_the_gradient_of_finite_differences_apart_from_what_the_others_do() -> None:
    one = own(STYLE)[:1] + 0.1 * torch.rand(1, NUMBERS, generator=torch_rng(1), dtype=torch.float64)
    gist, residual = one[:, :GIST].clone().requires_grad_(), one[:, GIST:]
    pressure = torch.rand(1, 4, generator=torch_rng(), dtype=torch.float64, requires_grad=True)

    def cost(gist: torch.Tensor, pressure: torch.Tensor) -> torch.Tensor:
        return STYLE.cost(torch.cat([gist, residual], dim=1), pressure)

    assert torch.autograd.gradcheck(cost, (gist, pressure))


@pytest.mark.parametrize("one", KINDS)
def test_the_hands_own_strokes_cost_little_samples_more_and_strangers_much_more(one: Drawing) -> None:
    style = STYLES[one]
    codes, _ = style.sample(60, torch_rng(1))
    mine, sampled = costs(style, own(style)), costs(style, codes)
    assert 0 <= np.median(mine) < 6
    assert 2 * mine.mean() < sampled.mean() < 200
    kin = {arc, line_or_arc}  # half of the latter's strokes are like the former's
    for other in set(KINDS) - (kin if one in kin else {one}):
        stranger = costs(style, style.encode(torch.from_numpy(OTHERS[other])))
        assert np.median(stranger) > 10 * sampled.mean()


def test_no_gradient_of_the_cost_flows_into_a_residual() -> None:
    codes = own(STYLE).requires_grad_()
    STYLE.cost(codes, torch.rand(len(codes), 4, generator=torch_rng())).sum().backward()
    assert codes.grad is not None
    assert (codes.grad[:, GIST:] == 0).all()
    assert (codes.grad[:, :GIST] != 0).any()


def test_cost_grows_as_the_residual_does_or_shrinks() -> None:
    codes = own(STYLE)
    numbers = codes * torch.from_numpy(HANDS.units)
    for times in (3, 1 / 3):
        changed = numbers.clone()
        changed[:, GIST:] *= times
        assert (costs(STYLE, changed / torch.from_numpy(HANDS.units)) > costs(STYLE, codes) + 5).all()


def test_copies_of_one_stroke_cost_more_together_than_among_the_hands() -> None:
    codes = own(STYLE)
    among = costs(STYLE, codes)
    for row in (codes[:, 0].argmax(), codes[:, 0].argmin()):
        copies = codes[row].expand(len(codes), -1)
        assert costs(STYLE, copies).mean() > among[row] + 5


@pytest.mark.parametrize(("by", "sign"), [(1.3, 1), (1 / 1.3, -1)])
def test_strokes_that_are_all_too_long_are_pulled_back_and_too_short_ones_forth(by: float, sign: int) -> None:
    codes = longer(STYLE, by).requires_grad_()
    (gradient,) = torch.autograd.grad(STYLE.cost(codes, even(len(codes))).sum(), codes)
    assert (sign * gradient[:, 0] > 0).all()


def test_a_plan_that_takes_only_the_hands_longest_stroke_is_pulled_to_its_usual_lengths() -> None:
    codes = own(STYLE)
    for row, sign in ((codes[:, 0].argmax(), 1), (codes[:, 0].argmin(), -1)):
        copies = codes[row].repeat(len(codes), 1).requires_grad_()
        (gradient,) = torch.autograd.grad(STYLE.cost(copies, even(len(codes))).sum(), copies)
        assert sign * gradient[:, 0].sum() > 0


def test_the_order_of_strokes_is_nothing_to_their_cost() -> None:
    codes, pressure = STYLE.sample(30, torch_rng())
    order = torch.randperm(30, generator=torch_rng(1))
    assert STYLE.cost(codes[order], pressure[order]).numpy() == pytest.approx(
        STYLE.cost(codes, pressure)[order].numpy()
    )


def test_a_recorded_pressure_is_sampled_and_priced() -> None:
    falling = np.broadcast_to(np.linspace(0.8, 0.2, 32), (20, 32))
    style = Exemplar.fit("pressed", Hand.of(strokes_of(drawn(circle, 20), falling)), HANDS)
    codes, pressure = style.sample(10, torch_rng())
    assert pressure.numpy() == pytest.approx(np.tile(np.linspace(0.8, 0.2, 4), (10, 1)), abs=FLOAT32_ROUND_TRIP)
    assert (style.cost(codes, pressure.flip(1)) > style.cost(codes, pressure) + 5).all()


def test_speeds_are_those_of_the_strokes_most_like_them() -> None:
    slow, fast = drawn(line, 10), drawn(circle, 10)
    paths = np.concatenate([slow, fast])
    times = np.linspace(0, 1, 32) * np.repeat([4.0, 0.5], 10)[:, None]
    strokes = strokes_of(paths)
    style = Exemplar.fit("two", Hand.of(replace(strokes, times=times)), HANDS)
    speeds, strange = style.speeds(own(style)), style.speeds(style.encode(torch.from_numpy(drawn(circle, 5, seed=3))))
    assert speeds is not None
    assert strange is not None
    assert speeds.numpy() == pytest.approx(style.hand.speeds)
    assert strange.min() > speeds[:10].max()
    assert STYLE.speeds(own(STYLE)) is None


def test_the_hash_changes_with_what_a_code_decodes_to_and_only_with_that() -> None:
    assert STYLE.hash == exemplar_of(circle).hash
    assert STYLE.hash == STYLES[zigzag].hash, "whose hand it is does not matter to decoding"
    assert STYLE.hash == replace(STYLE, freedom=1.0, max_mean_cost=3.0, name="other").hash
    codes = own(STYLE)
    assert torch.equal(STYLES[zigzag].decode(codes), STYLE.decode(codes))
    for hands in (
        PooledHands(HANDS.covariance * 1.01, HANDS.residual),
        PooledHands(HANDS.covariance, HANDS.residual * 1.01),
    ):
        other = replace(STYLE, hands=hands)
        assert other.hash != STYLE.hash
        assert not torch.equal(other.decode(codes), STYLE.decode(codes))


@pytest.mark.parametrize("seed", range(3))
def test_straight_strokes_stay_straight_among_arcs(seed: int) -> None:
    style = Exemplar.fit("smooth", hand_of(drawn(line_or_arc, 20, seed, tremor=0.0)), HANDS)
    codes, _ = style.sample(300, torch_rng(seed))
    own, samples = (describe(paths)[:, 2] for paths in (style.hand.paths, style.decode(codes).double().numpy()))
    assert own[own < 0.5].max() < 0.1 < 1 < own[own > 0.5].min(), "half of them are straight"
    assert (samples < 0.1).mean() == pytest.approx((own < 0.5).mean(), abs=0.1)
    assert ((samples > 0.1) & (samples < 0.8)).mean() < 0.02


@pytest.mark.parametrize("seed", range(3))
def test_seven_curls_among_other_strokes_have_neither_cusps_nor_loops_that_they_never_had(seed: int) -> None:
    paths = np.concatenate([drawn(circle, 7, seed), drawn(zigzag, 7, seed), drawn(line, 6, seed)])
    style = Exemplar.fit("several", hand_of(paths), HANDS)
    codes, _ = style.sample(400, torch_rng(seed))
    samples = style.decode(codes).double().numpy()
    curls = cdist(standard(samples), standard(style.hand.paths)).argmin(axis=1) < 7
    assert curls.mean() == pytest.approx(7 / 20, abs=0.08)
    assert (sharpest(samples[curls]) > 1.3 * sharpest(style.hand.paths[:7]).max()).mean() < 0.02


def test_a_hand_that_trembles_mostly_has_freedom() -> None:
    noisy = [Exemplar.fit("noisy", hand_of(drawn(line_or_arc, 20, seed, tremor=0.05)), HANDS) for seed in range(6)]
    assert sum(style.freedom > 0 for style in noisy) >= 2


def test_a_hand_is_weighed_once_however_many_freedoms_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    weighed = []
    neighbours = exemplar.Neighbours
    monkeypatch.setattr(exemplar, "Neighbours", lambda *given: weighed.append(given) or neighbours(*given))
    bound = exemplar_of(zigzag)
    assert (bound.freedom, len(weighed)) == (0.0, 1)


def test_samples_are_about_as_rough_and_bent_as_the_hands_strokes_whatever_the_freedom() -> None:
    for tremor in (0.003, 0.05):
        style = Exemplar.fit("noisy", hand_of(drawn(line_or_arc, 30, 1, tremor=tremor)), HANDS)
        codes, _ = style.sample(500, torch_rng())
        found, own = (describe(x)[:, CURVINESS].T for x in (style.decode(codes).double().numpy(), style.hand.paths))
        assert max(ks_2samp(*columns).statistic for columns in zip(found, own, strict=True)) < 0.25


def test_without_freedom_samples_have_the_residuals_of_the_hands_strokes_and_with_it_new_ones() -> None:
    bound, free = (replace(STYLE, freedom=freedom).sample(60, torch_rng())[0] for freedom in (0.0, 1.0))
    assert torch.equal(bound[:, :GIST], free[:, :GIST])
    known = residual_directions(own(STYLE))
    assert (residual_directions(bound) @ known.T).amax(dim=1).numpy() == pytest.approx(1, abs=FLOAT32_ROUND_TRIP)
    assert (residual_directions(free) @ known.T).amax(dim=1).max() < 0.95


@pytest.mark.parametrize(
    "paths",
    [
        np.repeat(drawn(circle, 1), 20, axis=0),
        np.repeat(drawn(line, 1, tremor=0.0), 5, axis=0),
        drawn(line, 20, tremor=0.0) * (1, 0),
        drawn(circle, 5),
        drawn(zigzag, 6),
    ],
    ids=["all the same", "five of the same", "all straight", "five", "six"],
)
def test_a_hand_of_few_or_like_strokes_has_a_style(paths: np.ndarray) -> None:
    style = Exemplar.fit("few", hand_of(paths), HANDS)
    codes, pressure = style.sample(100, torch_rng())
    assert style.decode(codes).isfinite().all()
    lengths = style.decode(codes).diff(dim=1).norm(dim=-1).sum(1)
    assert 0.3 * style.decode(own(style)).diff(dim=1).norm(dim=-1).sum(1).min() < lengths.min()
    leaf = codes.requires_grad_()
    cost = style.cost(leaf, pressure)
    (gradient,) = torch.autograd.grad(cost.sum(), leaf)
    assert cost.isfinite().all()
    assert gradient.isfinite().all()
    assert np.median(costs(style, own(style))) < cost.mean()


def test_what_many_hands_have_in_common_is_within_them() -> None:
    apart = [hand_of(drawn(circle, 30, seed) * size) for seed, size in ((0, 1.0), (1, 10.0))]
    spread = np.sqrt(pool(apart).covariance[0, 0])
    assert spread == pytest.approx(0.2, abs=0.08), "a hand's lengths, and not how much hands differ"


def test_a_hand_counts_in_what_is_pooled_by_its_strokes_up_to_sixty() -> None:
    few, many, more = (hand_of(drawn(one, n)) for one, n in ((circle, 20), (zigzag, 60), (zigzag, 240)))

    def spread(hand: Hand) -> np.ndarray:
        numbers = shape.encode(torch.from_numpy(hand.paths))
        return np.cov(gist_and_roughness(*shape.parts(numbers)).numpy(), rowvar=False)

    assert pool([few, many]).covariance == pytest.approx((spread(few) + 3 * spread(many)) / 4)
    assert pool([few, more]).covariance == pytest.approx((spread(few) + 3 * spread(more)) / 4)
    assert pool([few]).residual.shape == (RESIDUAL,)


def test_a_style_is_as_strict_as_it_was_made() -> None:
    assert STYLE.max_mean_cost == 1.0
    assert replace(STYLE, max_mean_cost=float("inf")).max_mean_cost == float("inf")
    assert isinstance(STYLE, Style)
    assert STYLE.name == "circle"
