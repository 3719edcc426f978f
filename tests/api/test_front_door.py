"""The front door: what ``import maulstick as ms`` gives, how little that loads, and that its documentation is true."""

import doctest
import importlib
import io
import pkgutil
import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

import maulstick as ms
from maulstick.errors import InputError
from maulstick.jobs.plan.request import demo_picture
from maulstick.painting import painting as records
from maulstick.painting.metrics import Metrics
from maulstick.painting.raster import Canvas
from maulstick.robot.simulated.easel import SimulatedEasel
from maulstick.robot.simulated.sheets import sheet_for
from maulstick.strokes.ink import write_ink
from tests.cli.test_brush_fit import draw_trials

pytestmark = pytest.mark.filterwarnings("ignore:libmypaint is not installed")

QUICK = {"strokes": 6, "steps": 3, "px": 24, "paints": 2, "size": "60x60mm"}
FUNCTIONS = [name for name in ms.__all__ if name != "__version__"]
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">{}</svg>'


@pytest.fixture(scope="module")
def painting() -> ms.Painting:
    return ms.plan(demo_picture(), **QUICK)


@pytest.fixture(scope="module")
def drawing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("drawing") / "drawing.svg"
    arcs = (f'<path d="M{x} 20 q 5 {bend} 20 30" fill="none"/>' for x in range(5, 70, 5) for bend in (-12, 3))
    path.write_text(SVG.format("".join(arcs)))
    return path


def loaded_by(code: str) -> set[str]:
    """Names of packages that are loaded after this code, in an interpreter of its own."""
    told = "import sys; print(' '.join({name.partition('.')[0] for name in sys.modules}))"
    ran = subprocess.run([sys.executable, "-c", f"{code}; {told}"], capture_output=True, text=True, check=True)
    return set(ran.stdout.split())


def test_importing_maulstick_loads_nothing_that_is_large() -> None:
    large = {"torch", "matplotlib", "nicegui", "numpy", "scipy", "skimage", "pydantic", "typer"}
    assert not large & loaded_by("import maulstick as ms; ms.__version__; ms.InputError; dir(ms)")


def test_the_options_of_a_plan_and_a_painting_load_no_torch() -> None:
    assert "torch" not in loaded_by("import maulstick as ms; ms.PlanOptions(strokes=3); ms.Painting; ms.read_painting")


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_name_exists_and_says_what_it_is(name: str) -> None:
    thing = getattr(ms, name)
    assert thing.__doc__
    assert name in dir(ms)
    assert thing.__module__.startswith("maulstick.")


def test_there_is_no_name_that_is_not_promised() -> None:
    with pytest.raises(AttributeError):
        _ = ms.nothing  # type: ignore[attr-defined]


def test_whatever_a_person_can_mend_is_caught_by_one_name_or_by_its_kind() -> None:
    with pytest.raises(ms.InputError, match="there is no style 'nobody'"):
        ms.plan(demo_picture(), style="nobody", **QUICK)
    for kind in (ms.InputError, ms.OutputError, ms.MachineError):
        assert issubclass(kind, ms.MaulstickError)


def modules() -> Iterator[str]:
    for found in pkgutil.walk_packages(ms.__path__, "maulstick."):
        if not found.name.endswith("gpu_programs"):  # in Triton's language, which is not everywhere
            yield found.name


def test_no_module_takes_the_place_of_a_function() -> None:
    for name in modules():
        importlib.import_module(name)
    assert not {name.removeprefix("maulstick.") for name in modules()} & set(ms.__all__)
    assert callable(ms.plan)
    assert len(ms.plan(demo_picture(), **QUICK).strokes) <= 6


def test_every_line_of_the_documentation_runs(painting: ms.Painting, drawing: Path, tmp_path: Path) -> None:
    given: dict[str, Any] = {
        "ms": ms,
        "demo_picture": demo_picture(),
        "drawing": drawing,
        "folder": tmp_path,
        "painting": ms.plan(demo_picture(), strokes=6, steps=3, px=24, paints=2),
        "ink": ms.read_ink(drawing),
        **{name: getattr(ms, name) for name in FUNCTIONS},
    }
    runner, tried = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS), set()
    for name in FUNCTIONS:
        for test in doctest.DocTestFinder().find(getattr(ms, name), name, globs=dict(given)):
            if test.examples:
                tried.add(test.name.partition(".")[0])
                said: list[str] = []
                assert runner.run(test, out=said.append).failed == 0, "".join(said)
    assert tried >= {"plan", "render", "compare", "paint", "read_ink", "fit_style", "load_style", "load_brush"}
    assert tried >= {"read_painting", "Painting", "PlanOptions"}


