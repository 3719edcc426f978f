from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from maulstick.cli.record import options
from maulstick.recording.mocap.contact import ContactOptions
from maulstick.recording.mocap.take import write_take
from maulstick.strokes.ink import read_ink
from maulstick.strokes.strokes import Strokes, read_strokes
from tests.cli.conftest import Ran, run
from tests.support.recording.motive_export import motive_csv
from tests.support.recording.simulated_take import distances, loops_and_lines, mocap_strokes, pivot_take, simulate

STROKES = loops_and_lines(5)
SIMULATED = simulate(STROKES, 1)


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A take, and a pivot take beside it, that no test changes."""
    folder = tmp_path_factory.mktemp("takes")
    (folder / "cat.csv").write_bytes(motive_csv(SIMULATED.take))
    (folder / "pivot.csv").write_bytes(motive_csv(pivot_take(3)))
    return folder / "cat.csv"


@pytest.fixture
def record(exported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The take, from within an empty folder."""
    monkeypatch.chdir(tmp_path)
    return exported


def motive(take: Path, *words: str | Path) -> Ran:
    return run("record", "motive", take, "--pen-length", "139mm", *words)


def test_lengths_of_a_pen_are_typed_in_millimetres_or_with_their_unit() -> None:
    typed, with_unit = (options.tip_of(length, "-y", None, None, None) for length in ("139", "139mm"))
    assert np.array_equal(typed[0], with_unit[0])
    assert np.allclose(typed[0], [0, -0.139, 0])
    assert typed[1] == with_unit[1]
    low, lower = (options.contact_options(height, "20ms", "30ms") for height in ("0.5", "0.5mm"))
    assert low == lower


def test_a_session_goes_from_motives_export_to_its_strokes(tmp_path: Path) -> None:
    simulated = simulate(mocap_strokes("circular"), 3)
    take = tmp_path / "take.csv"
    take.write_bytes(motive_csv(simulated.take))
    assert motive(take, "--out", tmp_path / "a.ink.npz").code == 0
    found = [stroke[:, 1:3] for stroke in read_ink(tmp_path / "a.ink.npz").strokes()]
    assert len(found) == len(simulated.strokes)
    apart = [distances(*pair) for pair in zip(found, simulated.strokes, strict=True)]
    assert np.median(np.concatenate(apart)) < 0.13e-3


def test_ink_and_plot_go_here_under_the_takes_name_and_all_is_told(record: Path) -> None:
    ran = motive(record)
    assert (ran.code, ran.stderr) == (0, "")
    lines = ran.stdout.splitlines()
    assert lines[0] == "the tip is 139mm from the rigid body along -y"
    assert lines[1].startswith(f"{len(SIMULATED.take):,} frames in ")
    assert "5 strokes, 0." in lines[-3]
    assert lines[-2:] == ["cat.ink.npz", "cat.contact.png"]
    assert sorted(path.name for path in Path.cwd().iterdir()) == ["cat.contact.png", "cat.ink.npz"]
    ink = read_ink("cat.ink.npz")
    assert (len(ink), ink.source) == (5, "cat.csv")
    with Image.open("cat.contact.png") as plot:
        assert plot.format == "PNG"


def test_strokes_are_written_where_the_name_asks_for_them(record: Path) -> None:
    assert motive(record).code == 0
    ran = motive(record, "--out", "cat.strokes.npz", "--plot", "other.png")
    assert ran.stdout.splitlines()[-2:] == ["cat.strokes.npz", "other.png"]
    expected = Strokes.of(read_ink("cat.ink.npz"))
    assert np.array_equal(read_strokes("cat.strokes.npz").poses, expected.poses)


def test_a_pivot_take_does_instead_of_a_length(record: Path) -> None:
    ran = run("record", "motive", record, "--pivot", record.with_name("pivot.csv"))
    assert ran.stdout.startswith("the tip is at (")
    assert "mm in the rigid body; in the pivot take it strayed by 0." in ran.stdout
    assert len(read_ink("cat.ink.npz")) == 5


def test_a_take_that_was_kept_live_is_read_as_well(record: Path) -> None:
    write_take(SIMULATED.take, "kept.take.npz")
    assert motive(Path("kept.take.npz")).stdout.splitlines()[-2:] == ["kept.ink.npz", "kept.contact.png"]


def test_decisions_are_taken_as_told(record: Path) -> None:
    ran = motive(
        record, "--threshold", "0.4mm", "--merge", "0.16s", "--shortest", "5 ms", "--pen", "Pen", "--sheet", "Canvas"
    )
    assert "threshold 0.40 mm over the paper, as you set it" in ran.stdout
    assert "of at most 160 ms" in ran.stdout
    assert "shorter than 5 ms" in ran.stdout


