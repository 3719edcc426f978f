from dataclasses import replace

import pytest
import torch
from torch import Generator, Tensor

from maulstick.painting.brush import Brush
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlanningProblem, Weighted
from maulstick.planning.result import PlanProgress
from maulstick.planning.surrogate import Surrogate
from maulstick.storage.arrays import Image as Picture
from tests.planning.conftest import mse, options, problem_for
from tests.planning.test_planner import rendered
from tests.support.planning.network_losses import Shifted
from tests.support.planning.tiny_network import noise
from tests.support.tolerances import FLOAT32_GRADIENT, FLOAT32_VALUE

TARGET, CANVAS = noise(0, 3, 12, 16).float(), noise(1, 3, 12, 16).float()
PAPER = torch.ones(3, 12, 16)


def torch_rng() -> Generator:
    return Generator().manual_seed(0)


def called(*network_losses: Weighted[Shifted], canvas: Tensor = CANVAS) -> Surrogate:
    surrogate = Surrogate(network_losses, PAPER)
    surrogate.ask(canvas, torch_rng())
    return surrogate


def slope_of(loss: Tensor, canvas: Tensor) -> Tensor:
    return torch.autograd.grad(loss, canvas)[0]


@pytest.fixture
def painted() -> Tensor:
    return CANVAS.clone().requires_grad_()


def test_at_the_canvas_of_a_call_loss_and_slope_are_those_of_the_network_losses(painted: Tensor) -> None:
    network_loss = Shifted(TARGET)
    loss = called(Weighted(network_loss, 0.5)).loss(painted)
    value = 0.5 * network_loss.losses(painted, network_loss.calls[0]).mean()
    assert loss.item() == pytest.approx(value.item(), abs=FLOAT32_VALUE)
    wanted = slope_of(value, painted)
    assert slope_of(loss, painted) == pytest.approx(wanted, abs=FLOAT32_GRADIENT * wanted.abs().max().item())


def test_between_calls_the_loss_is_a_line_and_a_pull_back_to_the_canvas_of_the_call(painted: Tensor) -> None:
    surrogate = called(Weighted(Shifted(TARGET), 1.0))
    here = surrogate.loss(painted)
    slope = slope_of(here, painted)
    away = noise(2, *CANVAS.shape).float() - 0.5
    line = (slope * away).sum().item()
    ahead, behind, twice = (surrogate.loss(CANVAS + share * away).item() - here.item() for share in (0.1, -0.1, 0.2))
    pull = (ahead + behind) / 2
    assert pull > 0
    assert (ahead - behind) / 2 == pytest.approx(0.1 * line, rel=1e-3, abs=FLOAT32_VALUE)
    assert twice == pytest.approx(0.2 * line + 4 * pull, rel=1e-3, abs=FLOAT32_VALUE)


def test_the_modelled_loss_calls_no_network(painted: Tensor) -> None:
    network_loss = Shifted(TARGET)
    surrogate = called(Weighted(network_loss, 1.0))
    for _ in range(3):
        surrogate.loss(painted).backward()
    assert (surrogate.calls, len(network_loss.calls)) == (1, 1)


def test_several_network_losses_add_up_and_each_has_its_part(painted: Tensor) -> None:
    other = Shifted(TARGET.flip(2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Shifted, "name", property(lambda self: "other" if self is other else "shifted"))
        surrogate = called(Weighted(Shifted(TARGET), 0.5), Weighted(other, 2.0))
        assert set(surrogate.parts) == {"shifted", "other"}
        assert surrogate.loss(painted).item() == pytest.approx(sum(surrogate.parts.values()), rel=1e-5)


def test_a_call_goes_through_different_views_of_those_that_there_are() -> None:
    network_loss = Shifted(TARGET)
    surrogate, views = Surrogate([Weighted(network_loss, 1.0)], PAPER), torch_rng()
    for _ in range(20):
        surrogate.ask(CANVAS, views)
    assert surrogate.calls == len(network_loss.calls) == 20
    assert all(len(set(call)) == len(call) for call in network_loss.calls)
    assert {view for call in network_loss.calls for view in call} == set(range(network_loss.views))


def test_the_proposal_is_a_canvas_that_network_losses_like_better() -> None:
    network_loss = Shifted(TARGET)
    surrogate = called(Weighted(network_loss, 1.0))
    proposal = surrogate.proposal
    assert proposal.shape == CANVAS.shape
    assert 0 <= proposal.min() < proposal.max() <= 1
    views = range(network_loss.views)
    assert network_loss.losses(proposal, views).mean() < network_loss.losses(CANVAS, views).mean()


def led_by(network_loss: Shifted, portrait: Picture, brush: Brush) -> PlanningProblem:
    """Return a problem of the network loss alone, without a picture."""
    return replace(
        problem_for(portrait, brush), target=None, objectives=(), network_losses=(Weighted(network_loss, 1.0),)
    )


@pytest.mark.parametrize(("every", "calls"), [(1, 40), (7, 6), (40, 1), (1000, 1)])
def test_network_losses_are_called_every_so_many_steps(
    portrait: Picture, round_brush: Brush, every: int, calls: int
) -> None:
    picture = problem_for(portrait, round_brush)
    assert picture.target is not None
    network_loss = Shifted(picture.target)
    plan(replace(picture, network_losses=(Weighted(network_loss, 0.5),)), options(steps=40, ask_every=every))
    assert len(network_loss.calls) == calls


def test_a_plan_that_only_network_losses_lead_comes_nearer_to_what_they_want(
    portrait: Picture, round_brush: Brush
) -> None:
    wanted = problem_for(portrait, round_brush).target
    assert wanted is not None
    alone = led_by(Shifted(wanted, views=1), portrait, round_brush)
    losses: list[float] = []

    def watch(progress: PlanProgress) -> bool:
        losses.append(progress.parts["shifted"])
        return True

    found = rendered(alone, plan(alone, options(steps=150, ask_every=5), watch))
    assert mse(found, wanted) < 0.5 * mse(alone.paper, wanted)
    assert losses[-1] < 0.5 * losses[0]


def test_network_losses_improve_on_the_picture_in_what_they_look_for(portrait: Picture, round_brush: Brush) -> None:
    """One of six views each is moved: what suits them all is between, and not where the picture alone leads."""
    picture = problem_for(portrait, round_brush)
    assert picture.target is not None
    network_loss = Shifted(picture.target, views=6)
    without, beside = (
        rendered(each, plan(each, options(steps=100, ask_every=5)))
        for each in (picture, replace(picture, network_losses=(Weighted(network_loss, 2.0),)))
    )
    views = range(network_loss.views)
    assert network_loss.losses(beside, views).mean() < network_loss.losses(without, views).mean()