def test_one_line_makes_a_painting_and_more_show_save_and_paint_it(painting: ms.Painting, tmp_path: Path) -> None:
    painting.save(tmp_path / "cat.json")
    assert ms.read_painting(tmp_path / "cat.json") == painting
    ms.render(painting, px=64).save(tmp_path / "cat.png")
    with Image.open(tmp_path / "cat.png") as image:
        assert image.size == (64, 64)
    painting.save(tmp_path / "cat.svg")
    assert (tmp_path / "cat.svg").read_text() == painting.to_svg()
    assert painting._repr_png_().startswith(b"\x89PNG")
    result = ms.paint(painting, robot="sim")
    assert (result.painted, result.strokes) == (len(painting.strokes),) * 2
    assert result.photograph is not None
    assert np.asarray(result.photograph).min() < 200


def test_the_painting_is_the_one_that_the_command_would_make(painting: ms.Painting, tmp_path: Path) -> None:
    from tests.cli.conftest import run

    words = ("--strokes", "6", "--steps", "3", "--px", "24", "--paints", "2", "--size", "60x60mm")
    assert run("plan", "--demo", *words, "--out", tmp_path / "out").code == 0
    assert ms.read_painting(tmp_path / "out" / "painting.json") == painting


def test_pictures_are_paths_images_and_arrays(painting: ms.Painting) -> None:
    with Image.open(demo_picture()) as image:
        image.load()
    pixels = np.asarray(image)
    for picture in (str(demo_picture()), image, pixels, pixels.astype(np.float64) / 255):
        assert ms.plan(picture, **QUICK).strokes == painting.strokes
        assert ms.compare(painting, picture).psnr == pytest.approx(ms.compare(painting, demo_picture()).psnr, abs=1e-3)
    assert isinstance(ms.compare(painting, pixels[..., 0]), Metrics)


