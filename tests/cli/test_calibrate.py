import os
import signal
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.calibration.camera import locate
from maulstick.calibration.colour import read_colours
from maulstick.painting.picture import encode_png, read_picture, scaled
from maulstick.robot.easel import read_easel
from maulstick.robot.limits import Limits
from tests.cli.conftest import Ran, Running, run
from tests.support.calibration.photo_studio import CANVAS, CHART_CORNERS, PAPER, TAGS, Studio, bare, chart
from tests.support.robot.fake_grbl import FakeGrbl
from tests.support.robot.obedient_robot import Feeling
from tests.support.robot.recorder import LIMITS, Recorder
from tests.support.tolerances import CHART_SEEN, PICTURE

Image = NDArray[np.float32]
FINE = 2000  # pixels a metre
SIZE = ("--size", "A4-landscape")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which the commands run, and make flat pictures of few pixels."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("maulstick.painting.raster.FINE", FINE)
    return tmp_path


@pytest.fixture(scope="module")
def photographs() -> dict[str, Image]:
    studio = Studio(bare())
    found = {"bare": studio.camera.photograph()}
    studio.sheet = chart()
    found["chart"] = studio.camera.photograph()
    studio.sheet = bare()
    studio.sheet[100:320, 150:440] = 0.4614
    found["grey"] = studio.camera.photograph()
    studio.camera.cover(1, 2)
    return {**found, "hidden": studio.camera.photograph()}


@pytest.fixture(scope="module")
def files(photographs: dict[str, Image]) -> dict[str, bytes]:
    return {f"{name}.png": encode_png(picture) for name, picture in photographs.items()}


@pytest.fixture
def photos(here: Path, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        (here / name).write_bytes(content)


def small(path: str | Path) -> Image:
    """A flat photograph on the pixels of the studio's sheet."""
    picture = read_picture(path)
    size = CANVAS.width_px, CANVAS.height_px
    return scaled(picture, size, (0.0, 0.0, picture.shape[1], picture.shape[0]))


def away(image: Image, sheet: Image) -> float:
    """Mean, without the rim."""
    return float(np.abs(image - sheet)[20:-20, 20:-20].mean())


# tags


@pytest.mark.parametrize("name", ["tags.pdf", "tags.png"])
def test_tags_are_drawn_to_be_printed(name: str) -> None:
    assert run("calibrate", "tags", *SIZE, "--out", name) == (0, f"{name}\n", "")
    assert Path(name).read_bytes()[1:4] in (b"PDF", b"PNG")
    ran = run("calibrate", "tags", *SIZE, "--out", name)
    assert (ran.code, ran.mistake) == (1, f"{name} is already there; choose another --out, or add --overwrite")
    assert run("calibrate", "tags", *SIZE, "--out", name, "--overwrite").code == 0


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--size", "big"), "'big' is not a size; write width x height and a unit"),
        ((*SIZE, "--page", "A77"), "'A77' is not a size"),
        ((*SIZE, "--tag", "0"), "5"),
        ((*SIZE, "--out", "tags.doc"), "'.doc'"),
        ((*SIZE, "--tag", "150"), "mm"),
    ],
)
def test_tags_that_cannot_be_drawn_are_refused(words: tuple[str, ...], text: str) -> None:
    ran = run("calibrate", "tags", *words)
    assert ran.code == 2
    assert text in ran.mistake
    assert not list(Path().iterdir())


# camera


def test_a_photograph_is_made_flat_and_how_far_that_can_be_wrong_is_said(photos: None) -> None:
    ran = run("calibrate", "camera", "chart.png", *SIZE)
    said, path = ran.stdout.splitlines()
    assert (ran.code, ran.stderr, path) == (0, "", "chart-flat.png")
    assert said.startswith("4 tags: 0.")
    assert " mm, at worst 0." in said
    flat = read_picture(path)
    assert flat.shape == (round(CANVAS.height * FINE), round(CANVAS.width * FINE), 3)
    contrast = np.corrcoef(small(path).ravel(), chart().ravel())[0, 1]
    assert contrast > 0.9


