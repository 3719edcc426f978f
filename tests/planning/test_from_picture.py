import hashlib
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from skimage.data import astronaut

from maulstick.colour.palette import lightness
from maulstick.painting.brush import Brush
from maulstick.painting.metrics import Metrics
from maulstick.painting.painting import OFF_SHEET, Painting, Provenance, Sheet, hex_colour
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, metrics_of, problem_of, provenance_of, with_metrics
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.tones import Tones
from maulstick.rendering.preview import preview, truth
from maulstick.storage.arrays import Image as Picture
from maulstick.strokes import strokes
from maulstick.style import load_style
from tests.planning.conftest import QUICK, options
from tests.support.nominal import nominal
from tests.support.tolerances import FILE_METRES, LIGHTNESS_DRIFT

NO_NETWORK = LossOptions(weights={"likeness": 0.0})


def painted(layout: Layout, brush: Brush, wanted: PlannerSettings = QUICK) -> Painting:
    style = load_style("free", layout.canvas)
    problem = problem_of(layout, (brush,), style, wanted, NO_NETWORK)
    return as_painting(plan(problem, wanted), layout, (brush,), style, provenance_of(wanted, "a.jpg"))


def likeness(painting: Painting, layout: Layout) -> Metrics:
    metrics = metrics_of(painting, layout)
    assert metrics is not None
    return metrics


def bare(painting: Painting) -> Painting:
    return painting.model_copy(update={"strokes": ()})


@pytest.fixture(scope="module")
def layout(portrait: Picture, round_brush: Brush) -> Layout:
    """The portrait on a square sheet, so that there is bare paper above and below."""
    return lay_out_for(portrait, Sheet(width=0.103, height=0.103), round_brush, height_px=48)


@pytest.fixture(scope="module")
def painting(layout: Layout, round_brush: Brush) -> Painting:
    return painted(layout, round_brush)