@pytest.mark.parametrize(
    ("picture", "said"),
    [
        (np.zeros((4, 4, 3), dtype=np.int64), "an array of int64; give uint8, or float in [0, 1]"),
        (np.full((4, 4, 3), 200.0), "values from 200 to 200; floats must be in [0, 1], so divide them first"),
        (np.full((4, 4, 3), np.nextafter(np.float32(1), 2)), "values from 1.0000001 to 1.0000001; floats must be in"),
        (np.full((4, 4, 3), np.nan), "floats must be in [0, 1]"),
        (np.full((4, 4, 3), -0.1), "floats must be in [0, 1]"),
        (np.zeros((3, 4, 4, 3)), "has shape (3, 4, 4, 3); it must be (H, W, 3), or (H, W) for greys"),
        (np.zeros((4, 4, 4)), "has shape (4, 4, 4)"),
        (np.zeros((0, 4, 3)), "has shape (0, 4, 3)"),
        (Image.fromarray(np.full((4, 4), 128, np.float32)), "grey values are not 16-bit numbers, nor fractions of 1"),
        (Image.new("RGB", (0, 4)), "has 0 x 4 pixels; it must have one at least"),
        ([[0.5, 0.5], [0.5]], "the picture is no array: setting an array element with a sequence"),
        (
            torch.zeros(4, 4, requires_grad=True),
            "the picture is no array: Can't call numpy() on Tensor that requires grad",
        ),
        ("none.jpg", "none.jpg; check its name and folder"),
    ],
)
def test_a_picture_of_another_kind_is_refused_and_never_clipped(picture: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        ms.plan(picture)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"strokes": 0}, "strokes is 0; it must be from 1 to 100000"),
        ({"strokes": 2.5}, "strokes is 2.5; it must be from 1 to 100000"),
        ({"colour": "red"}, "there is no option 'colour'; there are: again, arrange, ask_every, background"),
        ({"ink": "black", "paints": 3}, "paints and ink are two ways to say what to paint with"),
        ({"background": "none.jpg", "paper": "grey"}, "background shows the sheet as it is, and paper its colour"),
        ({"style": "nobody"}, "there is no style 'nobody'"),
        ({"weights": {"tone": "much"}}, "the weight of tone is 'much'; it must be from 0 to 1000"),
        ({"size": (0.2, 0.16)}, "size is (0.2, 0.16); it must be of the kind str"),
        ({"paper": (0, 0, 0)}, "paper is (0, 0, 0); it must be of the kind str"),
        ({"ink": (0, 0, 0)}, "ink is (0, 0, 0); it must be of the kind str | None"),
        ({"margin": 0.01}, "margin is 0.01; it must be of the kind str"),
        ({"weights": ["edges=1"]}, "weights is ['edges=1']; it must be of the kind Mapping[str, float]"),
        ({"pin": [3]}, "pin is [3]; it must be of the kind tuple[str, ...]"),
        ({"paints_from": ["red"]}, "paints_from is ['red']; it must be of the kind Path | None"),
        ({"style": 3}, "style is 3; it must be of the kind str | Path | Style | None"),
        (
            {"brush": ["round", 3]},
            "brush is ['round', 3]; it must be of the kind str | Path | Brush | Sequence[str | Path | Brush]",
        ),
        ({"again": 3}, "again is 3; it must be of the kind Painting | str | Path | None"),
    ],
)
def test_options_are_refused_in_the_words_of_python(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError) as caught:
        ms.plan(demo_picture(), **options)
    assert said in str(caught.value)
    assert "--" not in str(caught.value)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda painting: ms.render(painting, px="a"), "px is 'a'; it must be of the kind int"),
        (lambda painting: ms.render(painting, px=1.5), "px is 1.5; it must be a whole number"),
        (lambda painting: ms.paint(painting, colour="red"), "there is no option 'colour'; there are: camera, colours"),
        (lambda painting: ms.paint(painting, look=True), "there is no option 'look'; there are: camera, colours"),
        (lambda painting: ms.read_painting("a.svg", hach="1mm"), "there is no option 'hach'; there are: hatch"),
        (lambda painting: ms.paint("a.svg", drawing={"hach": "1mm"}), "there is no option 'hach'; there are: hatch"),
        (
            lambda painting: ms.paint(painting.remove(*(each.id for each in painting.strokes))),
            "the painting has no strokes",
        ),
        (lambda painting: ms.paint(painting, drawing={"hatch": "1mm"}), "the painting is no SVG, and a painting is"),
        (lambda painting: ms.paint(painting, from_stroke=1.5), "from_stroke is 1.5; it must be 1 to the"),
        (lambda painting: ms.paint(painting, from_pen=1.5), "from_pen is 1.5; it must be 1 to"),
        (lambda painting: ms.plan(demo_picture(), workers=1.5), "workers is 1.5; it must be from 1 to 32"),
        (lambda painting: ms.sweep({"axes": {"seed": [0]}}, at_once=1.5), "at_once is 1.5; it must be from 1 to 1024"),
        (lambda painting: ms.sweep({"axes": {"seed": [0]}}, retries=0.5), "retries is 0.5; it must be from 0 to 100"),
        (lambda painting: ms.compare(3, demo_picture()), "painting is 3; it must be of the kind Painting | str | Path"),
        (lambda painting: ms.read_ink("wine.svg", size=3), "size is 3; it must be of the kind str | None"),
        (lambda painting: ms.load_brush(3), "name is 3; it must be of the kind str | Path"),
        (lambda painting: ms.paint(painting, robot=3), "robot is 3; it must be of the kind str | Robot"),
        (lambda painting: ms.sweep(3), "grid is 3; it must be of the kind str | Path | Mapping[str, object]"),
        (lambda painting: painting.lock("face"), "strokes[0]: Input should be a valid integer"),
        (lambda painting: painting.add("line", paint=0), "it must be (n, 3) of x, y and pressure"),
        (lambda painting: painting.save(3), "path is 3; it must be of the kind str | Path"),
        (lambda painting: painting.save("x.txt"), "x.txt ends neither in .json nor in .svg"),
    ],
)
def test_what_is_of_another_kind_is_refused_in_one_line(painting: ms.Painting, call: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        call(painting)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_style_and_a_brush_are_loaded_by_any_path(tmp_path: Path) -> None:
    (tmp_path / "mine.json").write_text(ms.load_brush("marker").model_dump_json())
    assert ms.load_brush(tmp_path / "mine.json") == ms.load_brush("marker")
    file = Path(ms.__file__).parent / "style" / "built_in" / "loops.json"
    assert ms.load_style(file).name == ms.load_style(str(file)).name == "loops"


def test_a_style_and_a_brush_are_planned_with_by_any_path(tmp_path: Path) -> None:
    (tmp_path / "mine.json").write_text(ms.load_brush("marker").model_dump_json())
    file, quick = Path(ms.__file__).parent / "style" / "built_in" / "loops.json", {"strokes": 5, "steps": 1, "px": 16}
    one = ms.plan(demo_picture(), style=file, brush=tmp_path / "mine.json", **quick)
    several = ms.plan(demo_picture(), style=file, brush=[tmp_path / "mine.json", "wash"], **quick)
    assert {stroke.style.name for stroke in one.strokes if stroke.style} == {"loops"}
    assert ([*one.brushes], several.provenance.options["brush"]) == (["marker"], "wash,marker")


def test_a_warning_names_the_line_that_called(drawing: Path, tmp_path: Path) -> None:
    file = tmp_path / "drawing.svg"
    file.write_text(SVG.format('<path d="M-5 50h50"/>'))
    for call in (ms.read_painting, ms.render, ms.paint):
        with pytest.warns(UserWarning, match="cut at its edges") as caught:
            call(file)
        assert caught[0].filename == __file__


def test_a_stroke_of_complex_numbers_is_refused_as_what_it_is_and_no_part_of_it_dropped(painting: ms.Painting) -> None:
    points = np.array([(0.03 + 1j, 0.03, 0.5), (0.04, 0.03, 0.5)])
    for trajectory in (points, points.tolist()):
        with pytest.raises(InputError, match=r"a trajectory is no array: .*complex.*; it must be \(n, 3\) of x, y and"):
            painting.add(trajectory, paint=0)


def test_what_the_command_notes_of_a_plan_is_a_warning() -> None:
    with pytest.warns(UserWarning, match="only lifts its pen|is larger than the machine") as caught:
        ms.plan(demo_picture(), **{**QUICK, "size": "A2"}, brush="marker", robot="axidraw")
    held, large = (str(warning.message) for warning in caught)
    assert held.startswith("this machine only lifts its pen, so the brush marker is held at one pressure, 0.5")
    assert large.startswith("this sheet, 420 by 594 mm, is larger than the machine reaches")
    assert {warning.filename for warning in caught} == {__file__}


def test_a_plan_of_which_no_stroke_is_left_is_a_warning() -> None:
    with pytest.warns(UserWarning, match="^no stroke is left, for none brings the sheet nearer") as caught:
        planned = ms.plan(demo_picture(), **{**QUICK, "paints": None}, ink="white", style="loops", brush="fineliner")
    assert not planned.strokes
    assert {warning.filename for warning in caught} == {__file__}


def test_there_must_be_something_to_paint() -> None:
    with pytest.raises(InputError, match="give a picture, or a text"):
        ms.plan()


def test_progress_is_told_and_can_end_a_plan() -> None:
    seen: list[float] = []

    def progress(step: Any) -> bool:
        seen.append(step.done)
        return len(seen) < 3

    assert ms.plan(demo_picture(), **{**QUICK, "steps": 1000}, progress=progress).strokes
    assert len(seen) < 100  # it finishes what it has
    assert seen == sorted(seen)


def test_numbers_of_numpy_are_numbers() -> None:
    asked: dict[str, Any] = {**QUICK, "strokes": np.int64(6), "seed": np.uint8(5), "exact": np.True_}
    again = ms.plan(demo_picture(), **asked, weights={"tone": np.float32(1)})
    assert again == ms.plan(demo_picture(), **QUICK, seed=5, exact=True, weights={"tone": 1.0})
    with pytest.raises(InputError, match="strokes is 0; it must be from 1 to"):
        ms.plan(demo_picture(), strokes=np.int64(0))


def test_options_are_defaults_that_single_ones_differ_from() -> None:
    options = ms.PlanOptions(**QUICK)
    again = ms.plan(demo_picture(), options=options, seed=5)
    assert again == ms.plan(demo_picture(), **QUICK, seed=5)


def test_several_brushes_are_named_or_given(painting: ms.Painting) -> None:
    brushes = [ms.load_brush("fineliner"), ms.load_brush("marker")]
    ways = ("marker,fineliner", ["fineliner", "marker"], brushes)
    named, listed, given = (ms.plan(demo_picture(), brush=brush, **QUICK) for brush in ways)
    assert given.strokes == listed.strokes == named.strokes
    assert given.provenance.options["brush"] == "marker,fineliner"
    with pytest.raises(InputError, match="the brush marker is named twice"):
        ms.plan(demo_picture(), brush=[brushes[1], brushes[1]], **QUICK)


def test_ink_of_unknown_size_is_read_with_a_warning_and_without_one_where_the_size_is_said(tmp_path: Path) -> None:
    path = tmp_path / "line.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path d="M1 1 L8 8"/></svg>')
    with pytest.warns(
        UserWarning, match=r"^line\.svg does not say how large it was drawn: .*; say it with size"
    ) as caught:
        ms.read_ink(path)
    assert caught[0].filename == __file__
    assert ms.read_ink(path, longest="90mm").summary().startswith("1 stroke, 0.127 m")


def test_a_size_that_cannot_be_kept_is_refused(drawing: Path, tmp_path: Path) -> None:
    kept = tmp_path / "me.ink.npz"
    write_ink(ms.read_ink(drawing), kept)
    for asked in ({"size": "A4"}, {"longest": "9mm"}):
        with pytest.raises(InputError, match=r"me\.ink\.npz has a size already; leave out size and longest"):
            ms.read_ink(kept, **asked)
    for text in ("0mm", "51m"):
        with pytest.raises(InputError, match=f"^longest is {text}; it must be between 1 mm and 50 m$"):
            ms.read_ink(drawing, longest=text)


def test_a_drawing_that_is_not_ink_yet_is_told_how_it_becomes_ink_in_python(drawing: Path) -> None:
    with pytest.raises(InputError, match=r"is neither ink nor strokes; make ink of it with read_ink$"):
        ms.fit_style(drawing)


def test_a_hand_that_was_learned_plans_without_being_kept(
    drawing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    style = ms.fit_style(ms.read_ink(drawing), "arcs")
    painting = ms.plan(demo_picture(), **QUICK, style=style, brush=ms.load_brush("marker"))
    assert {stroke.style.name for stroke in painting.strokes if stroke.style is not None} == {"arcs"}
    assert list(painting.brushes) == ["marker"]
    with pytest.raises(InputError, match="there is no style 'arcs'"):
        ms.load_style("arcs")
    ms.fit_style(ms.read_ink(drawing), "arcs", keep=True)
    assert ms.load_style("arcs").hash == style.hash


def test_a_robot_of_ones_own_paints(painting: ms.Painting, tmp_path: Path) -> None:
    painting.save(tmp_path / "cat.json")
    brush = next(iter(painting.brushes.values()))
    robot = SimulatedEasel(sheet_for([brush], Canvas(0.06, 0.06, 2000)))
    result = ms.paint(tmp_path / "cat.json", robot=robot, ask=lambda message: None)
    assert result.painted == len(painting.strokes)
    assert result.photograph is None
    assert robot.sheet.image().min() < 0.9
    with pytest.raises(InputError, match="go on with paint\\(\\.\\.\\., resume=True\\), or start on a new sheet"):
        ms.paint(tmp_path / "cat.json", robot=robot)
    again = ms.paint(tmp_path / "cat.json", robot=robot, restart=True, ask=lambda message: None)
    assert again.painted == result.painted
    with pytest.raises(InputError, match="from_pen is 99; it must be 1 to"):
        ms.paint(tmp_path / "cat.json", robot=robot, restart=True, from_pen=99)


def test_a_machine_wants_a_file_to_keep_its_journal_beside(painting: ms.Painting) -> None:
    with pytest.raises(InputError, match="save the painting, and give its path"):
        ms.paint(painting, robot="grbl:/dev/ttyUSB0")
    with pytest.raises(InputError, match="there is no machine 'simply'"):
        ms.paint(painting, robot="simply")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"resume": True, "restart": True}, "resume knows where to go on; leave out restart, from_stroke and from_pen"),
        ({"resume": True, "from_stroke": 2}, "resume knows where to go on"),
        ({"from_stroke": 1, "from_pen": 1}, "from_stroke and from_pen both say where to begin; leave out one"),
        ({"unfinished": True}, "unfinished is about the stroke that an earlier run began; it goes with resume"),
    ],
)
def test_ways_to_begin_that_exclude_each_other_are_refused(
    painting: ms.Painting, tmp_path: Path, options: dict[str, Any], said: str
) -> None:
    painting.save(tmp_path / "cat.json")
    with pytest.raises(InputError, match=said):
        ms.paint(tmp_path / "cat.json", **options)
    assert [*tmp_path.iterdir()] == [tmp_path / "cat.json"]


