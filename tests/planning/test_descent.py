import torch

from maulstick.planning.descent import Descent
from maulstick.planning.parameters import StrokeParameters


def strokes(count: int) -> StrokeParameters:
    torch_rng = torch.Generator().manual_seed(count)
    shapes = {"codes": (13,), "centres": (2,), "angles": (), "pressure_knots": (4,), "colours": (3,)}
    tensors = {k: torch.rand(count, *shape, generator=torch_rng) * 0.5 + 0.25 for k, shape in shapes.items()}
    leaves = {k: x.requires_grad_() for k, x in tensors.items()}
    return StrokeParameters(**leaves, brush_of=torch.zeros(count, dtype=torch.long))


def pull(parameters: StrokeParameters, way: float) -> torch.Tensor:
    return torch.stack([way * x.sum() for x in parameters.each().values()]).sum()


def test_a_step_goes_down_the_loss_by_the_rate_of_each_parameter() -> None:
    descent = Descent(strokes(5), spacing=0.01, lightest=torch.zeros(1))
    before = {k: x.detach().clone() for k, x in descent.strokes.each().items()}
    for _ in range(30):
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
    assert torch.equal(descent.strokes.brush_of, before.pop("brush_of"))
    for name in before:
        tensor = descent.strokes.each()[name]
        assert (tensor <= before[name]).all(), name
        assert (tensor < before[name]).any(), name


def test_strokes_that_turn_by_a_share_of_the_rate_turn_by_so_much_less() -> None:
    turned = []
    for turning in (1.0, 0.3):
        descent = Descent(strokes(5), spacing=0.01, lightest=torch.zeros(1), turning=turning)
        before = {k: x.detach().clone() for k, x in descent.strokes.each().items()}
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
        turned.append({k: x.detach() - before[k] for k, x in descent.strokes.each().items()})
    assert torch.allclose(turned[1].pop("angles"), 0.3 * turned[0].pop("angles"))
    assert all(torch.equal(moved, turned[0][k]) for k, moved in turned[1].items())


def test_pressure_and_colours_stay_between_0_and_1() -> None:
    descent = Descent(strokes(5), spacing=0.01, lightest=torch.zeros(1))
    for way in (1.0, -1.0):
        for _ in range(120):
            descent.step(pull(descent.strokes, way), progress=0.0)
        for tensor in (descent.strokes.pressure_knots, descent.strokes.colours):
            assert (tensor == (way < 0)).all()


def test_no_stroke_becomes_lighter_than_its_brush_was_measured() -> None:
    own = strokes(4)
    own.brush_of[2:] = 1
    descent = Descent(own, spacing=0.01, lightest=torch.tensor([0.0, 0.2]))
    for _ in range(60):
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
    assert (descent.strokes.pressure_knots[:2] == 0).all()
    assert (descent.strokes.pressure_knots[2:] == 0.2).all()


def test_a_stroke_that_begins_anew_has_no_momentum_of_the_one_before() -> None:
    descent = Descent(strokes(5), spacing=0.01, lightest=torch.zeros(1))
    for _ in range(30):
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
    descent.replace(torch.tensor([2]), strokes(5)[torch.tensor([2])])
    before = descent.strokes.codes.detach().clone()
    descent.step(0.0 * pull(descent.strokes, 1.0), progress=0.0)
    moved = (descent.strokes.codes.detach() - before).abs().amax(dim=1)
    assert moved[2] == 0
    assert (moved[[0, 1, 3, 4]] > 0).all()


def test_paints_adapt_once_they_are_added_but_for_those_that_are_pinned() -> None:
    descent = Descent(strokes(3), spacing=0.01, lightest=torch.zeros(1))
    paints = torch.full((3, 3), 0.5, requires_grad=True)
    descent.add_paints(paints, torch.tensor([False, True, False]))
    descent.step(paints.sum() + pull(descent.strokes, 1.0), progress=0.0)
    assert (paints[[0, 2]] < 0.5).all()
    assert (paints[1] == 0.5).all()
