import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from torch import Tensor

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.strokes.strokes import resample, standardise
from maulstick.style import Style, load_style
from maulstick.style.free import FreeStyle
from tests.support.tolerances import FLOAT32_METRES, FLOAT64_METRES

STYLE = FreeStyle(shortest=0.004, longest=0.1)
CODE = 13
UPRIGHT = Canvas(0.2, 0.1, 1000)
NO_PRESS = torch.zeros(1, 4)

codes = st.integers(0, 5).flatmap(lambda n: arrays(np.float32, (n, CODE), elements=st.floats(-4, 4, width=32)))


def lengths(paths: Tensor) -> Tensor:
    return paths.diff(dim=1).norm(dim=-1).sum(1)


def straight(length: float, dtype: torch.dtype = torch.float32) -> Tensor:
    """The code (1, 13) of a straight stroke with control points at equal distances."""
    along = torch.linspace(0, 1, 8, dtype=dtype)[1:-1] * length
    inner = torch.stack([along, torch.zeros_like(along)], dim=1).flatten()
    return torch.cat([torch.tensor([length], dtype=dtype), inner])[None] / STYLE.unit


def bent(length: float, bend: float) -> Tensor:
    """A straight code whose middle is pushed aside by `bend`, as a share of its length."""
    code = straight(length)
    push = torch.sin(torch.linspace(0, torch.pi, 8)[1:-1]) * bend * length / STYLE.unit
    code[:, 2::2] += push
    return code


def human_paths() -> Tensor:
    """Smooth strokes of some 50 mm as a hand draws them, (40, 32, 2): an arc, a hook or an S, with a slight tremor."""
    rng = np.random.default_rng(0)
    t = np.linspace(0, 1, 400)
    paths = []
    for _ in range(40):
        turn = rng.normal(0, 1.2) * t + rng.normal(0, 0.8) * np.sin(np.pi * t + rng.uniform(0, 6))
        turn += 0.03 * np.sin(2 * np.pi * rng.uniform(2, 4) * t)
        steps = rng.uniform(0.03, 0.07) / len(t)
        path = np.cumsum(np.stack([np.cos(turn), np.sin(turn)], axis=1) * steps, axis=0)
        paths.append(resample(path))
    return torch.from_numpy(standardise(np.stack(paths))[0])


@given(codes)
def test_every_code_decodes_to_a_standardised_path(code: np.ndarray) -> None:
    paths = STYLE.decode(torch.from_numpy(code))
    assert paths.shape == (len(code), 32, 2)
    assert paths.isfinite().all()
    assert torch.equal(paths[:, 0], torch.zeros(len(code), 2))
    assert torch.equal(paths[:, -1, 1], torch.zeros(len(code)))
    assert torch.allclose(paths[:, -1, 0], torch.from_numpy(np.abs(code[:, 0]) * np.float32(STYLE.unit)), rtol=1e-6)


@given(codes)
def test_encoding_a_decoded_path_gives_a_code_of_the_same_path(code: np.ndarray) -> None:
    paths = STYLE.decode(torch.from_numpy(code))
    again = STYLE.decode(STYLE.encode(paths))
    assert torch.allclose(again, paths, rtol=0, atol=4 * FLOAT32_METRES)


@given(codes)
def test_a_code_with_a_chord_to_the_right_is_found_again(code: np.ndarray) -> None:
    code[:, 0] = np.abs(code[:, 0])
    exact = torch.from_numpy(code).double()
    assert torch.allclose(STYLE.encode(STYLE.decode(exact)), exact, rtol=0, atol=1e-12)


def test_decoding_repeats_to_the_bit_and_changes_nothing() -> None:
    code = torch.randn(50, CODE, generator=torch.Generator().manual_seed(0))
    before = code.clone()
    torch_rng = torch.random.get_rng_state()
    paths = STYLE.decode(code)
    assert torch.equal(STYLE.decode(code), paths)
    assert torch.equal(FreeStyle(STYLE.shortest, STYLE.longest).decode(code), paths), "another object, the same style"
    for i in range(0, 50, 7):
        assert torch.allclose(STYLE.decode(code[i : i + 1])[0], paths[i], rtol=0, atol=FLOAT32_METRES)
    assert torch.equal(code, before)
    assert torch.equal(torch.random.get_rng_state(), torch_rng)


def test_smooth_strokes_of_a_hand_are_encoded_to_a_fraction_of_a_millimetre() -> None:
    paths = human_paths()
    errors = (STYLE.decode(STYLE.encode(paths)) - paths).norm(dim=-1)
    assert 0.02 < lengths(paths).min() < lengths(paths).max() < 0.08
    assert errors.median() < 0.1e-3
    assert errors.max() < 0.5e-3


