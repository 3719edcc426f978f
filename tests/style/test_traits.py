import numpy as np
import pytest
import torch
from torch.autograd import gradcheck

from maulstick.painting.raster import Canvas
from maulstick.strokes.strokes import path_lengths
from maulstick.style.compare import describe
from maulstick.style.free import FreeStyle
from maulstick.style.style import Style
from maulstick.style.train import fine_tune, pretrained
from maulstick.style.traits import chord_and_turning, path_length
from tests.support.style.synthetic_hands import circle, drawn, exemplar_of, hand_of, line, zigzag

PATHS = np.concatenate([drawn(circle, 5), drawn(zigzag, 5)])


def test_length_chord_and_turning_are_those_of_a_description() -> None:
    paths = torch.from_numpy(PATHS)
    assert path_length(paths).numpy() == pytest.approx(path_lengths(PATHS))
    assert chord_and_turning(paths).numpy() == pytest.approx(describe(PATHS)[:, 1:3], rel=2e-3)


def test_slopes_of_chord_and_turning_are_those_of_finite_differences() -> None:
    assert gradcheck(chord_and_turning, torch.from_numpy(PATHS[::4]).requires_grad_(), eps=1e-8, atol=1e-2, rtol=1e-3)


def test_a_straight_stroke_and_a_dot_have_finite_slopes() -> None:
    line = torch.stack([torch.linspace(0, 0.1, 32), torch.zeros(32)], dim=-1)
    paths = torch.stack([line, torch.zeros_like(line)]).requires_grad_()
    found = chord_and_turning(paths)
    assert found[0].tolist() == pytest.approx([1, 0], abs=0.05)
    found.sum().backward()
    assert paths.grad is not None
    assert paths.grad.isfinite().all()


@pytest.mark.parametrize("kind", ["exemplar", "trajvae", "free"])
def test_strokes_of_any_style_are_given_other_lengths(kind: str) -> None:
    styles: dict[str, Style] = {
        "exemplar": exemplar_of(circle),
        "trajvae": fine_tune(pretrained(), hand_of(drawn(line, 20)), seed=0, steps=5),
        "free": FreeStyle.for_canvas(Canvas(0.2, 0.16, 1000.0)),
    }
    style = styles[kind]
    codes, _ = style.sample(12, torch.Generator().manual_seed(0))
    before = style.decode(codes)
    wanted = path_length(before).double() * torch.linspace(0.7, 1.4, 12, dtype=torch.float64)
    style.resize(codes, wanted, path_length(before))
    assert path_length(style.decode(codes)).numpy() == pytest.approx(wanted.numpy(), rel=0.02)
    if kind != "trajvae":
        scale = (wanted / path_length(before).double())[:, None, None]
        assert style.decode(codes).numpy() == pytest.approx((before * scale).numpy(), abs=1e-6)


def test_the_lengths_of_a_drawing_are_the_hands_and_of_one_stroke_its_median() -> None:
    style = exemplar_of(circle)
    own = path_lengths(style.hand.paths)
    lengths = style.lengths(1000).numpy()
    assert (np.diff(lengths) >= 0).all()
    assert own.min() <= lengths[0] < lengths[-1] <= own.max()
    assert lengths.mean() == pytest.approx(own.mean(), rel=0.01)
    assert style.lengths(1).item() == pytest.approx(np.median(own))
