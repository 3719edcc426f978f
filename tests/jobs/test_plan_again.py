"""Planning again around the strokes that a person has locked."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.paint.camera_loop import replanned
from maulstick.jobs.plan.again import is_in_ink, palette_of
from maulstick.jobs.plan.before import picture_near, planned_before
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.prepare import prepare
from maulstick.jobs.plan.prepared import Prepared
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Paint, Painting, Stroke
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.stroke_edits import AddStroke, LockStrokes, MoveStrokes, RemoveStrokes, RepaintStrokes, edited
from maulstick.strokes.strokes import resample
from tests.support.planned import picture

SIDE, QUICK = "60x60mm", 4  # steps
few_strokes = pytest.mark.filterwarnings("ignore:.* of the ink that the picture needs")
CIRCLE = tuple(
    (0.03 + 0.01 * np.cos(turn), 0.03 + 0.01 * np.sin(turn), 0.6) for turn in np.linspace(0, 2 * np.pi, 50).tolist()
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a picture, its plan in a folder of its own, and that plan as a person has changed it."""
    folder = tmp_path_factory.mktemp("again")
    Image.fromarray((255 * picture()).astype(np.uint8)).save(folder / "disc.png")
    options: dict[str, Any] = {"strokes": 24, "paints": 3, "steps": 30, "px": 48, "size": SIDE, "brush": "marker"}
    painting = ms.plan(folder / "disc.png", style="loops", exact=True, **options)
    (folder / "plan").mkdir()
    painting.save(folder / "plan" / "painting.json")
    ids = [stroke.id for stroke in painting.strokes]
    edits = [
        LockStrokes(strokes=tuple(ids[:4])),
        MoveStrokes(strokes=(ids[5],), by=(0.002, 0.001), turn=0.3),
        RepaintStrokes(strokes=(ids[6],), paint=2),
        RemoveStrokes(strokes=tuple(ids[-6:])),
        AddStroke(paint=0, trajectory=CIRCLE, speed=(0.05,) * len(CIRCLE)),
    ]
    write_painting(edited(painting, edits), folder / "plan" / "changed.json")
    return folder


def again(file: Path, **given: Any) -> Painting:
    prepared = prepared_from(file, **given)
    return prepared.painting(prepared.plan(lambda progress: True, None))


def prepared_from(file: Path, **given: Any) -> Prepared:
    painting = read_painting(file)
    options = planned_before(painting, {"steps": QUICK, "again": file, **given})
    return prepare(PlanRequest(picture_near(painting, file), options))


@pytest.fixture(scope="module")
def changed(folder: Path) -> Painting:
    return read_painting(folder / "plan" / "changed.json")


@pytest.fixture(scope="module")
def after(folder: Path) -> Painting:
    return again(folder / "plan" / "changed.json")


def as_said(painting: Painting, stroke: Stroke) -> tuple[Stroke, Paint]:
    """Return a stroke without the index of its paint, and that paint."""
    return stroke.model_copy(update={"paint": 0}), painting.paints[stroke.paint]


def locked(painting: Painting) -> dict[int, tuple[Stroke, Paint]]:
    return {stroke.id: as_said(painting, stroke) for stroke in painting.strokes if stroke.locked}


def test_locked_strokes_are_the_same_to_the_bit_afterwards(changed: Painting, after: Painting) -> None:
    assert len(locked(changed)) == 7
    assert locked(after) == locked(changed)


def test_strokes_that_were_taken_out_are_planned_elsewhere_with_ids_that_were_never_used(
    changed: Painting, after: Painting
) -> None:
    assert len(after.strokes) == 24, "as many as were asked for, with the locked ones"
    new = [stroke for stroke in after.strokes if not stroke.locked]
    assert min(stroke.id for stroke in new) > max(stroke.id for stroke in changed.strokes)
    assert {stroke.origin for stroke in new} == {"planned"}


def test_however_often_it_is_planned_again_as_many_strokes_are_placed_anew(folder: Path, after: Painting) -> None:
    free = [stroke.id for stroke in after.strokes if not stroke.locked]
    write_painting(edited(after, [RemoveStrokes(strokes=tuple(free[:5]))]), folder / "plan" / "once.json")
    twice = again(folder / "plan" / "once.json")
    assert [len(each.strokes) for each in (after, twice)] == [24, 24]
    assert [each.provenance.options["strokes"] for each in (after, twice)] == [24, 24]


