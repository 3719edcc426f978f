from dataclasses import replace

import pytest
import torch
from torch import Generator, Tensor

from maulstick.painting.brush import Brush
from maulstick.planning.from_picture import Image as Picture
from maulstick.planning.planner import Progress, plan
from maulstick.planning.problem import Commission, Weighted
from maulstick.planning.surrogate import Judgement
from tests.planning.conftest import commission, mse, options
from tests.planning.test_planner import rendered
from tests.support.planning.network_losses import Shifted
from tests.support.planning.tiny_network import noise
from tests.support.tolerances import FLOAT32_GRADIENT, FLOAT32_VALUE

TARGET, CANVAS = noise(0, 3, 12, 16).float(), noise(1, 3, 12, 16).float()
PAPER = torch.ones(3, 12, 16)


def chance() -> Generator:
    return Generator().manual_seed(0)


def asked(*judges: Weighted[Shifted], canvas: Tensor = CANVAS) -> Judgement:
    judgement = Judgement(judges, PAPER)
    judgement.ask(canvas, chance())
    return judgement


def slope_of(loss: Tensor, canvas: Tensor) -> Tensor:
    return torch.autograd.grad(loss, canvas)[0]


@pytest.fixture
def painted() -> Tensor:
    return CANVAS.clone().requires_grad_()


def test_where_judges_were_asked_their_loss_and_slope_are_what_they_said(painted: Tensor) -> None:
    judge = Shifted(TARGET)
    loss = asked(Weighted(judge, 0.5)).loss(painted)
    said = 0.5 * judge.losses(painted, judge.asked[0]).mean()
    assert loss.item() == pytest.approx(said.item(), abs=FLOAT32_VALUE)
    wanted = slope_of(said, painted)
    assert slope_of(loss, painted) == pytest.approx(wanted, abs=FLOAT32_GRADIENT * wanted.abs().max().item())


def test_between_calls_their_loss_is_a_line_and_a_pull_back_to_where_they_were_asked(painted: Tensor) -> None:
    judgement = asked(Weighted(Shifted(TARGET), 1.0))
    here = judgement.loss(painted)
    slope = slope_of(here, painted)
    away = noise(2, *CANVAS.shape).float() - 0.5
    line = (slope * away).sum().item()
    ahead, behind, twice = (judgement.loss(CANVAS + share * away).item() - here.item() for share in (0.1, -0.1, 0.2))
    pull = (ahead + behind) / 2
    assert pull > 0
    assert (ahead - behind) / 2 == pytest.approx(0.1 * line, rel=1e-3, abs=FLOAT32_VALUE)
    assert twice == pytest.approx(0.2 * line + 4 * pull, rel=1e-3, abs=FLOAT32_VALUE)


def test_nothing_is_asked_to_tell_the_loss(painted: Tensor) -> None:
    judge = Shifted(TARGET)
    judgement = asked(Weighted(judge, 1.0))
    for _ in range(3):
        judgement.loss(painted).backward()
    assert (judgement.calls, len(judge.asked)) == (1, 1)


def test_several_judges_add_up_and_each_is_told_apart(painted: Tensor) -> None:
    other = Shifted(TARGET.flip(2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Shifted, "name", property(lambda self: "other" if self is other else "shifted"))
        judgement = asked(Weighted(Shifted(TARGET), 0.5), Weighted(other, 2.0))
        assert set(judgement.parts) == {"shifted", "other"}
        assert judgement.loss(painted).item() == pytest.approx(sum(judgement.parts.values()), rel=1e-5)


def test_a_call_goes_through_different_views_of_those_that_there_are() -> None:
    judge = Shifted(TARGET)
    judgement, views = Judgement([Weighted(judge, 1.0)], PAPER), chance()
    for _ in range(20):
        judgement.ask(CANVAS, views)
    assert judgement.calls == len(judge.asked) == 20
    assert all(len(set(call)) == len(call) for call in judge.asked)
    assert {view for call in judge.asked for view in call} == set(range(judge.views))


def test_the_proposal_is_a_canvas_that_judges_like_better() -> None:
    judge = Shifted(TARGET)
    judgement = asked(Weighted(judge, 1.0))
    proposal = judgement.proposal
    assert proposal.shape == CANVAS.shape
    assert 0 <= proposal.min() < proposal.max() <= 1
    views = range(judge.views)
    assert judge.losses(proposal, views).mean() < judge.losses(CANVAS, views).mean()


def led_by(judge: Shifted, portrait: Picture, brush: Brush) -> Commission:
    """What the judge alone wants, without a picture."""
    return replace(commission(portrait, brush), target=None, objectives=(), judges=(Weighted(judge, 1.0),))


@pytest.mark.parametrize(("every", "calls"), [(1, 40), (7, 6), (40, 1), (1000, 1)])
def test_judges_are_asked_every_so_many_steps(portrait: Picture, round_brush: Brush, every: int, calls: int) -> None:
    picture = commission(portrait, round_brush)
    assert picture.target is not None
    judge = Shifted(picture.target)
    plan(replace(picture, judges=(Weighted(judge, 0.5),)), options(steps=40, ask_every=every))
    assert len(judge.asked) == calls


def test_a_plan_that_only_judges_lead_comes_nearer_to_what_they_want(portrait: Picture, round_brush: Brush) -> None:
    wanted = commission(portrait, round_brush).target
    assert wanted is not None
    alone = led_by(Shifted(wanted, views=1), portrait, round_brush)
    losses: list[float] = []

    def watch(progress: Progress) -> bool:
        losses.append(progress.parts["shifted"])
        return True

    found = rendered(alone, plan(alone, options(steps=150, ask_every=5), watch))
    assert mse(found, wanted) < 0.5 * mse(alone.paper, wanted)
    assert losses[-1] < 0.5 * losses[0]


def test_judges_improve_on_the_picture_in_what_they_look_for(portrait: Picture, round_brush: Brush) -> None:
    """One of six views each is moved: what suits them all is between, and not where the picture alone leads."""
    picture = commission(portrait, round_brush)
    assert picture.target is not None
    judge = Shifted(picture.target, views=6)
    without, beside = (
        rendered(each, plan(each, options(steps=100, ask_every=5)))
        for each in (picture, replace(picture, judges=(Weighted(judge, 2.0),)))
    )
    views = range(judge.views)
    assert judge.losses(beside, views).mean() < judge.losses(without, views).mean()