@pytest.fixture(scope="module")
def file(painting: Painting, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "painting.json"
    write_painting(painting, path)
    return path


def test_a_photograph_becomes_a_painting_like_it(painting: Painting, layout: Layout) -> None:
    metrics, blank = likeness(painting, layout), likeness(bare(painting), layout)
    assert metrics.psnr > 15
    assert metrics.mse < 0.2 * blank.mse
    assert metrics.ssim > 0.3 + blank.ssim


def test_figures_are_taken_over_the_picture_and_not_the_paper_around_it(painting: Painting, layout: Layout) -> None:
    image = truth(painting, layout.canvas)
    crop = layout.crop(image)
    assert crop.shape == (48, 60, 3)
    assert crop.shape[0] < image.shape[0]
    expected = np.mean((crop.astype(np.float64) - layout.crop(layout.target)) ** 2)
    assert likeness(painting, layout).mse == pytest.approx(expected, rel=1e-9)


def test_figures_of_the_file_are_those_of_the_painting_in_memory(
    painting: Painting, file: Path, layout: Layout
) -> None:
    assert read_painting(file) == painting
    assert metrics_of(read_painting(file), layout) == metrics_of(painting, layout)


def test_a_seed_repeats_the_file_to_the_bit(
    painting: Painting, file: Path, layout: Layout, round_brush: Brush, tmp_path: Path
) -> None:
    again = painted(layout, round_brush)
    assert again == painting
    write_painting(again, tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == file.read_bytes()
    other = painted(layout, round_brush, options(seed=1))
    assert other.strokes != painting.strokes


def test_code_and_pose_in_the_file_decode_to_the_trajectory(file: Path) -> None:
    read = read_painting(file)
    style = load_style("free", Canvas(read.sheet.width, read.sheet.height, 1))
    uses = [stroke.style for stroke in read.strokes]
    assert len(uses) > 10
    for stroke, use in zip(read.strokes, uses, strict=True):
        assert use is not None
        path = style.decode(torch.tensor([use.code])).double().numpy()
        placed = strokes.place(path, np.array([use.pose]))[0]
        assert np.array(stroke.trajectory)[:, :2] == pytest.approx(placed, abs=FILE_METRES)


@pytest.mark.parametrize("size", [(0.2, 0.16), (103 * 1e-3, 0.2), (3.333 * 25.4e-3, 5 * 25.4e-3)])
def test_the_style_of_a_file_is_known_again_from_its_canvas(
    size: tuple[float, float], portrait: Picture, round_brush: Brush
) -> None:
    layout = lay_out_for(portrait, Sheet(width=size[0], height=size[1]), round_brush, height_px=32)
    found = painted(layout, round_brush, options(strokes=6, steps=1, exact=True))
    style = load_style("free", Canvas(found.sheet.width, found.sheet.height, 1))
    for stroke in found.strokes:
        assert stroke.style is not None
        assert (stroke.style.name, stroke.style.hash) == (style.name, style.hash)


def test_trajectories_stay_on_the_sheet_with_pressure_in_range(painting: Painting) -> None:
    found = painting.trajectories()
    assert found.shape == (len(painting.strokes), 32, 3)
    assert found[..., :2].min() >= -FILE_METRES
    assert found[..., :2].max() <= 0.103 + FILE_METRES
    assert found[..., 2].min() >= 0
    assert found[..., 2].max() <= 1
    assert np.ptp(found[..., 2]) > 0.1


def test_the_file_tells_how_the_painting_was_made(painting: Painting, layout: Layout, round_brush: Brush) -> None:
    assert painting.provenance.image == "a.jpg"
    assert painting.provenance.seed == 0
    assert painting.provenance.options["strokes"] == 30
    assert painting.provenance.options["paints"] == 4
    assert painting.brushes == {"round": round_brush}
    assert painting.area == pytest.approx(layout.area, abs=FILE_METRES)
    assert [stroke.id for stroke in painting.strokes] == list(range(len(painting.strokes)))


def test_making_holds_every_option_and_more() -> None:
    digest = hashlib.sha256(b"a picture").hexdigest()
    made = provenance_of(options(palette=((0.5, 0.0, 0.25),)), "a.jpg", digest, {"size": "20x16cm"})
    assert isinstance(made, Provenance)
    assert made.image_sha256 == digest
    assert made.options == {
        "strokes": 30,
        "exact": False,
        "paints": 4,
        "pinned": [],
        "in_colours": False,
        "palette": [[0.5, 0.0, 0.25]],
        "steps": 80,
        "ask_every": 4,
        "seed": 0,
        "arrange": 1.0,
        "size": "20x16cm",
    }


def test_twelve_paints_mean_eleven_changes_at_most_and_each_stands_together(layout: Layout, round_brush: Brush) -> None:
    found = painted(layout, round_brush, options(strokes=60, paints=12))
    order = [stroke.paint for stroke in found.strokes]
    assert order == sorted(order)
    assert set(order) == set(range(len(found.paints))), "no paint is mixed that no stroke takes"
    assert 6 < len(found.paints) <= 12
    assert found.paint_changes() == len(found.paints) - 1 <= 11
    shades = lightness(np.array([paint.colour for paint in found.paints]))
    assert np.diff(shades).max() < LIGHTNESS_DRIFT


def test_one_ink_makes_the_tones_of_a_photograph(portrait: Picture) -> None:
    pen = nominal("marker")
    drawn = lay_out_for(portrait, Sheet(width=0.1, height=0.08), pen, height_px=64)
    found = painted(drawn, pen, options(strokes=60, paints=None, steps=100))
    assert likeness(found, drawn).tone_mse_sigma4 < 0.006
    assert likeness(bare(found), drawn).tone_mse_sigma4 > 0.1


def test_one_ink_is_one_paint(layout: Layout) -> None:
    found = painted(layout, nominal("marker"), options(paints=None, palette=((0.0, 0.2, 0.4),), steps=20))
    assert [paint.colour for paint in found.paints] == [(0.0, 0.2, 0.4)]
    assert found.paint_changes() == 0
    assert {stroke.paint for stroke in found.strokes} == {0}


def test_a_pen_that_can_only_lift_is_commanded_without_pressure(layout: Layout) -> None:
    found = painted(layout, nominal("fineliner"), options(steps=20))
    assert len(found.strokes) > 10
    assert not found.trajectories()[..., 2].any()


@pytest.mark.parametrize("paints", [4, None])
def test_a_white_picture_makes_a_painting_that_can_be_written(
    paints: int | None, round_brush: Brush, tmp_path: Path
) -> None:
    picture = np.ones((9, 12, 3), dtype=np.float32)
    white = lay_out_for(picture, Sheet(width=0.08, height=0.06), round_brush, height_px=32)
    found = painted(white, round_brush, options(paints=paints, steps=20))
    assert len(found.strokes) <= 3
    write_painting(found, tmp_path / "white.json")
    assert read_painting(tmp_path / "white.json") == found
    assert preview(found, white.canvas).min() > 0.98
    assert likeness(found, white).mse < 1e-4


@pytest.mark.parametrize("paints", [2, None])
@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (2, 3)])
def test_a_picture_of_a_few_pixels_is_painted(paints: int | None, shape: tuple[int, int]) -> None:
    pen = nominal("marker")
    picture = np.full((*shape, 3), 0.2, dtype=np.float32)
    small = lay_out_for(picture, Sheet(width=0.08, height=0.06), pen, height_px=2 if shape == (1, 40) else 32)
    found = painted(small, pen, options(strokes=12, paints=paints, steps=100))
    assert len(found.strokes) > 0
    assert likeness(found, small).mse < 0.8 * likeness(bare(found), small).mse