def test_four_corners_do_where_there_are_no_tags(photos: None, photographs: dict[str, Image]) -> None:
    view = locate(photographs["chart"], TAGS)
    sheet = np.array([[0, 0], [CANVAS.width, 0], [CANVAS.width, CANVAS.height], [0, CANVAS.height]])
    words = " ".join(f"{x:.1f},{y:.1f}" for x, y in view.to_photo(sheet))
    ran = run("calibrate", "camera", "chart.png", *SIZE, "--corners", words)
    assert (ran.code, ran.stdout) == (0, "four corners: how far that is wrong cannot be known\nchart-flat.png\n")
    by_tags = run("calibrate", "camera", "chart.png", *SIZE, "--out", "tags.png")
    assert by_tags.code == 0
    assert away(small("chart-flat.png"), small("tags.png")) < PICTURE


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (("none.png",), 2, "there is no picture none.png; check its name and folder"),
        ((".",), 2, ". is a folder; name the picture itself"),
        (("chart.png", "--out", "no/flat.png"), 1, "cannot write no/flat.png: its folder does not exist; make the fo"),
        (("hidden.png",), 2, "only 2 of the 4 tags are seen (0, 3); uncover and light 1 (upper right), 2 (lower "),
        (("chart.png", "--out", "flat.jpg"), 2, "--out is flat.jpg; an image is written as PNG"),
        (("chart.png", "--out", "bare.png"), 1, "bare.png is already there; choose another --out"),
        (("chart.png", "--out", "chart.png", "--overwrite"), 2, "--out is chart.png, the photograph itself; choose"),
        (("chart.png", "--keep", "chart.png", "--overwrite"), 2, "--keep is chart.png, the photograph itself; choose"),
        (
            ("chart.png", "--colours", "c.json", "--keep", "c.json", "--overwrite"),
            2,
            "--keep is c.json, the file of --colours itself; choose another --keep",
        ),
        (("chart.png", "--out", "a.png", "--keep", "a.png"), 2, "--out and --keep are both a.png"),
        (("chart.png", "--corners", "1,2"), 2, "--corners is '1,2'; it must be four points, as in '10,12 630,9"),
        (("chart.png", "--corners", "0,0 nan,0 1,1 0,1"), 2, "--corners is '0,0 nan,0 1,1 0,1'; it must be four"),
        (("chart.png", "--corners", "0,0 0,9 9,9 9,0"), 2, "the corners must go round the sheet as a clock does"),
        (("chart.png", "--corners", "9,9 900,9 900,700 9,700"), 2, "the upper right corner of the sheet is at 900,9"),
        (("chart.png", "--colours", "none.json"), 2, "there is no camera's colours none.json"),
        (("chart.png", "--tag", "30"), 2, "a tag is "),
    ],
)  # fmt: skip
def test_a_photograph_that_cannot_be_made_flat_is_one_sentence(
    photos: None, words: tuple[str, ...], code: int, text: str
) -> None:
    before = sorted(Path().iterdir())
    ran = run("calibrate", "camera", *words, *SIZE)
    assert ran.code == code
    assert text in ran.mistake
    assert sorted(Path().iterdir()) == before


@pytest.mark.parametrize("tag", ["25", "25mm", "2.5cm"])
def test_a_length_is_millimetres_or_has_its_unit(tag: str) -> None:
    assert run("calibrate", "tags", *SIZE, "--tag", tag, "--page", "A3", "--out", "tags.png").code == 0
    assert run("calibrate", "tags", *SIZE, "--tag", "25mm", "--page", "A3", "--out", "same.png").code == 0
    assert Path("tags.png").read_bytes() == Path("same.png").read_bytes()


@pytest.mark.parametrize(
    ("tag", "text"),
    [
        ("25ft", "--tag is '25ft'; it must be a length, as 10 for millimetres, 10mm or 1cm"),
        ("300", "--tag is 300 mm; it must be between 5 and 120 mm, for a gap of 15 mm beside it"),
    ],
)
def test_a_tag_that_cannot_be_says_what_came_and_what_is_allowed(tag: str, text: str) -> None:
    assert run("calibrate", "tags", *SIZE, "--tag", tag).mistake == text


# colours