def test_decode_and_cost_have_the_gradients_of_finite_differences() -> None:
    generator = torch.Generator().manual_seed(1)
    code = torch.randn(3, CODE, generator=generator, dtype=torch.float64)
    code[:, 0] = torch.tensor([0.7, -1.1, 6.0])
    pressure = torch.rand(3, 4, generator=generator, dtype=torch.float64)
    assert torch.autograd.gradcheck(STYLE.decode, code.requires_grad_())
    assert torch.autograd.gradcheck(STYLE.cost, (code, pressure.requires_grad_()))
    small = (code.detach() * 1e-3).requires_grad_()
    assert STYLE.cost(small, pressure).min() > 100, "these are too short"
    assert torch.autograd.gradcheck(STYLE.cost, (small, pressure), eps=1e-9, atol=1e-2)


def test_a_stroke_of_no_length_costs_much_and_has_finite_gradients() -> None:
    code = torch.zeros(2, CODE, requires_grad=True)
    cost = STYLE.cost(code, torch.zeros(2, 4))
    assert (cost > 1000).all()
    (gradient,) = torch.autograd.grad(cost.sum() + STYLE.decode(code).sum(), code)
    assert gradient.isfinite().all()


def test_samples_repeat_with_their_generator_and_take_no_other_chance() -> None:
    torch_rng = torch.random.get_rng_state()
    code, pressure = STYLE.sample(20, torch.Generator().manual_seed(5))
    torch.manual_seed(99)
    again, press_again = STYLE.sample(20, torch.Generator().manual_seed(5))
    torch.random.set_rng_state(torch_rng)
    other, _ = STYLE.sample(20, torch.Generator().manual_seed(6))
    assert torch.equal(again, code)
    assert torch.equal(press_again, pressure)
    assert not torch.equal(other, code)
    generator = torch.Generator().manual_seed(5)
    first, _ = STYLE.sample(20, generator)
    second, _ = STYLE.sample(20, generator)
    assert not torch.equal(first, second), "a generator moves on"


def test_samples_have_even_pressure_and_fill_the_limits_of_length() -> None:
    code, pressure = STYLE.sample(4000, torch.Generator().manual_seed(0))
    assert code.shape == (4000, CODE)
    assert pressure.shape == (4000, 4)
    assert (pressure >= 0).all()
    assert (pressure <= 1).all()
    assert torch.equal(pressure, pressure[:, :1].expand(-1, 4))
    assert pressure[:, 0].std() > 0.2
    drawn = lengths(STYLE.decode(code))
    assert drawn.min() < 1.1 * STYLE.shortest
    assert drawn.max() > 0.9 * STYLE.longest
    middle = (STYLE.shortest * STYLE.longest) ** 0.5
    assert 0.45 < (drawn < middle).float().mean() < 0.55, "lengths are even in their logarithm"


def test_samples_stay_within_the_limits_of_length() -> None:
    code, _ = STYLE.sample(4000, torch.Generator().manual_seed(0))
    drawn = lengths(STYLE.decode(code))
    assert drawn.min() >= STYLE.shortest * (1 - 1e-5)
    assert drawn.max() <= STYLE.longest * (1 + 1e-5)


def test_no_samples_are_no_codes() -> None:
    code, pressure = STYLE.sample(0, torch.Generator())
    assert STYLE.decode(code).shape == (0, 32, 2)
    assert STYLE.cost(code, pressure).shape == (0,)


@pytest.mark.parametrize("length", [0.005, 0.03, 0.099])
def test_a_straight_even_stroke_within_the_limits_costs_nothing(length: float) -> None:
    for pressure in (0.0, 0.7):
        cost = STYLE.cost(straight(length), torch.full((1, 4), pressure))
        assert cost.shape == (1,)
        assert 0 <= cost.item() < 1e-5


def test_cost_grows_with_bending_whichever_side_and_size() -> None:
    costs = [STYLE.cost(bent(0.03, bend), NO_PRESS).item() for bend in (0, 0.05, 0.1, 0.2, 0.4)]
    assert costs == sorted(costs)
    assert costs[-1] > 10 * costs[1] > 1e-2
    assert STYLE.cost(bent(0.03, -0.2), NO_PRESS).item() == pytest.approx(costs[3], rel=1e-5)
    assert STYLE.cost(bent(0.06, 0.2), NO_PRESS).item() == pytest.approx(costs[3], rel=1e-5)


def test_cost_grows_as_a_length_leaves_the_limits() -> None:
    longer = [STYLE.cost(straight(0.1 * factor), NO_PRESS).item() for factor in (0.99, 1.1, 1.5, 3)]
    shorter = [STYLE.cost(straight(0.004 / factor), NO_PRESS).item() for factor in (0.99, 1.1, 1.5, 3)]
    for costs in (longer, shorter):
        assert costs == sorted(costs)
        assert costs[0] < 1e-5
        assert costs[1] > 0.1
    assert longer[1:] == pytest.approx(shorter[1:], rel=1e-3), "twice too long is as bad as twice too short"


