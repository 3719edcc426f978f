"""Guides of an SVG: strokes that follow them, those that are painted as they are, and regions with soft edges."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from maulstick.errors import InputError
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from tests.support.planned import picture

PLAN: dict[str, Any] = {
    "strokes": 60,
    "paints": 4,
    "steps": 30,
    "px": 48,
    "size": "60x60mm",
    "brush": "marker",
    "style": "loops",
}
GUIDES = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">
<path d="M0 50 H100" fill="none" stroke="black"/>
<g id="paint"><path d="M20 20 L80 30 L120 30" fill="none" stroke="#2244cc"/></g></svg>"""
SAY = '[sky]\ncolour = "#0000ff"\nsoft = "8mm"\n[coat]\ncolour = "#00ff00"\ndirection = "guides"\n'


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("guides")
    Image.fromarray((255 * picture()).astype(np.uint8)).save(folder / "disc.png")
    (folder / "guides.svg").write_text(GUIDES)
    image = Image.new("RGB", (40, 40), "#0000ff")
    image.paste("#00ff00", (20, 0, 40, 40))
    image.save(folder / "map.png")
    (folder / "say.toml").write_text(SAY)
    return folder


def prepared_with(folder: Path, **changes: Any) -> Prepared:
    return prepare(
        PlanRequest(folder / "disc.png", PlanOptions(**{**PLAN, "guides": folder / "guides.svg", **changes}))
    )


def painted_with(prepared: Prepared) -> Painting:
    return prepared.painting(prepared.plan(lambda progress: True, None))


@pytest.fixture(scope="module")
def painting(folder: Path) -> Painting:
    return painted_with(prepared_with(folder))


def chords(painting: Painting, least: float, most: float) -> list[float]:
    """Return the angles from -pi/2 to pi/2 of planned strokes whose middles lie between these heights, metres."""
    found = []
    for stroke in painting.strokes:
        path = np.array(stroke.trajectory)
        if stroke.origin == "planned" and least < path[:, 1].mean() < most:
            x, y = path[-1, :2] - path[0, :2]
            found.append((np.arctan2(y, x) + np.pi / 2) % np.pi - np.pi / 2)
    return found


def test_strokes_near_a_guide_lie_along_it(painting: Painting) -> None:
    near = chords(painting, 0.0285, 0.0315)
    assert len(near) > 1
    assert np.abs(near).max() < np.radians(11.5)
    assert np.abs(chords(painting, 0.045, 0.06)).max() > np.radians(20)


def test_a_line_of_the_layer_paint_is_a_locked_stroke_in_its_colour_cut_at_the_picture(painting: Painting) -> None:
    own = [stroke for stroke in painting.strokes if stroke.origin == "guide"]
    assert [stroke.locked for stroke in own] == [True]
    path = np.array(own[0].trajectory)[:, :2]
    assert path[0] == pytest.approx([0.012, 0.012], abs=1e-3)
    assert path[-1] == pytest.approx([0.06, 0.018], abs=1e-3)
    assert painting.paints[own[0].paint].hex == "#2244cc"
    assert len(painting.paints) <= 4


def test_a_line_that_lies_off_the_sheet_has_no_paint_kept_for_it(folder: Path) -> None:
    off = '<path d="M120 20 L180 30" fill="none" stroke="#ff00ff"/></g>'
    (folder / "off.svg").write_text(GUIDES.replace("</g>", off))
    prepared = prepared_with(folder, guides=folder / "off.svg", paints=1)
    assert prepared.kept is not None
    assert [paint.hex for paint in prepared.kept.paints] == ["#2244cc"]


def test_a_guide_is_painted_in_the_very_paint_of_a_file_that_other_strokes_have(folder: Path) -> None:
    (folder / "tubes.csv").write_text("name,colour\nnight,#101010\nsky,#2244cc\n")
    painting = painted_with(prepared_with(folder, paints=None, paints_from=folder / "tubes.csv", steps=2))
    assert [paint.name for paint in painting.paints] == ["sky", "night"]
    assert {painting.paints[stroke.paint].name for stroke in painting.strokes if stroke.origin == "guide"} == {"sky"}


def test_planned_again_it_has_them_and_does_not_paint_them_twice(folder: Path, painting: Painting) -> None:
    file = folder / "painting.json"
    write_painting(painting, file)
    again = painted_with(prepared_with(folder, again=file))
    assert [s for s in again.strokes if s.locked] == [s for s in painting.strokes if s.locked]
    changed = painting.model_copy(update={"strokes": tuple(s for s in painting.strokes if not s.locked)})
    write_painting(changed, file)
    assert not [s for s in painted_with(prepared_with(folder, again=file)).strokes if s.origin == "guide"]


def test_planned_again_its_file_may_have_more_lines_to_follow_but_not_to_paint(
    tmp_path: Path, folder: Path, painting: Painting
) -> None:
    file, again = tmp_path / "guides.svg", tmp_path / "painting.json"
    write_painting(painting, again)
    file.write_text(GUIDES.replace("</svg>", '<path d="M0 9 H9" stroke="red"/></svg>'))
    prepared = prepared_with(folder, guides=file, again=again)
    assert prepared.provenance.options["painted_guides"] == painting.provenance.options["painted_guides"]
    file.write_text(GUIDES.replace("</g>", '<path d="M0 9 H9" stroke="red"/></g>'))
    with pytest.raises(InputError, match="lines on a layer called paint are painted with a new plan"):
        prepared_with(folder, guides=file, again=again)