def test_a_chart_on_the_sheet_makes_colours_true(photos: None) -> None:
    patches = " ".join(f"{1e3 * x:.1f},{1e3 * y:.1f}" for x, y in CHART_CORNERS)
    paper = f"#{round(255 * PAPER):02x}" + 2 * f"{round(255 * PAPER):02x}"
    words = ("--chart", "chart.png", "--patches", patches, "--paper", paper)
    ran = run("calibrate", "colours", "bare.png", *SIZE, *words)
    assert (ran.code, ran.stderr) == (0, "")
    said, path = ran.stdout.splitlines()
    assert said.startswith("CIEDE2000 ")
    assert path == "colours.json"
    assert run("calibrate", "camera", "chart.png", *SIZE, "--colours", "colours.json").code == 0
    assert away(small("chart-flat.png"), chart()) < CHART_SEEN
    assert run("calibrate", "colours", "bare.png", *SIZE).mistake == (
        "colours.json is already there; choose another --out, or add --overwrite"
    )


def test_a_grey_card_and_bare_paper_alone_do_too(photos: None) -> None:
    assert run("calibrate", "colours", "bare.png", *SIZE, "--grey", "grey.png", "--out", "grey.json").code == 0
    assert run("calibrate", "colours", "bare.png", *SIZE, "--out", "bare.json").code == 0
    assert read_colours("grey.json").matrix != read_colours("bare.json").matrix
    assert run("calibrate", "camera", "bare.png", *SIZE, "--colours", "bare.json").code == 0
    assert away(small("bare-flat.png"), np.ones_like(bare())) < PICTURE


def test_the_lamp_of_a_sheet_of_another_size_is_noted_and_of_the_same_size_not(photos: None) -> None:
    assert run("calibrate", "colours", "bare.png", *SIZE).code == 0
    ran = run("calibrate", "camera", "bare.png", *SIZE, "--colours", "colours.json")
    assert (ran.code, ran.stderr) == (0, "")
    corners = "100,100 500,100 500,400 100,400"
    words = ("--size", "50x40mm", "--corners", corners, "--colours", "colours.json", "--overwrite")
    ran = run("calibrate", "camera", "bare.png", *words)
    assert (ran.code, ran.stderr) == (
        0,
        "note: the lamp in colours.json is that of a sheet of another size; measure it on this one\n",
    )


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("bare.png", "--chart", "chart.png", "--grey", "grey.png"), "--chart tells all that --grey does"),
        (("bare.png", "--chart", "chart.png"), "--chart needs --patches, and the other way round"),
        (("bare.png", "--patches", "1,1 2,1 2,2 1,2"), "--chart needs --patches, and the other way round"),
        (("bare.png", "--chart", "chart.png", "--patches", "1,1"), "--patches is '1,1'; it must be four points"),
        (
            ("bare.png", "--grey", "bare.png"),
            "no grey card is seen where it should lie; lay it over the middle of the sheet",
        ),
        (
            ("bare.png", "--grey", "chart.png"),
            "no grey card is seen where it should lie; lay it over the middle of the sheet",
        ),
        (
            ("bare.png", "--out", "bare.png", "--overwrite"),
            "--out is bare.png, the photograph itself; choose another --out",
        ),
        (
            ("bare.png", "--grey", "grey.png", "--out", "grey.png", "--overwrite"),
            "--out is grey.png, that of --grey itself; choose another --out",
        ),
        (("bare.png", "--paper", "octarine"), "'octarine' is not a colour"),
        (("chart.png",), "photograph it bare and whole"),
        (("none.png",), "there is no picture none.png"),
        (("hidden.png",), "only 2 of the 4 tags are seen"),
    ],
)
def test_colours_that_cannot_be_learned_are_one_sentence(photos: None, words: tuple[str, ...], text: str) -> None:
    ran = run("calibrate", "colours", *words, *SIZE)
    assert ran.code == 2
    assert text in ran.mistake
    assert not Path("colours.json").exists()


# touch

LEFT, RIGHT, UP, DOWN, LOWER, HIGHER = "\x1b[D", "\x1b[C", "\x1b[A", "\x1b[B", "\x1b[6~", "\x1b[5~"


def jogs(step: str, *ways: tuple[int, str]) -> str:
    """Return keys that are pressed so many times, one by one: the step's key between keeps repeats apart."""
    return "".join(times * (step + key) for times, key in ways)


CORNERS = [
    jogs("1", (5, LEFT), (5, UP), (10, LOWER)) + "\r",  # from (50, -50, 100) mm to (0, 0, 0)
    jogs("1", (10, RIGHT), (2, LOWER)) + "\r",
    jogs("1", (6, DOWN), (2, LOWER)) + "\r",
    jogs("1", (10, LEFT), (2, LOWER)) + "x\r",
]
PRESS = jogs("1", (2, LOWER)) + jogs("2", (3, LOWER)) + jogs("3", (2, LOWER)) + "\n"