@pytest.mark.parametrize("spec", ["foo", "simplotter", "grbl"])
def test_a_machine_that_there_is_not_is_told_before_the_file_that_one_would_want(
    painting: ms.Painting, spec: str
) -> None:
    with pytest.raises(InputError, match="there are: sim, sim:pens, sim:real, grbl:"):
        ms.paint(painting, robot=spec)


def test_a_question_that_nobody_can_answer_is_told(painting: ms.Painting, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO())
    with pytest.raises(InputError, match=r"^nobody is there to .*; run it in a terminal, or give ask$"):
        ms.paint(painting, robot="sim:pens")


def test_only_what_has_a_file_is_gone_on_with(painting: ms.Painting, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="give the path of that file"):
        ms.paint(painting, resume=True)
    painting.save(tmp_path / "cat.json")
    count = len(painting.strokes)
    result = ms.paint(tmp_path / "cat.json", from_stroke=count)
    assert (result.painted, result.photograph is None) == (count, False)
    result = ms.paint(tmp_path / "cat.json", resume=True)
    assert (result.painted, result.photograph is None) == (count, True)


def test_a_long_frieze_is_shown_in_a_notebook_too(painting: ms.Painting) -> None:
    for width in (4.0, 40.0, 400.0):
        sheet = painting.sheet.model_copy(update={"width": width})
        png = painting.model_copy(update={"sheet": sheet, "area": (0.0, 0.0, width, 0.06)})._repr_png_()
        with Image.open(io.BytesIO(png)) as image:
            assert image.width <= 8192