def test_older_paintings_know_their_painted_guides_by_the_files_name(
    tmp_path: Path, folder: Path, painting: Painting
) -> None:
    options = {name: value for name, value in painting.provenance.options.items() if name != "painted_guides"}
    older = painting.model_copy(update={"provenance": painting.provenance.model_copy(update={"options": options})})
    write_painting(older, tmp_path / "painting.json")
    assert "painted_guides" not in prepared_with(folder, again=tmp_path / "painting.json").provenance.options
    (tmp_path / "others.svg").write_text(GUIDES)
    with pytest.raises(InputError, match="lines on a layer called paint are painted with a new plan"):
        prepared_with(folder, guides=tmp_path / "others.svg", again=tmp_path / "painting.json")


def test_one_ink_paints_them_in_the_ink_and_arranged_groups_follow(folder: Path) -> None:
    painting = painted_with(prepared_with(folder, paints=None, ink="black", style="hatching", brush="fineliner"))
    assert {paint.hex for paint in painting.paints} == {"#000000"}
    assert sum(stroke.origin == "guide" for stroke in painting.strokes) == 1


def test_a_region_follows_guides_all_over_and_another_has_a_soft_edge(folder: Path) -> None:
    prepared = prepared_with(folder, regions=folder / "map.png", say=folder / "say.toml")
    guides, regions = prepared.problem.guides, prepared.problem.regions
    assert guides is not None
    assert regions is not None
    coat = guides.field[:, 30:]
    assert np.abs(coat) == pytest.approx(np.ones(coat.shape))
    names = np.array([region.name for region in regions.said])[regions.labels]
    assert 0.2 < (names[:, 22:26] == "sky").mean() < 0.8
    assert (names[:, :20] == "sky").all()
    assert (names[:, 28:] == "coat").all()


def test_a_line_that_is_painted_is_cut_at_bare_paper(folder: Path) -> None:
    (folder / "bare.toml").write_text("[sky]\ncolour = '#0000ff'\nbare = true\n")
    prepared = prepared_with(folder, regions=folder / "map.png", say=folder / "bare.toml")
    assert prepared.kept is not None
    ends = [np.array(stroke.trajectory)[[0, -1], 0] for stroke in prepared.kept.strokes]
    assert ends == [pytest.approx([0.031, 0.06], abs=2e-3)]


@pytest.mark.parametrize(
    ("say", "fault"),
    [
        ('[a]\ncolour = "#0000ff"\nsoft = "wide"', "is not a length"),
        ('[a]\ncolour = "#0000ff"\nbare = true\nsoft = "2mm"', "bare paper has sharp edges"),
        (
            '[a]\ncolour = "#0000ff"\ndirection = "up"',
            r"a\.direction: it must be degrees clockwise from the right, or \"guides\" \(got 'up'\)",
        ),
    ],
)
def test_what_a_region_cannot_have_is_refused(folder: Path, say: str, fault: str) -> None:
    (folder / "wrong.toml").write_text(say)
    with pytest.raises(InputError, match=fault):
        prepared_with(folder, regions=folder / "map.png", say=folder / "wrong.toml")


def test_a_region_that_follows_guides_needs_some(folder: Path) -> None:
    with pytest.raises(InputError, match="coat is to follow guides"):
        prepared_with(folder, regions=folder / "map.png", say=folder / "say.toml", guides=None)


def test_a_file_without_lines_is_refused(folder: Path) -> None:
    (folder / "none.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg"><rect width="9" height="9"/></svg>')
    with pytest.raises(InputError, match="has no line to follow"):
        prepared_with(folder, guides=folder / "none.svg")


def test_guides_that_no_part_is_painted_of_are_told(folder: Path) -> None:
    assert not [note for note in prepared_with(folder).notes if "guide" in note]
    (folder / "beside.svg").write_text(GUIDES.replace("M20 20 L80 30 L120 30", "M120 20 L180 30"))
    prepared = prepared_with(folder, guides=folder / "beside.svg")
    assert prepared.kept is None
    assert "no guide is painted: none lies on the picture and off bare paper" in prepared.notes


def test_a_dot_is_no_line_to_follow_unless_it_is_painted(folder: Path) -> None:
    dot = '<path d="M9 9 L9 9" stroke="black" fill="none"/>'
    (folder / "dot.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">{dot}</svg>')
    with pytest.raises(InputError, match="has no line to follow"):
        prepared_with(folder, guides=folder / "dot.svg")
    painted = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100"><g id="paint">{dot}</g></svg>'
    (folder / "dot.svg").write_text(painted)
    kept = prepared_with(folder, guides=folder / "dot.svg").kept
    assert kept is not None
    assert len(kept.strokes) == 1


def test_a_mural_has_no_guides(folder: Path) -> None:
    with pytest.raises(InputError, match="plans in one piece"):
        prepared_with(folder, px=3000, brush="fineliner")