@pytest.fixture
def arm(monkeypatch: pytest.MonkeyPatch) -> Recorder:
    """The machine that any spec names."""
    robot = Recorder()
    monkeypatch.setattr(import_module("maulstick.cli.calibrate.touch"), "machine", lambda spec, easel: robot)
    return robot


def touch(*words: str) -> Ran:
    return run("calibrate", "touch", "--robot", "xarm:1.2.3.4", "--size", "100x60mm", *words)


def test_keys_take_the_tip_to_the_corners_and_the_easel_is_where_it_was(terminal: int, arm: Recorder) -> None:
    os.write(terminal, "".join([*CORNERS, PRESS]).encode())
    ran = touch()
    assert ran.code == 0, ran.stderr
    easel = read_easel("easel.json")
    assert easel.corner == pytest.approx((0, 0, 0), abs=1e-9)
    assert (easel.right, easel.down) == (pytest.approx((1, 0, 0)), pytest.approx((0, -1, 0)))
    assert easel.deepest == pytest.approx(0.0032)
    assert ran.stdout.splitlines() == [
        "touched to 0.00 mm; the paper is tilted by 0.00 degrees, and may be pressed 3.2 mm deep",
        "easel.json",
    ]
    asked = [line for line in ran.stderr.replace("\r", "\n").splitlines() if line.endswith("press Enter")]
    corners = ("upper left", "upper right", "lower right", "lower left")
    assert asked[:4] == [
        f"lower the tip onto the {corner} corner of the sheet until it just touches, and press Enter"
        for corner in corners
    ]
    assert "as deep as the deepest stroke may be" in asked[4]


def test_the_machines_that_are_listed_have_a_tip_to_take_to_the_corners() -> None:
    said = run("calibrate", "touch", "--help").stdout
    assert "axidraw" in said
    assert "sim" not in said


def test_a_machine_that_only_lifts_is_not_pressed(terminal: int, arm: Recorder) -> None:
    arm.limits = Limits.model_validate({**LIMITS.model_dump(), "varies_pressure": False})
    os.write(terminal, "".join(CORNERS).encode())
    assert touch("--out", "mine.json").code == 0
    assert read_easel("mine.json").deepest == 0


def test_the_folder_of_the_easel_is_made_before_the_corners_are_touched(terminal: int, arm: Recorder) -> None:
    Path("file").touch()
    os.write(terminal, "".join([*CORNERS, PRESS]).encode())
    ran = touch("--out", "file/easel.json")
    assert ran.code == 1
    assert "press Enter" not in ran.stderr
    assert touch("--out", "new/easel.json").code == 0
    assert read_easel("new/easel.json").deepest == pytest.approx(0.0032)


def test_ctrl_c_leaves_no_easel_and_lets_the_machine_go(terminal: int, arm: Recorder) -> None:
    os.write(terminal, (CORNERS[0] + "\x03").encode())
    assert touch().code == 130
    assert arm.said[-1] == "close"
    assert not Path("easel.json").exists()


def test_a_key_that_is_held_lowers_the_tip_once_for_all_repeats_that_came_meanwhile(
    terminal: int, arm: Recorder
) -> None:
    os.write(terminal, (20 * LOWER + "\x03").encode())
    assert touch().code == 130
    assert arm.said.count("move") == 1


