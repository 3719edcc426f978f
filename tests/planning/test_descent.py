import torch

from maulstick.planning.descent import Descent
from maulstick.planning.parameters import StrokeParameters


def strokes(count: int) -> StrokeParameters:
    torch_rng = torch.Generator().manual_seed(count)
    shapes = {"codes": (13,), "centres": (2,), "angles": (), "pressure_knots": (4,), "colours": (3,)}
    tensors = {k: torch.rand(count, *shape, generator=torch_rng) * 0.5 + 0.25 for k, shape in shapes.items()}
    return StrokeParameters(**{k: x.requires_grad_() for k, x in tensors.items()})


def pull(parameters: StrokeParameters, way: float) -> torch.Tensor:
    return torch.stack([way * x.sum() for x in parameters.each().values()]).sum()


def test_a_step_goes_down_the_loss_by_the_rate_of_each_parameter() -> None:
    descent = Descent(strokes(5), spacing=0.01)
    before = {k: x.detach().clone() for k, x in descent.strokes.each().items()}
    for _ in range(30):
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
    for name, tensor in descent.strokes.each().items():
        assert (tensor <= before[name]).all(), name
        assert (tensor < before[name]).any(), name


def test_pressure_and_colours_stay_between_0_and_1() -> None:
    descent = Descent(strokes(5), spacing=0.01)
    for way in (1.0, -1.0):
        for _ in range(120):
            descent.step(pull(descent.strokes, way), progress=0.0)
        for tensor in (descent.strokes.pressure_knots, descent.strokes.colours):
            assert (tensor == (way < 0)).all()


def test_a_stroke_that_begins_anew_has_no_momentum_of_the_one_before() -> None:
    descent = Descent(strokes(5), spacing=0.01)
    for _ in range(30):
        descent.step(pull(descent.strokes, 1.0), progress=0.0)
    descent.replace(torch.tensor([2]), strokes(5)[torch.tensor([2])], torch.tensor([0]))
    before = descent.strokes.codes.detach().clone()
    descent.step(0.0 * pull(descent.strokes, 1.0), progress=0.0)
    moved = (descent.strokes.codes.detach() - before).abs().amax(dim=1)
    assert moved[2] == 0
    assert (moved[[0, 1, 3, 4]] > 0).all()


def test_paints_adapt_once_they_are_added() -> None:
    descent, paints = Descent(strokes(3), spacing=0.01), torch.full((2, 3), 0.5, requires_grad=True)
    descent.add_paints(paints)
    descent.step(paints.sum() + pull(descent.strokes, 1.0), progress=0.0)
    assert (paints < 0.5).all()


def test_strokes_of_a_group_move_and_turn_as_one_and_keep_their_shapes() -> None:
    groups = torch.tensor([0, 0, 0, 1, 1, 2])
    descent = Descent(strokes(6), spacing=0.1, groups=groups)
    before = {name: tensor.detach().clone() for name, tensor in descent.strokes.each().items()}
    uneven = torch.linspace(-1, 2, 6)
    for _ in range(20):
        centres, angles = descent.strokes.centres, descent.strokes.angles
        loss = (uneven[:, None] * centres.square()).sum() + (uneven * angles).sum() + descent.strokes.codes.sum()
        descent.step(loss, progress=0.0)
    after = {name: tensor.detach() for name, tensor in descent.strokes.each().items()}
    assert torch.equal(after["codes"], before["codes"])
    for rows in ([0, 1, 2], [3, 4]):
        turned = (after["angles"] - before["angles"])[rows]
        assert torch.allclose(turned, turned[0], atol=1e-5)
        assert turned.abs().min() > 0.01
        apart = [torch.cdist(each["centres"][rows], each["centres"][rows]) for each in (before, after)]
        assert torch.allclose(*apart, rtol=0.02)
    assert (after["centres"] - before["centres"]).norm(dim=1).min() > 0.001


def test_strokes_that_begin_anew_make_groups_of_their_own() -> None:
    descent = Descent(strokes(5), spacing=0.1, groups=torch.tensor([0, 0, 1, 1, 1]))
    descent.replace(torch.tensor([0, 3]), strokes(5)[torch.tensor([0, 3])], torch.tensor([0, 0]))
    assert descent.groups is not None
    assert descent.groups.tolist() == [2, 0, 1, 2, 1]
