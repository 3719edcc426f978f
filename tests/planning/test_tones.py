from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import example, given, settings
from hypothesis import strategies as st
from skimage.data import astronaut

from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.painting import Sheet
from maulstick.planning.from_picture import problem_of
from maulstick.planning.layout import Layout, lay_out_for
from maulstick.planning.problem import Colour, PlannerSettings
from maulstick.planning.regions import Region, Regions
from maulstick.planning.tones import Amounts, InkSupply, Tones, draw_light, ink_per_stroke, strongest_of
from maulstick.style.free import FreeStyle
from maulstick.style.traits import path_length
from tests.support.style.synthetic_hands import exemplar_of, line

HAND = exemplar_of(line)
PEN = load_brush("fineliner")
BLACK = (0.0, 0.0, 0.0)
SHEET = Sheet(width=0.1, height=0.1)


def of_grey(*greys: float) -> Layout:
    """A picture of bands of these greys."""
    picture = np.repeat(np.repeat(np.array(greys, dtype=np.float32), 60 // len(greys)), 60).reshape(60, 60, 1)
    return lay_out_for(np.repeat(picture, 3, axis=2), SHEET, PEN, "contain", 60)


def supply(layout: Layout, ink: tuple[float, float, float] = BLACK, *, with_lines: bool = True) -> InkSupply:
    found = InkSupply.of(layout, PEN, HAND, (ink,), with_lines=with_lines)
    assert found is not None
    return found


def asked(layout: Layout, strokes: int) -> torch.Tensor:
    target, paper = (torch.from_numpy(each.transpose(2, 0, 1).copy()) for each in (layout.target, layout.under))
    return supply(layout).tones(strokes).apply(target, paper)


def test_a_stroke_hides_its_length_times_its_width_nearly() -> None:
    wide = 2 * PEN.widest * path_length(torch.from_numpy(HAND.hand.paths)).mean().item()
    for resolution in (1000.0, 4000.0):
        hidden = ink_per_stroke(PEN, HAND, resolution) / resolution**2
        assert hidden == pytest.approx(wide, rel=0.25)


def test_enough_strokes_leave_a_picture_as_it_is_and_fewer_make_it_lighter() -> None:
    layout = of_grey(0.9, 0.6, 0.3)
    enough = supply(layout).enough
    assert torch.equal(asked(layout, enough), torch.from_numpy(layout.target.transpose(2, 0, 1).copy()))
    means = [asked(layout, round(share * enough)).mean().item() for share in (1, 0.8, 0.5, 0.2, 0.01)]
    assert means == sorted(means)
    assert means[-1] > 0.98


def halves(layout: Layout, right: Region) -> Regions:
    """The hand on the left, and a region on the right."""
    labels = np.repeat((np.arange(60) // 30)[None], 60, axis=0)
    return Regions(labels, (Region("rest", HAND, (True,)), right), layout.canvas)


def in_regions(layout: Layout, regions: Regions) -> InkSupply:
    found = InkSupply.of(layout, PEN, HAND, (BLACK,), with_lines=True, regions=regions)
    assert found is not None
    return found


def test_bare_paper_needs_no_ink() -> None:
    layout = of_grey(0.5, 0.5)
    half = in_regions(layout, halves(layout, Region("sky", HAND, (True,), bare=True)))
    assert half.needed == pytest.approx(supply(layout).needed / 2, rel=0.01)
    assert half.per_stroke == pytest.approx(supply(layout).per_stroke)


def test_hands_of_regions_give_ink_by_the_strokes_that_each_has() -> None:
    layout = of_grey(0.5, 0.5)
    own, small = (ink_per_stroke(PEN, hand, layout.canvas.pixels_per_metre) for hand in (HAND, HAND.scaled(0.5)))
    for share, of_all in ((None, 0.5), (0.9, 0.9)):
        region = Region("hat", HAND.scaled(0.5), (True,), share=share)
        found = in_regions(layout, halves(layout, region))
        assert found.per_stroke == pytest.approx((1 - of_all) * own + of_all * small)
    assert found.fewest > supply(layout).fewest


def test_strokes_that_may_grow_give_what_their_region_needs_and_nothing_elsewhere() -> None:
    layout = of_grey(0.5, 0.5)
    grows = Region("hat", FreeStyle.for_canvas(layout.canvas), (True,), share=0.8)
    found = in_regions(layout, halves(layout, grows))
    assert found.needed == pytest.approx(supply(layout).needed / 2, rel=0.01)
    assert found.per_stroke == pytest.approx(0.2 * supply(layout).per_stroke)


@settings(max_examples=20, deadline=None)
@given(st.lists(st.floats(0.05, 0.95), min_size=2, max_size=4), st.floats(0.02, 1.5))
@example([0.5, 0.5, 0.75], 0.5)  # a veil just below a flat tone
def test_a_picture_in_its_tones_needs_the_ink_that_there_is(greys: list[float], share: float) -> None:
    layout = of_grey(*greys)
    found = supply(layout)
    strokes = max(1, round(share * found.enough))
    image = asked(layout, strokes).permute(1, 2, 0).numpy()
    again = supply(replace(layout, target=image))
    assert again.enough <= max(strokes, found.enough) * 1.02 + 1
    if strokes < found.enough:
        assert again.enough == pytest.approx(strokes, rel=0.1, abs=2)


def test_the_lights_are_left_blank_so_that_the_darks_get_the_ink() -> None:
    layout = of_grey(0.8, 0.7, 0.2)
    ink = supply(layout)
    needed = Amounts.of(ink.amounts).needed / ink.per_stroke
    own = ink.tones(ink.enough)
    for share in (0.7, 0.3, 0.05):
        tones = ink.tones(round(share * needed))
        assert tones.veil > 0.19
        assert tones.lightest == pytest.approx(100, abs=0.5)
    assert ink.tones(round(0.7 * needed)).darkest == pytest.approx(own.darkest, abs=8)


def test_the_lines_of_a_picture_are_as_dark_as_ink_is_short_and_left_out_where_only_tones_are_drawn() -> None:
    layout = of_grey(0.9, 0.6, 0.3)
    ink = supply(layout)
    needed = Amounts.of(ink.amounts).needed / ink.per_stroke
    for share in (0.1, 0.5, 0.9):
        assert ink.tones(round(share * needed)).lines == pytest.approx(1 - share, abs=0.02)
        assert supply(layout, with_lines=False).tones(round(share * needed)).lines == 0
    assert ink.tones(ink.enough).lines == 0


def test_what_lines_tell_is_the_number_of_tones_that_their_chance_leaves_apart() -> None:
    def told(*amounts: float, lines: float = 10_000) -> float:
        return Amounts.of(np.array(amounts)).told(lines)

    assert told(0.5) == pytest.approx(0, abs=1e-3)
    assert told(0.2, 0.5) == pytest.approx(np.log(2), abs=1e-3)
    assert told(0.1, 0.3, 0.5, 0.7) == pytest.approx(np.log(4), abs=1e-3)
    assert told(0.2, 0.5, lines=4) < 0.2
    assert told(0.2, 0.5, lines=1) < told(0.2, 0.5, lines=4) < told(0.0, 0.5, lines=4)


def test_a_note_says_what_so_few_strokes_can_give_and_how_many_would_do() -> None:
    found = supply(of_grey(0.8, 0.2))
    assert found.note(found.enough) is None
    note = found.note(found.enough // 4)
    assert note is not None
    assert "25% of the ink" in note or "24% of the ink" in note
    assert f"{found.enough:,} strokes" in note
    assert note.split(" of this length")[0] == f"{found.enough // 4} strokes"
    assert str(found.note(1)).startswith("1 stroke of this length gives ")


@pytest.mark.parametrize("grey", [1.0, 0.0])
def test_white_and_black_pictures_have_tones(grey: float) -> None:
    layout = of_grey(grey)
    found = supply(layout)
    assert found.enough >= 1
    for strokes in (1, found.enough):
        assert asked(layout, strokes).isfinite().all()
        assert 0 <= found.tones(strokes).darkest <= 100.01


def test_a_picture_too_pale_to_show_anything_keeps_its_tones_though_all_of_it_wants_ink() -> None:
    pale = replace(supply(of_grey(0.9995)), per_stroke=0.1, per_line=0.1)
    assert pale.enough > 1
    assert not pale.tones(1).compressed
    assert pale.note(1) is None


def test_a_style_that_may_grow_its_strokes_and_no_picture_have_no_tones() -> None:
    layout = of_grey(0.5)
    assert InkSupply.of(layout, PEN, FreeStyle.for_canvas(layout.canvas), (BLACK,), with_lines=True) is None
    assert InkSupply.of(replace(layout, target=None), PEN, HAND, (BLACK,), with_lines=True) is None


def test_a_brush_that_is_pressed_gives_more_ink_than_a_pen(round_brush: Brush) -> None:
    assert ink_per_stroke(round_brush, HAND, 1000.0) > 10 * ink_per_stroke(PEN, HAND, 1000.0)


def test_of_a_brush_that_is_pressed_as_many_strokes_are_enough_as_show_the_picture_not_as_hide_it(
    round_brush: Brush,
) -> None:
    layout = of_grey(0.9, 0.6, 0.3)
    pressed, pen = (InkSupply.of(layout, brush, HAND, (BLACK,), with_lines=True) for brush in (round_brush, PEN))
    assert pressed is not None
    assert pen is not None
    assert pen.enough == pen.fewest
    assert 4 * pressed.fewest < pressed.enough < pen.enough
    assert pressed.note(pressed.fewest) is None
    assert f"{pressed.fewest:,} strokes would reach them" in str(pressed.note(pressed.fewest // 2))


def test_lines_lie_over_tones_that_leave_them_blank_in_the_ink() -> None:
    ink = (0.1, 0.1, 0.4)
    layout = lay_out_for(astronaut()[:256, 90:346] / np.float32(255), SHEET, PEN, "contain", 100)
    blank = Tones(veil=1.0, contrast=1.0, lightest=100.0, darkest=100.0, inks=(ink,))
    wanted = PlannerSettings(strokes=30, paints=None, palette=(ink,))

    def asked(tones: Tones) -> torch.Tensor:
        target = problem_of(layout, (PEN,), HAND, wanted, tones=tones).target
        assert target is not None
        return target

    paper = torch.from_numpy(layout.under.transpose(2, 0, 1).copy())
    assert torch.allclose(asked(blank), paper, atol=1e-6)
    faint, dark = (asked(replace(blank, lines=lines)) for lines in (0.25, 1.0))
    assert torch.allclose(4 * (paper - faint), paper - dark, atol=1e-5)
    share = (paper - dark) / (paper - torch.tensor(ink)[:, None, None])
    assert torch.allclose(share[0], share[2], atol=1e-4), "towards the ink"
    assert 0.02 < (share[0] > 0.5).float().mean().item() < 0.4


def test_a_picture_is_as_its_ink_can_show_it_whatever_its_colours() -> None:
    paper, coloured = torch.ones(3, 1, 2), torch.tensor([[[0.9, 0.1]], [[0.6, 0.7]], [[0.3, 0.4]]])
    shown = Tones(veil=0.0, contrast=1.0, lightest=100.0, darkest=0.0, inks=(BLACK,)).in_ink(coloured, paper)
    assert torch.allclose(shown, torch.tensor([[0.6, 0.4]]).expand(3, 1, 2), atol=1e-6)


@pytest.mark.parametrize(
    ("inks", "paper"),
    [
        ((BLACK, (0.8, 0.1, 0.1), (0.9, 0.8, 0.2)), (1.0, 1.0, 1.0)),
        ((BLACK, (1.0, 1.0, 1.0), (0.35, 0.23, 0.13)), (0.78, 0.72, 0.6)),
        (((1.0, 1.0, 1.0), (0.9, 0.8, 0.2)), (0.06, 0.06, 0.08)),
    ],
    ids=["white paper", "dark and light on toned paper", "light on dark paper"],
)
def test_no_ink_earns_anything_in_lights_that_are_left_blank(
    inks: tuple[tuple[float, float, float], ...], paper: tuple[float, float, float]
) -> None:
    sheet = torch.tensor(paper)[:, None, None].expand(3, 4, 6).clone()
    veiled = Tones(veil=0.3, contrast=1.0, lightest=100.0, darkest=20.0, inks=inks)
    pull = veiled.away_from_lights(sheet, sheet, sheet)
    assert pull is not None
    costs = [float((pull[:, 0, 0] * (torch.tensor(ink) - sheet[:, 0, 0])).sum()) for ink in inks]
    assert min(costs) > -1e-6
    assert max(costs) > 0.01


def test_lines_are_drawn_in_the_ink_that_differs_most_from_the_paper() -> None:
    white, yellow = (1.0, 1.0, 1.0), (0.95, 0.85, 0.2)
    assert strongest_of((white, BLACK), BLACK) == white
    assert strongest_of((yellow, BLACK), white) == BLACK
    assert strongest_of((yellow, white), (0.06, 0.06, 0.08)) == white


def test_tones_of_several_inks_fade_alike_and_what_is_paler_than_the_veil_is_blank() -> None:
    red, blue, paper = (0.8, 0.1, 0.1), (0.1, 0.2, 0.7), torch.ones(3, 1, 3)
    towards = torch.tensor([red, blue]) - 1
    shares = torch.tensor([[0.6, 0.2], [0.2, 0.2], [0.1, 0.0]])
    picture = paper + (shares @ towards).T[:, None]
    veiled = Tones(veil=0.2, contrast=0.5, lightest=100.0, darkest=20.0, inks=(red, blue))
    amounts = shares.sum(dim=1, keepdim=True)
    wanted = paper + (shares / amounts * (0.5 * (amounts - 0.2)).clamp(min=0) @ towards).T[:, None]
    assert torch.allclose(veiled.apply(picture, paper), wanted, atol=0.02)


@pytest.mark.parametrize(
    ("inks", "paper", "light"),
    [
        ((BLACK,), (1, 1, 1), False),
        (((1, 1, 1),), BLACK, True),
        ((BLACK, (0.9, 0.2, 0.1)), (0.1, 0.1, 0.1), True),
        ((BLACK, (1, 1, 1)), (0.7, 0.6, 0.5), False),
    ],
)
def test_inks_draw_what_is_light_where_the_strongest_is_lighter_than_the_paper(
    inks: tuple[Colour, ...], paper: Colour, light: bool
) -> None:
    assert draw_light(inks, paper) is light
