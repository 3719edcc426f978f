"""Regions of a picture, each with its own hand, brushes, colours and share, or bare."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan.before import planned_before
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.brush import load_brush
from maulstick.painting.painting import Painting
from maulstick.painting.raster import Canvas
from maulstick.planning.regions import Regions
from maulstick.rendering.preview import preview
from maulstick.style import load_style
from maulstick.style.store import write_style
from tests.support.planned import picture
from tests.support.style.synthetic_hands import exemplar_of, line

SIDE, PX = 0.06, 48
PLAN: dict[str, Any] = {
    "strokes": 60, "exact": True, "paints": 4, "steps": 30, "px": PX, "size": "60x60mm", "brush": "marker",
    "style": "loops",
}  # fmt: skip
QUARTERS = ("#ff0000", "#00ff00", "#0000ff", "#ffffff")  # left above, right above, left below, right below
SAY = """
[face]
colour = "#ff0000"
brush = "fineliner,marker"
share = 0.5
importance = 3
[coat]
colour = "#00ff00"
style = "hatching"
direction = 45
colours = ["#cc4400", "#552200"]
[sky]
colour = "#0000ff"
bare = true
[rest]
weights = {tone = 2}
"""


def a_map(size: int = 40) -> Image.Image:
    image = Image.new("RGB", (size, size))
    half = size // 2
    for number, colour in enumerate(QUARTERS):
        image.paste(colour, (number % 2 * half, number // 2 * half, size, size))
    return image


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("regions")
    Image.fromarray((255 * picture()).astype(np.uint8)).save(folder / "disc.png")
    a_map().save(folder / "map.png")
    (folder / "say.toml").write_text(SAY)
    return folder


def prepared_with(folder: Path, say: str | None = None, **changes: Any) -> Prepared:
    if say is not None:
        (folder / "other.toml").write_text(say)
    files = {"regions": folder / "map.png", "say": folder / ("say.toml" if say is None else "other.toml")}
    return prepare(PlanRequest(folder / "disc.png", PlanOptions(**{**PLAN, **files, **changes})))


@pytest.fixture(scope="module")
def prepared(folder: Path) -> Prepared:
    return prepared_with(folder)


@pytest.fixture(scope="module")
def painting(prepared: Prepared) -> Painting:
    return prepared.painting(prepared.plan(lambda progress: True, None))


def strokes_in(painting: Painting, region: str) -> list[Any]:
    return [stroke for stroke in painting.strokes if stroke.region == region]


def middle(stroke: Any) -> tuple[float, float]:
    x, y, _ = np.mean(stroke.trajectory, axis=0)
    return float(x), float(y)


def test_each_region_is_drawn_by_its_hand_which_the_file_says(painting: Painting) -> None:
    assert {stroke.style.name for stroke in strokes_in(painting, "face")} == {"loops"}
    assert {stroke.style.name for stroke in strokes_in(painting, "coat")} == {"hatching"}
    sizes = {name: {len(s.style.code) for s in strokes_in(painting, name)} for name in ("face", "coat")}
    assert all(len(size) == 1 for size in sizes.values()), "codes are those of the hand alone"


def test_strokes_stay_in_their_regions(painting: Painting) -> None:
    slack = 2 / PX * SIDE
    for name, (right, below) in {"face": (0, 0), "coat": (1, 0), "rest": (1, 1)}.items():
        places = np.array([middle(stroke) for stroke in strokes_in(painting, name)])
        assert len(places) > 2
        least = np.array([right, below]) * SIDE / 2 - slack
        assert (places > least).all()
        assert (places < least + SIDE / 2 + 2 * slack).all()


@pytest.mark.parametrize("colours", [{"ink": "black", "paints": None}, {"paints": 2}])
def test_a_share_of_a_region_of_which_nothing_is_seen_goes_to_the_others(folder: Path, colours: dict[str, Any]) -> None:
    image = Image.new("RGB", (40, 40), "#ff0000")
    image.paste("#0000ff", (20, 0, 40, 40))
    image.save(folder / "halves.png")
    say = "[face]\ncolour = 'red'\nshare = 0.3\n[sky]\ncolour = 'blue'\nshare = 0.3\n[rest]\nshare = 0.3\n"
    prepared = prepared_with(folder, say, regions=folder / "halves.png", **colours)
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    assert [len(strokes_in(painting, name)) for name in ("face", "sky")] == [30, 30]


def test_a_share_of_the_strokes_is_kept(painting: Painting) -> None:
    assert len(strokes_in(painting, "face")) == pytest.approx(30, abs=2)


def test_each_region_uses_its_brushes_and_its_colours(painting: Painting) -> None:
    def used(name: str) -> tuple[set[str], set[str]]:
        paints = [painting.paints[stroke.paint] for stroke in strokes_in(painting, name)]
        return {paint.brush for paint in paints}, {paint.hex for paint in paints}

    assert used("face")[0] == {"marker", "fineliner"}
    assert used("rest")[0] == {"marker"}
    brushes, colours = used("coat")
    assert brushes == {"marker"}
    assert colours <= {"#cc4400", "#552200"}
    assert len({paint.hex for paint in painting.paints}) <= 4


def test_no_ink_lies_on_bare_paper_though_the_picture_is_dark_there(prepared: Prepared, painting: Painting) -> None:
    assert strokes_in(painting, "sky") == []
    fine = preview(painting, Canvas(SIDE, SIDE, 8 * PX / SIDE))
    half = fine.shape[0] // 2
    bare = fine[half + 8 :, : half - 8]
    assert bare.min() > 0.99
    assert fine[:half, :half].min() < 0.5


def test_bare_paper_of_which_the_map_shows_none_moves_no_stroke(folder: Path) -> None:
    colours = (f"[r{number}]\ncolour='{colour}'\n" for number, colour in enumerate(QUARTERS))
    regions = prepared_with(folder, "".join(colours) + "[rest]\nbare=true\n").problem.regions
    assert regions is not None
    corner = np.array([(0.0, 0.0, 0.5), (0.005, 0.0, 0.5)])
    assert regions.bare_paper.is_off(corner, ms.load_brush("marker"))


def test_strokes_of_a_direction_lie_in_it(painting: Painting) -> None:
    for stroke in strokes_in(painting, "coat"):
        x, y = (np.array(stroke.trajectory[-1]) - stroke.trajectory[0])[:2]
        away = (np.arctan2(y, x) - np.pi / 4 + np.pi / 2) % np.pi - np.pi / 2
        assert abs(away) < np.radians(10.5)


def test_the_emphasis_of_regions_is_in_the_weights(prepared: Prepared) -> None:
    weights = prepared.problem.weights.numpy()
    quarter = PX // 4
    face, coat, sky, rest = (weights[y * quarter, x * quarter] for y, x in ((1, 1), (1, 3), (3, 1), (3, 3)))
    assert (face / coat, sky, rest / coat) == pytest.approx((3, 0, 1))


def test_it_is_the_same_each_time_and_can_be_planned_again(
    folder: Path, prepared: Prepared, painting: Painting
) -> None:
    states: list[Any] = []
    prepared.plan(lambda progress: states.append(progress.state()) is None, None)
    assert prepared.painting(prepared.plan(lambda progress: True, states[20])).strokes == painting.strokes
    locked = ms.Painting.of(painting).lock(painting.strokes[0].id, painting.strokes[-1].id)
    files = {"regions": folder / "map.png", "say": folder / "say.toml"}
    again = ms.plan(folder / "disc.png", again=locked, options=planned_before(locked, {**files, "steps": 3}))
    assert {s.id: s.trajectory for s in again.strokes if s.locked} == {
        s.id: s.trajectory for s in locked.strokes if s.locked
    }
    assert {stroke.style.name for stroke in strokes_in(again, "coat") if stroke.style} == {"hatching"}


def test_a_region_in_a_colour_that_the_painting_has_not_is_refused_when_it_is_planned_again(
    folder: Path, painting: Painting
) -> None:
    (folder / "green.toml").write_text(SAY.replace('["#cc4400", "#552200"]', '["#00aa33"]'))
    files = {"regions": folder / "map.png", "say": folder / "green.toml"}
    with pytest.raises(InputError, match="a region is to be painted in #00aa33, which is none of the paints"):
        ms.plan(folder / "disc.png", again=painting, options=planned_before(painting, {**files, "steps": 3}))


def test_no_paint_is_mixed_for_its_regions_when_it_is_planned_again_so_any_number_of_strokes_may_be_asked_for(
    folder: Path, painting: Painting
) -> None:
    files = {"regions": folder / "map.png", "say": folder / "say.toml"}
    options = planned_before(painting, {**files, "steps": PLAN["steps"], "strokes": 1})
    assert len(ms.plan(folder / "disc.png", again=painting, options=options).strokes) == 1


def test_an_svg_says_the_same_as_a_picture_of_it(folder: Path) -> None:
    rects = "".join(
        f'<rect x="{20 * (i % 2)}" y="{20 * (i // 2)}" width="20" height="20" fill="{colour}"/>'
        for i, colour in enumerate(QUARTERS[:3])
    )
    (folder / "map.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="40" height="40" viewBox="0 0 40 40">{rects}</svg>'
    )
    drawn, painted = (prepared_with(folder, regions=folder / name).problem.regions for name in ("map.svg", "map.png"))
    assert isinstance(drawn, Regions)
    assert isinstance(painted, Regions)
    assert np.array_equal(drawn.labels, painted.labels)


def test_an_indexed_picture_says_the_same(folder: Path) -> None:
    a_map().quantize(4).save(folder / "indexed.png")
    indexed, painted = (prepared_with(folder, regions=folder / n).problem.regions for n in ("indexed.png", "map.png"))
    assert indexed is not None
    assert painted is not None
    assert np.array_equal(indexed.labels, painted.labels)


def test_a_region_with_another_brush_than_the_inks_is_told_by_its_own(folder: Path) -> None:
    with pytest.raises(InputError) as caught:
        prepared_with(
            folder, '[face]\ncolour="#ff0000"\nbrush="marker"\n[rest]', ink="black", paints=None, brush="fineliner"
        )
    assert str(caught.value) == (
        "regions ask for marker beside fineliner, and ink is drawn with one brush; let them have that one, or paint in "
        "colours"
    )


def test_one_ink_has_regions_too(folder: Path) -> None:
    say = '[dark]\ncolour="#ff0000"\nshare=0.7\n[sky]\ncolour="#0000ff"\nbare=true\n'
    prepared = prepared_with(folder, say, ink="black", paints=None, brush="fineliner", style="hatching")
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    assert len(strokes_in(painting, "dark")) > 0.6 * len(painting.strokes)
    assert strokes_in(painting, "sky") == []


@pytest.mark.parametrize(("style", "most"), [("free", "moscow"), ("elephant", "moscow"), ("moscow", "loops")])
def test_a_drawing_goes_on_from_stroke_to_stroke_as_the_hand_does_that_draws_most_of_it(
    folder: Path, style: str, most: str
) -> None:
    say = f'[face]\ncolour = "#ff0000"\nshare = 0.8\nstyle = "{most}"\n'
    prepared = prepared_with(folder, say, style=style, ink="black", paints=None, steps=2, brush="fineliner")
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    arrangement = load_style(most, prepared.layout.canvas).arrangement
    assert painting.succession == (None if arrangement is None else arrangement.succession)


def test_colours_that_are_pinned_are_used_as_they_are(folder: Path) -> None:
    options = PlanOptions(**PLAN, pin=("#112233", "#ffcc00"))
    prepared = prepare(PlanRequest(folder / "disc.png", options))
    planned = prepared.plan(lambda progress: True, None)
    mixed = {tuple(round(255 * channel) for channel in colour) for colour in planned.paints.tolist()}
    assert {(0x11, 0x22, 0x33), (0xFF, 0xCC, 0x00)} <= mixed
    assert len(planned.paints) <= 4


@settings(max_examples=10, deadline=None)
@given(st.integers(1, 30), st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_a_map_of_any_size_and_shape_keeps_ink_off_what_is_bare(folder: Path, wide: int, high: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    colours = np.array([(255, 0, 0), (0, 0, 255), (255, 255, 255)], dtype=np.uint8)[rng.integers(0, 3, (high, wide))]
    colours[0, 0] = (255, 0, 0)
    Image.fromarray(colours).save(folder / "any.png")
    say = '[ink]\ncolour="#ff0000"\n' + ('[sky]\ncolour="#0000ff"\nbare=true\n' if (colours[..., 2] > 0).any() else "")
    try:
        prepared = prepared_with(folder, say, regions=folder / "any.png", strokes=6, steps=2, paints=2, exact=False)
    except InputError as error:
        assert "shows nothing in" in str(error)  # noqa: PT017  a region of a pixel that no pixel of the canvas shows
        return
    painting = prepared.painting(prepared.plan(lambda progress: True, None))
    regions = prepared.problem.regions
    assert regions is not None
    for stroke in painting.strokes:
        brush = painting.brushes[painting.paints[stroke.paint].brush]
        assert regions.bare_paper.is_off(np.array(stroke.trajectory), brush)


@pytest.mark.parametrize("style", ["", "style = 'contour'\n"])
def test_a_region_draws_as_large_as_it_says_or_else_as_the_plan_does(folder: Path, style: str) -> None:
    for said, size in (("hand_size = 0.25\n", 0.25), ("", 0.5)):
        prepared = prepared_with(folder, f"[face]\ncolour = 'red'\n{style}{said}", style="contour", hand_size=0.5)
        regions = prepared.problem.regions
        assert regions is not None
        (face,) = (region for region in regions.said if region.name == "face")
        assert face.hand.hash == load_style("contour", prepared.layout.canvas).scaled(size).hash


def test_files_of_a_brush_and_a_hand_lie_beside_what_names_them_wherever_one_is(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = load_brush("fineliner").model_copy(update={"name": "mine"})
    (folder / "mine.json").write_text(mine.model_dump_json())
    write_style(exemplar_of(line), "lines", folder)
    name = f"{exemplar_of(line).name}.json"
    monkeypatch.chdir(tmp_path)
    say = f"[face]\ncolour = 'red'\nbrush = 'marker, mine.json'\nstyle = '{name}'\n"
    prepared = prepared_with(folder, say)
    regions = prepared.problem.regions
    assert regions is not None
    assert [brush.name for brush in prepared.brushes] == ["marker", "mine"]
    assert regions.said[1].hand.hash == exemplar_of(line).hash


def test_shares_that_are_one_together_are_taken_though_a_sum_of_doubles_may_say_more(folder: Path) -> None:
    shares = (0.33, 0.56, 0.11)
    assert sum(shares) > 1
    said = zip("abc", QUARTERS, shares, strict=False)
    say = "".join(f"[{name}]\ncolour = '{colour}'\nshare = {share}\n" for name, colour, share in said)
    regions = prepared_with(folder, say).problem.regions
    assert regions is not None
    assert regions.counts(100) == [33, 56, 11, 0]


@pytest.mark.parametrize(
    ("say", "text"),
    [
        ("colour = ", "is not TOML: "),
        ("[face]\n", "face has no colour on the map; give it one, as in colour = '#ff0000'"),
        ("[face]\ncolour = 'ff'\n", "'ff' is not a colour"),
        ("[face]\ncolour = '#ff0000'\n[coat]\ncolour = 'red'\n", "face and coat have the same colour, red"),
        ("[face]\ncolour = '#123456'\n", "the colour of face, where the plan has its pixels; paint more of it"),
        ("[face]\ncolour = 'red'\nhand = 'loops'\n", "face.hand: Extra inputs are not permitted"),
        ("[face]\ncolour = 'red'\nshare = 1.5\n", "face.share: Input should be less than 1"),
        ("[face]\ncolour = 'red'\ndirection = inf\n", "other.toml: face.direction: it must be degrees clockwise"),
        ("[face]\ncolour = 'red'\ndirection = nan\n", "other.toml: face.direction: it must be degrees clockwise"),
        (f"[face]\ncolour = 'red'\ndirection = 1{400 * '0'}\n", "other.toml: face.direction: it must be degrees"),
        ("[face]\ncolour = 'red'\nstyle = 'nobody'\n", "there is no style 'nobody'"),
        ("[face]\ncolour = 'red'\nbrush = 'broom'\n", "there is no brush 'broom'"),
        ("[face]\ncolour = 'red'\nweights = {text = 2}\n", "face.weights.text"),
        ("[face]\ncolour = 'red'\ncolours = []\n", "face.colours: List should have at least 1 item"),
        ("[face]\ncolour = 'red'\nshare = 0.6\n[coat]\ncolour = 'lime'\nshare = 0.6\n", "are more than 1; lower some"),
        (
            "".join(f"[r{i}]\ncolour='{colour}'\nbare=true\n" for i, colour in enumerate(QUARTERS)),
            "leaves all of the sheet bare; leave some of it to be painted",
        ),
        ("[7]\ncolour = 'red'\n", "a region is called 7, as strokes are named; call it otherwise"),
        ("[all]\ncolour = 'red'\n", "a region is called all, as strokes are named; call it otherwise"),
        ("# nothing\n", "the number of regions is 0; it must be from 1 to 64"),
        (
            "[face]\ncolour='red'\ncolours=['#010203','#040506','#070809','#0a0b0c','#0d0e0f']\n",
            "pin, regions and guides name 5 colours that are used as they are, among 4 paints; give more paints, or",
        ),
    ],
)
def test_regions_that_cannot_be_used_are_refused(folder: Path, say: str, text: str) -> None:
    with pytest.raises(InputError) as refused:
        prepared_with(folder, say)
    assert text in str(refused.value)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"regions": Path("nowhere.png")}, "nowhere.png; check its name and folder"),
        ({"px": 4000, "steps": 1}, "regions plans in one piece; choose a smaller px"),
        ({"ink": "black", "paints": None}, "a region is to be painted in #cc4400, which is none of the paints"),
    ],
)
def test_options_that_do_not_go_with_regions_are_refused(folder: Path, changes: dict[str, Any], text: str) -> None:
    with pytest.raises(InputError) as refused:
        prepared_with(folder, **changes)
    assert text in str(refused.value)


def test_a_map_and_what_it_means_are_given_together(folder: Path) -> None:
    with pytest.raises(InputError, match="regions maps regions, and say says what holds there; give both"):
        PlanOptions(**PLAN, regions=folder / "map.png")


def test_pinned_colours_are_among_paints_that_are_mixed(folder: Path) -> None:
    with pytest.raises(InputError, match="pin names colours among paints to mix, and none are mixed; leave it out"):
        prepare(PlanRequest(folder / "disc.png", PlanOptions(ink="black", pin=("red",))))