def test_of_fewer_strokes_than_it_was_planned_with_the_locked_ones_stay(folder: Path, changed: Painting) -> None:
    file = folder / "plan" / "changed.json"
    fewer = again(file, strokes=8)
    assert len(fewer.strokes) == 8, "fewer than its paints may be asked for"
    assert locked(fewer) == locked(changed)
    assert fewer.provenance.options["strokes"] == 8
    assert "7 strokes are locked or painted, and strokes asks for no more; unlock some" in refusal(
        folder, changed, strokes=7
    )


def test_strokes_that_a_person_adds_take_no_other_out(folder: Path) -> None:
    first = ms.plan(folder / "disc.png", strokes=6, paints=2, steps=QUICK, px=48, size=SIDE, exact=True)
    more = edited(first, [AddStroke(paint=0, trajectory=CIRCLE, speed=(0.05,) * len(CIRCLE))])
    write_painting(more, folder / "plan" / "added.json")
    assert len(again(folder / "plan" / "added.json").strokes) == 7


def test_each_paint_is_still_taken_up_once(after: Painting) -> None:
    assert after.paint_changes() == len({stroke.paint for stroke in after.strokes}) - 1


def test_its_sheet_and_its_paints_stay(changed: Painting, after: Painting) -> None:
    assert after.sheet == changed.sheet
    assert after.paints == changed.paints


def test_a_paint_that_no_stroke_needs_any_more_stays_since_it_may_be_mixed(folder: Path, changed: Painting) -> None:
    green = changed.paints[0].model_copy(update={"colour": (0.0, 1.0, 0.0)})
    strokes = tuple(stroke.model_copy(update={"paint": stroke.paint + 1}) for stroke in changed.strokes)
    more = changed.model_copy(update={"paints": (green, *changed.paints), "strokes": strokes})
    write_painting(more, folder / "plan" / "more.json")
    after = again(folder / "plan" / "more.json", brush="fineliner")
    assert after.paints[:4] == more.paints
    assert 0 not in {stroke.paint for stroke in after.strokes}
    assert {stroke.id: stroke for stroke in after.strokes if stroke.locked} == {
        stroke.id: stroke for stroke in more.strokes if stroke.locked
    }


def test_it_is_the_same_each_time_and_goes_on_from_where_it_was_stopped(folder: Path, after: Painting) -> None:
    assert again(folder / "plan" / "changed.json") == after
    prepared, states = prepared_from(folder / "plan" / "changed.json"), []
    prepared.plan(lambda progress: states.append(progress.state()) is None, None)
    assert prepared.painting(prepared.plan(lambda progress: True, states[1])).strokes == after.strokes


@settings(max_examples=5)
@given(st.data())
def test_any_strokes_can_be_locked(folder: Path, changed: Painting, data: st.DataObject) -> None:
    ids = [stroke.id for stroke in changed.strokes]
    some = data.draw(st.lists(st.sampled_from(ids), min_size=1, unique=True))
    painting = edited(changed, [LockStrokes(strokes=tuple(some))])
    write_painting(painting, folder / "plan" / "some.json")
    assert locked(again(folder / "plan" / "some.json", steps=1)) == locked(painting)


def test_another_hand_may_draw_the_rest(folder: Path, changed: Painting) -> None:
    in_lines = again(folder / "plan" / "changed.json", style="hatching")
    assert locked(in_lines) == locked(changed)
    assert {stroke.style.name for stroke in in_lines.strokes if stroke.style and not stroke.locked} == {"hatching"}


def test_another_brush_may_join_those_of_the_painting(folder: Path, changed: Painting) -> None:
    finer = again(folder / "plan" / "changed.json", brush="fineliner", strokes=40)
    assert locked(finer) == locked(changed)
    assert set(finer.brushes) == {"marker", "fineliner"}


def test_strokes_get_a_brush_that_their_region_uses(folder: Path, changed: Painting, tmp_path: Path) -> None:
    (tmp_path / "map.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 2 2"><rect width="1" height="2" fill="#ff0000"/></svg>'
    )
    (tmp_path / "map.toml").write_text('[left]\ncolour = "#ff0000"\nbrush = "fineliner"\n')
    finer = again(folder / "plan" / "changed.json", regions=tmp_path / "map.svg", say=tmp_path / "map.toml")
    assert locked(finer) == locked(changed)
    used = {(stroke.region, finer.paints[stroke.paint].brush) for stroke in finer.strokes if not stroke.locked}
    assert used == {("left", "fineliner"), ("rest", "marker")}