@pytest.mark.parametrize("size", [(0.3, 0.005), (0.005, 0.3)])
def test_a_sheet_like_a_ribbon_is_painted(size: tuple[float, float], portrait: Picture) -> None:
    pen = nominal("marker")
    sheet = Sheet(width=size[0], height=size[1])
    ribbon = lay_out_for(portrait, sheet, pen, fit="cover", height_px=6 if size[0] > size[1] else 240)
    found = painted(ribbon, pen, options(strokes=12, steps=20))
    assert len(found.strokes) > 0
    assert likeness(found, ribbon).mse < likeness(bare(found), ribbon).mse
    xy = found.trajectories()[..., :2]
    assert xy.min() >= -FILE_METRES
    assert (xy - size).max() <= FILE_METRES


def test_strokes_longer_than_the_sheet_go_along_its_edge_within_the_margin(portrait: Picture) -> None:
    pen, wanted, size = nominal("fineliner"), options(strokes=20, steps=5, exact=True), (0.06, 0.05)
    layout = lay_out_for(portrait, Sheet(width=size[0], height=size[1]), pen, height_px=32)
    style = load_style("contour", layout.canvas)
    planned = plan(problem_of(layout, (pen,), style, wanted, NO_NETWORK), wanted)
    paths = planned.strokes.trajectories(style)[..., :2].numpy()
    fits = np.maximum(-paths, paths - size).max(axis=(1, 2)) < FILE_METRES
    assert 0 < fits.sum() < 20
    found = as_painting(planned, layout, (pen,), style, provenance_of(wanted)).trajectories()[..., :2]
    assert found.shape == paths.shape
    assert found[fits] == pytest.approx(paths[fits], abs=FILE_METRES)
    clamped = paths.clip(-OFF_SHEET, np.array(size) + OFF_SHEET)
    assert found == pytest.approx(clamped, abs=FILE_METRES)