def test_the_corner_is_where_it_is_said_to_be(record: Path) -> None:
    assert motive(record, "--corner", "lower-right").code == 0
    turned = read_ink("cat.ink.npz")
    assert motive(record, "--overwrite").code == 0
    ink = read_ink("cat.ink.npz")
    assert turned.samples[:, 1:3] == pytest.approx(np.array(ink.size) - ink.samples[:, 1:3], abs=1e-9)


def test_an_axis_beside_a_pivot_take_is_not_passed_over(record: Path) -> None:
    ran = run("record", "motive", record, "--pivot", record.with_name("pivot.csv"), "--pen-axis", "x")
    assert ran.code == 2
    assert ran.mistake == "a pivot take tells the pen's axis, too; leave out --pen-axis"


@pytest.mark.parametrize("there", ["cat.ink.npz", "cat.contact.png"])
def test_what_is_there_is_replaced_only_when_told_to(record: Path, there: str) -> None:
    Path(there).write_bytes(b"before")
    ran = motive(record)
    option = "--out" if there.endswith("npz") else "--plot"
    assert ran.code == 1
    assert ran.mistake == f"{there} is already there; choose another {option}, or add --overwrite"
    assert [path.name for path in Path.cwd().iterdir()] == [there]
    assert Path(there).read_bytes() == b"before"
    assert motive(record, "--overwrite").code == 0
    assert Path(there).read_bytes() != b"before"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (
            ["--out", "cat.npz"],
            "--out is cat.npz; let its name end in .ink.npz for the ink, or in .strokes.npz for its",
        ),
        (["--plot", "cat.jpg"], "--plot is cat.jpg; it is written as PNG, so let its name end in .png"),
        (
            ["--pivot", "p.csv"],
            "say where the pen's tip is: with --pen-length, as in 139mm, or with a pivot take, --pivot",
        ),
        (["--pen-length", "long"], "--pen-length is 'long'; it must be a length, as 10 for millimetres, 10mm or 1cm"),
        (["--pen-length", "139m"], "--pen-length is 139m; it must be at most 2 m"),
        (["--pen-length", "200mm"], "the tip rests -"),
        (["--pen-axis", "w"], "there is no axis 'w'; there are: -x, -y, -z, x, y, z"),
        (["--pen-axis", "-x"], "the tip rests "),
        (
            ["--corner", "left"],
            "there is no corner 'left'; there are: lower-left, lower-right, upper-left, upper-right",
        ),
        (["--threshold", "high"], "--threshold is 'high'; it must be a length, as 10 for millimetres"),
        (["--threshold", "2m"], "the threshold is 2000 mm; it must be between 0.05 and 20 mm"),
        (["--merge", "20"], "--merge is '20'; write a time and its unit, as in 20ms or 0.02s"),
        (["--shortest", "1h"], "--shortest is '1h'; write a time and its unit"),
        (["--shortest", "9s"], "no stroke was found: the tip comes down to "),
        (["--pen", "Pencil"], "Pencil"),
    ],
)
def test_a_mistake_is_one_sentence_and_nothing_is_written(record: Path, words: list[str], text: str) -> None:
    ran = motive(record, *words)
    assert ran.code == 2
    assert text in ran.mistake
    assert list(Path.cwd().iterdir()) == []


def test_ink_is_not_recorded_again(record: Path) -> None:
    assert motive(record).code == 0
    text = "cat.ink.npz holds ink already; there is nothing to record; look at it with maulstick show"
    assert motive(Path("cat.ink.npz")).mistake == text


@pytest.mark.parametrize("option", ["--out", "--plot"])
def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_read(record: Path, option: str) -> None:
    Path("file").touch()
    ran = motive(Path("none.csv"), option, {"--out": "file/cat.ink.npz", "--plot": "file/cat.png"}[option])
    assert ran.code == 1
    assert ran.mistake.startswith("cannot write into the folder file: ")


def test_what_is_left_out_on_the_command_line_is_what_is_left_out_in_python() -> None:
    assert options.contact_options(None, options.MERGE, options.SHORTEST) == ContactOptions()


def test_a_pen_needs_a_tip(record: Path) -> None:
    ran = run("record", "motive", record)
    assert ran.mistake.startswith("say where the pen's tip is: with --pen-length")
    assert "there is no Motive export none.csv" in motive(Path("none.csv")).mistake