def test_brushes_of_regions_stay_theirs_and_a_brush_that_joins_leaves_strokes_elsewhere_theirs(
    folder: Path, tmp_path: Path
) -> None:
    Image.fromarray(np.tile(np.array([[[255, 0, 0]], [[255, 255, 255]]], np.uint8), (1, 2, 1))).save(
        tmp_path / "map.png"
    )
    (tmp_path / "map.toml").write_text('[top]\ncolour = "#ff0000"\nbrush = "fineliner"\nshare = 0.5\n')
    files: dict[str, Any] = {"regions": tmp_path / "map.png", "say": tmp_path / "map.toml"}
    quick: dict[str, Any] = {"strokes": 24, "paints": 3, "steps": 4, "px": 48, "size": SIDE, "brush": "marker"}
    painting = ms.plan(folder / "disc.png", **quick, **files)
    assert brushes_of_regions(painting) == {("top", "fineliner"), ("rest", "marker")}
    write_painting(painting, tmp_path / "painting.json")
    options = planned_before(painting, {**files, "again": tmp_path / "painting.json"})
    assert options.brush == "marker"
    after = prepare(PlanRequest(folder / "disc.png", replace(options, brush="wash")))
    assert after.again is not None
    names = [after.brushes[number].name for number in after.again.start(after.problem).brush_of.tolist()]
    assert names == [painting.paints[stroke.paint].brush for stroke in painting.strokes]
    assert after.provenance.options["brush"] == "wash,marker"


def brushes_of_regions(painting: Painting) -> set[tuple[str | None, str]]:
    return {(stroke.region, painting.paints[stroke.paint].brush) for stroke in painting.strokes}


def test_a_second_brush_is_refused_for_a_drawing_in_ink_by_what_it_is_drawn_with(folder: Path) -> None:
    quick: dict[str, Any] = {"strokes": 6, "steps": 2, "px": 24, "size": SIDE}
    drawing = ms.plan(folder / "disc.png", brush="fineliner", ink="black", **quick)
    with pytest.raises(
        InputError, match="in ink with fineliner, and ink is drawn with one brush; name that one with brush"
    ):
        ms.plan(folder / "disc.png", again=drawing, brush="marker")
    options = ms.PlanOptions(**quick)
    with pytest.raises(InputError, match="name that one with brush"):
        ms.plan(folder / "disc.png", again=drawing, options=options)
    drawn = ms.plan(folder / "disc.png", again=drawing, options=options, brush="fineliner")
    assert list(drawn.brushes) == ["fineliner"]


def test_the_camera_leaves_locked_strokes_alone_too(changed: Painting) -> None:
    sheet = np.ones((48, 48, 3), dtype=np.float32)
    plain = [stroke for stroke in changed.strokes if stroke.origin == "planned"]
    painting = changed.model_copy(update={"strokes": tuple(plain)})
    first = plain[0].id
    seen = replanned(painting, {first}, sheet, picture(), steps=QUICK)
    assert seen.strokes[0] == plain[0]
    assert locked(seen) == locked(painting)


def test_python_plans_again_with_the_options_of_the_painting(folder: Path, changed: Painting, after: Painting) -> None:
    painting = ms.plan(again=folder / "plan" / "changed.json", steps=QUICK)
    assert painting.strokes == after.strokes
    assert painting.provenance.options["brush"] == "marker"
    assert ms.plan(folder / "disc.png", again=changed, steps=QUICK).strokes == after.strokes


def test_a_painting_among_the_options_is_planned_again_as_one_that_is_given(folder: Path, changed: Painting) -> None:
    file, few = folder / "plan" / "changed.json", PlanOptions(style="loops", size=SIDE, steps=QUICK)
    among = ms.plan(options=replace(few, again=file))
    assert among.strokes == ms.plan(again=file, options=few).strokes
    assert locked(among) == locked(changed)