def test_faces_count_more_unless_told_otherwise(portrait: Picture, round_brush: Brush) -> None:
    face = lay_out_for(astronaut()[:400] / np.float32(255), Sheet(width=0.1, height=0.08), round_brush, height_px=100)
    middle, flag = (slice(15, 40), slice(47, 65)), (slice(50, 100), slice(0, 15))
    usual, even, twice = (
        problem_of(face, (round_brush,), load_style("free", face.canvas), QUICK, LossOptions(weights=weights)).weights
        for weights in ({}, {"faces": 0.0}, {"faces": 2.0})
    )
    assert (even == 1).all()
    assert usual[middle].mean() > 2 * usual[flag].mean()
    assert twice[middle].mean() / twice[flag].mean() > 1.4 * usual[middle].mean() / usual[flag].mean()


def test_paints_are_known_by_their_names_where_they_have_one(layout: Layout, round_brush: Brush) -> None:
    wanted = options(paints=None, palette=((0.9, 0.8, 0.7), (0.2, 0.2, 0.4)), in_colours=True, steps=20)
    style = load_style("free", layout.canvas)
    planned = plan(problem_of(layout, (round_brush,), style, wanted, NO_NETWORK), wanted)
    names = {hex_colour((0.2, 0.2, 0.4)): "dusk"}
    found = as_painting(planned, layout, (round_brush,), style, provenance_of(wanted), names)
    assert {paint.colour: paint.name for paint in found.paints} == {(0.9, 0.8, 0.7): None, (0.2, 0.2, 0.4): "dusk"}


def test_what_became_of_a_plan_is_written_into_its_file_term_by_term(
    painting: Painting, layout: Layout, round_brush: Brush
) -> None:
    loss_options = LossOptions(weights={"likeness": 0.0, "edges": 2.0})
    problem = problem_of(layout, (round_brush,), load_style("free", layout.canvas), QUICK, loss_options)
    metrics = with_metrics(painting, layout, problem).provenance.metrics
    reached = likeness(painting, layout)
    assert {name: metrics[name] for name in asdict(reached)} == asdict(reached)
    assert set(metrics) - set(asdict(reached)) == {"tone", "edges", "loss"}
    assert metrics["loss"] == metrics["tone"] + metrics["edges"]
    blank = with_metrics(bare(painting), layout, problem).provenance.metrics
    assert all(0 < metrics[name] < blank[name] for name in ("tone", "edges"))


def test_tones_of_an_ink_are_judged_beside_what_the_ink_can_show_of_a_coloured_picture(
    painting: Painting, layout: Layout, round_brush: Brush
) -> None:
    black = Tones(veil=0.0, contrast=1.0, lightest=100.0, darkest=0.0, inks=((0.0, 0.0, 0.0),))
    assert layout.target is not None
    grey = replace(layout, target=np.repeat(layout.target.mean(axis=2, keepdims=True), 3, axis=2))
    in_colours, in_grey = (
        with_metrics(
            painting, each, problem_of(each, (round_brush,), load_style("free", each.canvas), QUICK, NO_NETWORK), black
        ).provenance.metrics
        for each in (layout, grey)
    )
    assert in_colours["psnr"] != pytest.approx(in_grey["psnr"], abs=0.1)
    assert in_colours["psnr_blurred"] == pytest.approx(in_grey["psnr_blurred"], abs=1e-3)


def test_a_term_counts_in_the_file_as_it_was_weighed(painting: Painting, layout: Layout, round_brush: Brush) -> None:
    style = load_style("free", layout.canvas)
    tone, twice = (
        with_metrics(painting, layout, problem_of(layout, (round_brush,), style, QUICK, LossOptions(weights=weights)))
        for weights in ({"likeness": 0.0}, {"likeness": 0.0, "tone": 2.0})
    )
    assert twice.provenance.metrics["loss"] == pytest.approx(2 * tone.provenance.metrics["loss"])


def test_a_painting_without_a_picture_has_no_likeness(painting: Painting, layout: Layout) -> None:
    assert metrics_of(painting, replace(layout, target=None)) is None