def test_ctrl_c_and_a_terminal_that_is_closed_lift_the_tip(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    for leave in (signal.SIGINT, signal.SIGHUP):
        with FakeGrbl(pace=1000.0) as device:
            words = ("calibrate", "touch", "--robot", f"grbl:{device.port}", "--size", "100x60mm")
            running = Running(*words, keys=True)
            running.wait_for("press Enter")
            os.write(running._terminal, jogs("2", (6, LOWER)).encode())
            running.wait_for("z -1.0 mm")
            os.kill(running.pid, leave)
            assert running.leave() == 130
            assert device.place[2] == pytest.approx(5)


def test_corners_that_do_not_fit_the_sheet_are_asked_for_again_until_they_do(terminal: int, arm: Recorder) -> None:
    wrong = jogs("1", (9, RIGHT), (2, LOWER)) + "\r"  # 10 mm beside the upper right corner
    low, left = jogs("1", (6, DOWN), (2, LOWER)) + "\r", jogs("1", (9, LEFT), (2, LOWER)) + "\r"
    again = jogs("1", (6, UP), (2, LOWER)) + "\r" + CORNERS[1] + PRESS
    os.write(
        terminal, "".join([CORNERS[0], wrong, jogs("1", (1, RIGHT)), low, jogs("1", (1, LEFT)), left, again]).encode()
    )
    ran = touch()
    assert ran.code == 0, ran.stderr
    assert ran.stderr.count("the touched points lie ") == 2
    assert ran.stderr.count("corner of the sheet until it just touches, and press Enter") == 6
    assert read_easel("easel.json").corner == pytest.approx((0, 0, 0), abs=1e-9)


def test_a_corner_where_nothing_is_felt_is_asked_for_again(terminal: int, monkeypatch: pytest.MonkeyPatch) -> None:
    class BesideTheSheet(Feeling):
        def force(self) -> float:
            return super().force() if self.at[0] > 0.295 else 0.0

    arm = BesideTheSheet(0.02)
    monkeypatch.setattr(import_module("maulstick.cli.calibrate.touch"), "machine", lambda spec, easel: arm)
    first = [jogs("1", (1, LEFT), (7, LOWER)), jogs("1", (1, RIGHT))]
    corners = [*first, *(jogs("1", way, (2, LOWER)) for way in ((10, RIGHT), (6, DOWN), (10, LEFT)))]
    os.write(terminal, "\r".join([*corners, jogs("1", (3, LOWER)) + jogs("2", (2, LOWER)), ""]).encode())
    ran = touch("--force")
    assert ran.code == 0, ran.stderr
    assert ran.stderr.count("nothing was felt down to 0 mm; is the sheet there") == 1
    assert ran.stderr.count("take the tip above the upper left corner of the sheet, and press Enter") == 2
    assert read_easel("easel.json").corner == pytest.approx((0.3, 0.0, 0.02), abs=2.5e-4)


def test_an_arm_that_feels_goes_down_by_itself(terminal: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its paper lies 20 mm high, and it starts at (300, 0, 100) mm."""
    arm = Feeling(0.02)
    monkeypatch.setattr(import_module("maulstick.cli.calibrate.touch"), "machine", lambda spec, easel: arm)
    corners = [jogs("1", (7, LOWER)), *(jogs("1", way, (2, LOWER)) for way in ((10, RIGHT), (6, DOWN), (10, LEFT)))]
    os.write(terminal, "\r".join([*corners, jogs("1", (3, LOWER)) + jogs("2", (2, LOWER)), ""]).encode())
    ran = touch("--force")
    assert ran.code == 0, ran.stderr
    assert "take the tip above the upper left corner of the sheet, and press Enter" in ran.stderr
    easel = read_easel("easel.json")
    assert easel.corner == pytest.approx((0.3, 0.0, 0.02), abs=2.5e-4)
    assert easel.deepest == pytest.approx(0.002, abs=2.5e-4)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--robot", "sim"), "sim knows where its sheet lies, and shows no tip to take there; name a real machine"),
        (("--force",), "xarm:1.2.3.4 cannot feel the paper; leave out --force, and touch it by eye"),
        (("--size", "0x0mm"), "a side of the canvas is 0 mm"),
    ],
)
def test_touch_refuses_what_it_cannot_do(terminal: int, arm: Recorder, words: tuple[str, ...], text: str) -> None:
    ran = touch(*words)
    assert ran.code == 2
    assert text in ran.mistake


def test_touch_needs_a_terminal_and_never_overwrites(arm: Recorder, monkeypatch: pytest.MonkeyPatch) -> None:
    with open(os.devnull) as nobody:
        monkeypatch.setattr("sys.stdin", nobody)
        assert touch().mistake == "keys are needed to take the tip to the corners; run it in a terminal"
    Path("easel.json").write_text("mine")
    ran = touch()
    assert (ran.code, ran.mistake) == (1, "easel.json is already there; choose another --out, or add --overwrite")


def test_a_machine_that_is_none_is_one_sentence(terminal: int) -> None:
    ran = run("calibrate", "touch", "--robot", "toaster", "--size", "A4")
    assert ran.mistake.startswith("there is no machine 'toaster'; there are: ")