def test_what_a_program_has_made_of_torch_changes_no_plan_and_is_kept(painting: ms.Painting, tmp_path: Path) -> None:
    code = f"""
import torch
torch.set_default_dtype(torch.float64)
torch.set_default_device("meta")
import maulstick as ms
with torch.inference_mode():
    planned = ms.plan({str(demo_picture())!r}, **{QUICK})
    planned.save({str(tmp_path / "planned.json")!r})
    planned._repr_png_()
    ms.paint(planned)
    print(torch.get_default_dtype(), torch.get_default_device(), torch.is_inference_mode_enabled())
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (ran.stdout.split(), ran.returncode) == (["torch.float64", "meta", "True"], 0), ran.stderr
    assert ms.read_painting(tmp_path / "planned.json").strokes == painting.strokes


def test_what_is_painted_is_left_out_wherever_the_background_is_given(painting: ms.Painting, tmp_path: Path) -> None:
    file, photograph = tmp_path / "cat.json", tmp_path / "sheet.png"
    painting.save(file)
    done = ms.paint(file, robot="sim").photograph
    assert done is not None
    done.save(photograph)
    with pytest.raises(InputError, match="all 6 strokes are locked or painted"):
        ms.plan(demo_picture(), again=file, background=photograph)
    with pytest.raises(InputError, match="all 6 strokes are locked or painted"):
        ms.plan(demo_picture(), again=file, options=ms.PlanOptions(**QUICK, background=photograph))


def test_a_painting_is_a_record_with_more_to_say(painting: ms.Painting) -> None:
    assert isinstance(painting, records.Painting)
    assert records.Painting(**dict(painting)) == records.Painting(**dict(ms.Painting.of(painting)))


def test_a_painting_is_told_in_one_line(painting: ms.Painting) -> None:
    counts = f"{len(painting.strokes)} strokes, {len(painting.paints)} paints"
    assert str(painting) == repr(painting) == f"<Painting: {counts}, {painting.sheet.millimetres}>"


def test_ink_and_hands_are_told_in_one_line(drawing: Path) -> None:
    ink = ms.read_ink(drawing)
    assert repr(ink) == f"<Ink: {ink.summary()}>"
    assert repr(ms.load_style("elephant")) == "<Exemplar: elephant>"
    assert repr(ms.load_style("free")) == "<FreeStyle: free>"


def test_a_brush_is_fitted_to_trials_kept_on_request_and_says_what_it_cannot_tell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    draw_trials("trials", 6)
    Path("trials/0001.png").unlink()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        brush = ms.fit_brush("trials", "twig", keep=True)
    said = [str(warning.message) for warning in told]
    assert [text for text in said if text.startswith("only 5 strokes could be used: ")]
    (left_out,) = (text for text in said if "left out" in text)
    assert left_out.startswith("1 of 6 trials is left out: stroke 1: the photograph 0001.png is missing")
    assert (brush.name, ms.load_brush("twig")) == ("twig", brush)
    assert brush.widest > 0
    with pytest.raises(InputError, match="the brush marker comes with Maulstick; choose another name"):
        ms.fit_brush("trials", "marker", keep=True)


def test_one_ink_in_a_hand_that_is_arranged_is_drawn_in_its_order() -> None:
    quick: dict[str, Any] = {"strokes": 8, "steps": 2, "px": 24, "size": "60x60mm", "style": "elephant"}
    assert ms.plan(demo_picture(), ink="black", **quick).succession is not None
    assert ms.plan(demo_picture(), ink="black", arrange=0, **quick).succession is None
    assert ms.plan(demo_picture(), paints=2, **quick).succession is None
    assert ms.plan(demo_picture(), ink="black", **quick | {"style": "free"}).succession is None


def test_lengths_by_which_an_svg_is_read_are_said_as_a_person_writes_them_or_in_metres(drawing: Path) -> None:
    said = ms.read_painting(drawing, size="A4", margin="1cm", shortest="0.5 mm")
    assert said == ms.read_painting(drawing, size=(0.21, 0.297), margin=0.01, shortest=0.0005)
    assert said.sheet.millimetres == "210 x 297 mm"
    with pytest.raises(InputError, match=r"^margin: '10' is not a length; write a number and a unit, as in 139mm, "):
        ms.read_painting(drawing, margin="10")
    with pytest.raises(InputError, match=r"^size: .*'B99'.* A4"):
        ms.read_painting(drawing, size="B99")


def test_an_svg_is_read_shown_and_painted(drawing: Path, tmp_path: Path) -> None:
    painting = ms.read_painting(drawing, rotate=90, keep_order=True)
    assert isinstance(painting, ms.Painting)
    assert len(painting.strokes) == 26
    assert ms.render(drawing, px=64).size == (64, 64)
    assert ms.paint(painting, robot="sim").painted == 26
    file = tmp_path / "drawing.svg"
    file.write_text(SVG.format('<path d="M-5 50h50"/><path d="M5 5h9"/>'))
    with pytest.warns(UserWarning, match=r"lines that reach beyond the sheet of 100 x 100 mm are cut at its edges: 1"):
        painted = ms.paint(file, robot="sim", drawing={"hatch": 1e-3})
    assert painted.strokes == 2
    assert ms.paint(file, robot="sim", resume=True).painted == 2
    with pytest.raises(InputError, match=r"hatch is 0\.001 mm; it must be from 0\.05 to 100 mm between lines"):
        ms.paint(file, robot="sim", drawing={"hatch": 1e-6})
    with pytest.raises(InputError, match=r"margin is about how an SVG is read; give it as drawing={\"margin\": 0\.01}"):
        ms.paint(file, robot="sim", margin=0.01)
    with pytest.raises(InputError, match="sice"):
        ms.read_painting(file, sice=3)
    painting.save(tmp_path / "painting.json")
    with pytest.raises(
        InputError, match="is no SVG, and a painting is painted as it was planned; leave out the options of drawings"
    ):
        ms.read_painting(tmp_path / "painting.json", hatch=1e-3)