def test_cost_grows_with_changes_of_pressure_and_not_with_pressure() -> None:
    def cost(*knots: float) -> float:
        return STYLE.cost(straight(0.03), torch.tensor([knots])).item()

    assert cost(0, 0.1, 0.2, 0.3) == pytest.approx(0.03, rel=1e-4)
    assert cost(0, 0.5, 0, 0.5) > cost(0, 0.5, 0.5, 0.5) > cost(0.5, 0.5, 0.5, 0.5) + 0.2


@settings(max_examples=30)
@given(codes)
def test_each_stroke_costs_what_it_costs_alone(code: np.ndarray) -> None:
    tensor, pressure = torch.from_numpy(code), torch.rand(len(code), 4, generator=torch.Generator().manual_seed(0))
    together = STYLE.cost(tensor, pressure)
    assert together.shape == (len(code),)
    assert (together >= 0).all()
    for i in range(len(code)):
        alone = STYLE.cost(tensor[i : i + 1], pressure[i : i + 1])
        assert together[i].item() == pytest.approx(alone.item(), rel=1e-5)


def test_the_hash_changes_with_what_a_code_decodes_to_and_only_with_that() -> None:
    assert STYLE.hash == FreeStyle(0.004, 0.1).hash
    assert STYLE.hash != FreeStyle(0.004, 0.1001).hash
    assert STYLE.hash == FreeStyle(0.005, 0.1).hash, "the shortest stroke is not a matter of decoding"
    code = straight(0.03)
    assert torch.equal(FreeStyle(0.005, 0.1).decode(code), STYLE.decode(code))
    assert not torch.equal(FreeStyle(0.004, 0.1001).decode(code), STYLE.decode(code))


@pytest.mark.parametrize(
    ("shortest", "longest", "text"),
    [
        (0.1, 0.05, "100 to 50 mm"),
        (0.0, 0.05, "0 to 50 mm"),
        (-0.01, 0.05, "-10 to 50 mm"),
        (0.02, 0.02, "20 to 20 mm"),
    ],
)
def test_limits_that_allow_no_length_are_refused(shortest: float, longest: float, text: str) -> None:
    with pytest.raises(InputError) as caught:
        FreeStyle(shortest, longest)
    assert str(caught.value) == f"the length of a stroke is {text}; it must be a range of lengths above 0"


def test_limits_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="range of lengths above 0"):
        FreeStyle(0.01, float("nan"))


def test_the_free_style_is_loaded_by_name_with_strokes_of_a_size_for_the_canvas() -> None:
    style = load_style("free", UPRIGHT)
    assert isinstance(style, Style)
    assert style == FreeStyle(shortest=0.002, longest=0.05)
    assert style.name == "free"
    assert load_style("free", Canvas(0.1, 0.2, 77)) == style


def test_an_unknown_style_is_refused_with_those_there_are() -> None:
    with pytest.raises(InputError) as caught:
        load_style("vermeer", UPRIGHT)
    assert str(caught.value).startswith("there is no style 'vermeer'; there are: ")
    assert "free" in str(caught.value).split("there are: ")[1].split(", ")


def test_float64_paths_are_decoded_in_float64() -> None:
    code = straight(0.05, torch.float64)
    path = STYLE.decode(code)
    assert path.dtype == torch.float64
    assert path[0, -1, 0].item() == pytest.approx(0.05, abs=FLOAT64_METRES)
    assert path[0, :, 1].abs().max().item() <= FLOAT64_METRES


def test_the_free_style_fills_the_room_there_is_within_its_limits() -> None:
    room = torch.tensor([0.0001, 0.004, 0.02, 0.09, 0.1, 5.0])
    code, pressure = STYLE.sample_for(room, torch.Generator().manual_seed(0))
    drawn = lengths(STYLE.decode(code))
    assert drawn.numpy() == pytest.approx([0.004, 0.004, 0.02, 0.09, 0.1, 0.1], rel=1e-5)
    assert torch.equal(pressure, pressure[:, :1].expand(-1, 4))
    again, press_again = STYLE.sample_for(room, torch.Generator().manual_seed(0))
    assert torch.equal(again, code)
    assert torch.equal(press_again, pressure)


def test_the_free_style_binds_nobody_and_knows_no_speeds() -> None:
    code, _ = STYLE.sample(3, torch.Generator().manual_seed(0))
    assert STYLE.max_mean_cost == float("inf")
    assert STYLE.speeds(code) is None