def test_options_that_leave_out_the_regions_of_a_painting_are_told_of_it(changed: Painting) -> None:
    options: dict[str, Any] = {**changed.provenance.options, "regions": "map.svg", "say": "map.toml"}
    directed = changed.model_copy(update={"provenance": changed.provenance.model_copy(update={"options": options})})
    with pytest.raises(InputError, match=r"planned with the file map\.svg; name that once more, with regions"):
        ms.plan(picture(), again=directed, steps=QUICK)
    with pytest.warns(UserWarning, match="these options leave that out") as caught:
        ms.plan(picture(), again=directed, options=PlanOptions(style="loops", size=SIDE, steps=1))
    assert [str(warning.message) for warning in caught] == [
        f"it was planned with the file {file}, and these options leave that out; name it with {name} to keep it"
        for file, name in (("map.svg", "regions"), ("map.toml", "say"))
    ]


def test_a_brush_that_no_library_has_is_the_paintings_own(tmp_path: Path) -> None:
    own = ms.load_brush("marker").model_copy(update={"name": "mine"})
    painting = ms.plan(picture(), brush=own, strokes=5, steps=1, px=16)
    assert ms.plan(picture(), again=painting).brushes == {"mine": own}
    with pytest.raises(InputError, match="there is no brush 'yours'"):
        ms.plan(picture(), again=painting, brush="mine,yours")
    assert ms.plan(picture(), again=painting, brush=["mine"]).brushes == {"mine": own}


@few_strokes
def test_a_single_paint_stays_the_paint_or_the_ink_it_was_however_often_it_is_planned_again(folder: Path) -> None:
    (folder / "tube.csv").write_text("name,colour\nnight,#102040\n")
    ways: dict[str, Any] = {"paints": 1}, {"ink": "#102040"}, {"paints_from": folder / "tube.csv"}
    quick: dict[str, Any] = {"strokes": 6, "steps": 2, "px": 24, "size": SIDE, "style": "loops", "brush": "fineliner"}
    for way, is_ink in zip(ways, (False, True, True), strict=True):
        file = folder / "plan" / "single.json"
        write_painting(ms.plan(folder / "disc.png", **quick, **way), file)
        for _ in range(2):
            prepared = prepared_from(file)
            assert prepared.settings.in_ink == is_ink, way
            assert (prepared.tones is not None) == is_ink, way
            write_painting(prepared.painting(prepared.plan(lambda progress: True, None)), file)


@few_strokes
def test_inks_stay_inks_and_paints_of_a_file_paints_however_often_they_are_planned_again(folder: Path) -> None:
    (folder / "tubes.csv").write_text("name,colour\nnight,#102040\nsun,#e0a020\n")
    ways: dict[str, Any] = {"ink": "#102040, #e0a020"}, {"paints_from": folder / "tubes.csv"}
    quick: dict[str, Any] = {"strokes": 20, "steps": 2, "px": 24, "size": SIDE, "style": "loops", "brush": "fineliner"}
    for way, are_inks in zip(ways, (True, False), strict=True):
        file = folder / "plan" / "two.json"
        write_painting(ms.plan(folder / "disc.png", **quick, **way), file)
        for _ in range(2):
            prepared = prepared_from(file)
            assert prepared.settings.in_ink == are_inks, way
            assert len(prepared.settings.palette) == 2 or not are_inks
            assert (prepared.tones is not None) == are_inks, way
            write_painting(prepared.painting(prepared.plan(lambda progress: True, None)), file)


@few_strokes
@pytest.mark.parametrize("was", [{"ink": "#102040,#e0a020"}, {"paints": 2}])
def test_inks_and_paints_stay_what_they_were_whatever_other_options_say(folder: Path, was: dict[str, Any]) -> None:
    quick: dict[str, Any] = {"steps": 2, "px": 24, "size": SIDE, "style": "loops", "brush": "fineliner"}
    before = ms.plan(folder / "disc.png", strokes=20, **quick, **was)
    for other in ({}, {"ink": "black"}):
        after = ms.plan(folder / "disc.png", again=before, options=PlanOptions(strokes=20, **quick, **other))
        assert (is_in_ink(after), palette_of(after)) == (is_in_ink(before), palette_of(before))


@few_strokes
def test_an_ink_that_no_stroke_has_is_among_those_that_it_is_planned_again_in(folder: Path) -> None:
    quick: dict[str, Any] = {"strokes": 6, "steps": 2, "px": 24, "size": SIDE, "style": "loops", "brush": "fineliner"}
    painting = ms.plan(np.full((24, 24, 3), 0.6, dtype=np.float32), ink="black,red", **quick)
    assert [paint.hex for paint in painting.paints] == ["#000000"]
    assert palette_of(painting) == ((0, 0, 0), (1, 0, 0))


def test_a_text_alone_has_no_picture(folder: Path, changed: Painting) -> None:
    alone = changed.provenance.model_copy(update={"image": None, "image_sha256": None})
    assert picture_near(changed.model_copy(update={"provenance": alone}), folder / "alone.json") is None


def refusal(folder: Path, painting: Painting, **given: Any) -> str:
    write_painting(painting, folder / "plan" / "refused.json")
    with pytest.raises(InputError) as refused:
        again(folder / "plan" / "refused.json", **given)
    return str(refused.value)


def planned_with(painting: Painting, **options: Any) -> Painting:
    made = painting.provenance
    provenance = made.model_copy(update={"options": {**made.options, **options}})
    return painting.model_copy(update={"provenance": provenance})


@pytest.mark.parametrize(
    ("was", "given"),
    [({"look": "sea.jpg"}, {"look": Path("/pictures/sea.jpg")}), ({"text": "a boat"}, {"text": "a ship"})],
)
def test_weights_stay_where_the_look_is_named_once_more_or_the_text_is_another(
    changed: Painting, was: dict[str, str], given: dict[str, Any]
) -> None:
    weights = {"tone": 1.0, **dict.fromkeys(was, 2.0)}
    options = planned_before(planned_with(changed, weights=weights, **was), given)
    assert options.weights == weights
    assert {name: getattr(options, name) for name in given} == given


def test_what_cannot_be_planned_again_is_refused(folder: Path, changed: Painting) -> None:
    every = LockStrokes(strokes=tuple(stroke.id for stroke in changed.strokes))
    assert "all 19 strokes are locked or painted, and strokes asks for no more; unlock some" in refusal(
        folder, edited(changed, [every]), strokes=19
    )
    asked = "the painting is on a sheet of 60 x 60 mm, and size asks for 70 x 60 mm; give the size of the painting"
    assert asked in refusal(folder, changed, size="70x60mm")
    assert "again keeps the sheet, the paints and the pressure of the painting; leave out ink" in refusal(
        folder, changed, ink="black"
    )
    assert "leave out pressure" in refusal(folder, changed, pressure=0.3)
    pressed = {name: brush.model_copy(update={"alpha": 1e-3}) for name, brush in changed.brushes.items()}
    assert "this machine only lifts its pen, and the painting presses its brush marker more and less; leave" in refusal(
        folder, changed.model_copy(update={"brushes": pressed}), robot="grbl"
    )
    line = '<g id="paint"><path d="M1 1h5" stroke="red"/></g>'
    (folder / "guides.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">{line}</svg>')
    assert "lines on a layer called paint are painted with a new plan; add them to the painting as strokes" in refusal(
        folder, changed, guides=folder / "guides.svg"
    )
    assert "planned with the file sea.jpg; name that once more, with look" in refusal(
        folder, planned_with(changed, look="sea.jpg")
    )
    assert "was planned with options of another kind: px" in refusal(folder, planned_with(changed, px="many"))
    assert "again plans in one piece; choose a smaller px" in refusal(folder, changed, px=4000)
    drawing = changed.model_copy(update={"literal": True})
    assert "was not planned, so it cannot be planned again" in refusal(folder, drawing)
    bare = changed.model_copy(update={"strokes": (), "paints": (), "brushes": {}})
    assert "the painting has no stroke, and so no paint to plan it again with; plan anew" in refusal(folder, bare)
    elsewhere = changed.provenance.model_copy(update={"image": "elsewhere.png"})
    assert "there is no elsewhere.png, from which it was planned, here or beside" in refusal(
        folder, changed.model_copy(update={"provenance": elsewhere})
    )


def test_a_stroke_of_another_hand_is_planned_on_as_nearly_as_the_hand_can(folder: Path, changed: Painting) -> None:
    from maulstick.jobs.plan.again import parameters_of

    prepared = prepare(PlanRequest(folder / "disc.png", PlanOptions(size=SIDE, px=48, strokes=5, brush="marker")))
    problem = replace(prepared.problem, brushes=tuple(changed.brushes.values()))
    found = parameters_of(changed.strokes, changed, problem).trajectories(problem.style).numpy()
    wanted = np.array([resample(np.array(stroke.trajectory)) for stroke in changed.strokes])
    assert np.abs(found - wanted)[..., :2].mean() < 0.5e-3
