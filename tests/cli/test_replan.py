import io
import json
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from maulstick.jobs.paint import camera_loop
from maulstick.jobs.paint.simulation import Simulation
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.picture import encode_png, read_picture
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.storage.arrays import Floats
from maulstick.storage.files import file_sum
from tests.cli.conftest import Ran, run
from tests.support.cli.webcam import after, put_webcam, unplug
from tests.support.planned import STROKES, picture, planned
from tests.support.tolerances import LANDED, PICTURE

EVERY = 12
NEEDS_REPLAN = "--camera, --picture, --view, --tag and --colours are for --replan; add it, or leave them out"
Draw = Callable[[Floats, tuple[float, float, float]], None]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a picture and its painting, in which the commands run; planning again takes few steps."""
    monkeypatch.chdir(tmp_path)
    put_webcam(monkeypatch)
    monkeypatch.setattr(camera_loop, "replanned", partial(camera_loop.replanned, steps=6))
    (tmp_path / "picture.png").write_bytes(encode_png(picture()))
    known = {"image": "picture.png", "image_sha256": file_sum(tmp_path / "picture.png")}
    made = planned().provenance.model_copy(update=known)
    write_painting(planned().model_copy(update={"provenance": made}), tmp_path / "painting.json")
    return tmp_path


def replan(*words: str, every: int = EVERY) -> Ran:
    return run("paint", "painting.json", "--replan", str(every), "--picture", "picture.png", *words)


def journal() -> list[dict[str, object]]:
    return [json.loads(row) for row in Path("painting.log.jsonl").read_text().splitlines()]


def painted() -> list[object]:
    return [entry["stroke"] for entry in journal() if entry["event"] == "end"]


def revisions() -> list[object]:
    return [entry["file"] for entry in journal() if entry["event"] == "revision"]


def whole() -> Painting:
    """As it was painted in the end."""
    last = revisions()[-1]
    assert isinstance(last, str)
    return read_painting(last)


class Sheet:
    """Watches what really comes onto the simulated sheet."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, event: Callable[[Simulation, SimulatedCamera], None]) -> None:
        self.paths: list[Floats] = []
        put_webcam(monkeypatch, lambda simulation, camera: (self._watch(simulation), event(simulation, camera))[1])

    def _watch(self, simulation: Simulation) -> None:
        draw: Draw = simulation.robot.sheet.draw

        def seen(path: Floats, colour: tuple[float, float, float]) -> None:
            self.paths.append(path)
            draw(path, colour)

        simulation.robot.sheet.draw = seen  # type: ignore[method-assign]

    def furthest(self) -> float:
        """How far the ends of strokes, in order, are from those of the painting, metres."""
        planned_ends = {stroke.id: np.array(stroke.trajectory)[[0, -1], :2] for stroke in whole().strokes}
        ids = painted()
        assert len(self.paths) == len(ids)
        return max(
            min(np.abs(path[[0, -1], :2] - way).max() for way in (planned_ends[number], planned_ends[number][::-1]))
            for path, number in zip(self.paths, ids, strict=True)
            if isinstance(number, int)
        )


def test_it_paints_looks_and_plans_again_until_nothing_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    sheet = Sheet(monkeypatch, lambda simulation, camera: None)
    ran = replan(every=10)
    assert (ran.code, ran.stdout) == (0, "painting-painted.png\n")
    assert revisions() == ["painting.json", "painting.r1.json", "painting.r2.json"]
    assert len(painted()) == len(set(painted())) <= STROKES
    assert set(painted()) == {stroke.id for stroke in whole().strokes}
    assert sum(number < STROKES for number in painted() if isinstance(number, int)) == 10
    for entry in journal():
        if entry["event"] == "revision":
            assert entry["sha256"] == file_sum(Path(str(entry["file"])))
    assert sheet.furthest() < 1e-5
    for number in (1, 2):
        assert read_picture(f"painting.r{number}.png").mean() < 0.99


def test_what_was_cut_off_goes_on_with_the_latest_revision_and_looks_first(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, after(2, unplug))
        ran = replan(every=10)
        assert ran.code == 3
        assert ran.stderr.splitlines()[-1] == (
            "maulstick: the simulated camera sends no picture; plug it in again, and go on"
        )
    assert (len(painted()), revisions()) == (20, ["painting.json", "painting.r1.json"])
    assert replan("--resume").code == 0
    assert revisions() == ["painting.json", "painting.r1.json", "painting.r2.json"]
    assert len(painted()) == len(set(painted()))
    assert set(painted()) == {stroke.id for stroke in whole().strokes}


def test_a_machine_that_counts_its_steps_asks_where_its_pen_stands_before_it_goes_on_and_looks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with monkeypatch.context() as patch:
        put_webcam(patch, after(1, unplug))
        assert replan().code == 3
    monkeypatch.setattr("maulstick.robot.simulated.easel.SimulatedEasel.counts_steps", True)
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    ran = replan("--resume")
    assert ran.code == 0, ran.stderr
    assert ran.stderr.count("see that the pen stands 0 mm from the left and 0 mm from the upper edge") == 1


def test_a_sheet_that_is_moved_by_8_mm_is_painted_where_it_lies(monkeypatch: pytest.MonkeyPatch) -> None:
    def move(simulation: Simulation, camera: SimulatedCamera) -> None:
        camera.move_paper(0.008, 0.0)
        simulation.robot._truth = simulation.robot._truth.shifted(0.008, 0.0)

    sheet = Sheet(monkeypatch, after(1, move))
    ran = replan()
    assert ran.code == 0
    told = re.search(r"note: the sheet has moved by ([\d.]+) mm", ran.stderr)
    assert told is not None, ran.stderr
    assert float(told[1]) == pytest.approx(8.0, abs=1e3 * LANDED)
    assert sheet.furthest() < LANDED


def test_a_sheet_that_had_moved_before_a_cut_is_painted_where_it_lies(monkeypatch: pytest.MonkeyPatch) -> None:
    def move(simulation: Simulation, camera: SimulatedCamera) -> None:
        camera.move_paper(0.008, 0.0)
        simulation.robot._truth = simulation.robot._truth.shifted(0.008, 0.0)

    with monkeypatch.context() as patch:
        put_webcam(patch, after(1, unplug))
        assert replan().code == 3
    done = len(painted())
    sheet = Sheet(monkeypatch, move)
    assert replan("--resume").code == 0
    there = painted()[done:]
    ends = {stroke.id: np.array(stroke.trajectory)[[0, -1], :2] for stroke in whole().strokes}
    for path, number in zip(sheet.paths, there, strict=True):
        assert isinstance(number, int)
        assert min(np.abs(path[[0, -1], :2] - way).max() for way in (ends[number], ends[number][::-1])) < LANDED


def test_the_photograph_shows_what_is_on_the_sheet(monkeypatch: pytest.MonkeyPatch) -> None:
    sheets: list[NDArray[np.float32]] = []

    def keep(simulation: Simulation, camera: SimulatedCamera) -> None:
        sheets.append(simulation.robot.sheet.image())

    put_webcam(monkeypatch, after(1, keep))
    assert replan().code == 0
    seen = read_picture("painting.r1.png")
    step = len(sheets[0]) // len(seen)
    shape = (seen.shape[0], step, seen.shape[1], step, 3)
    coarse = sheets[0][: seen.shape[0] * step, : seen.shape[1] * step].reshape(shape).mean(axis=(1, 3))
    assert np.abs(seen - coarse).mean() < 3 * PICTURE


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("--replan", "-1", "--picture", "picture.png"), "--replan is -1; it must be at least 1 stroke"),
        (("--replan", "5"), "planning again needs the picture that the painting is of; name it with --picture"),
        (("--picture", "picture.png"), NEEDS_REPLAN),
        (("--camera", "usb:0"), NEEDS_REPLAN),
        (("--tag", "30"), NEEDS_REPLAN),
        (
            ("--replan", "5", "--picture", "picture.png", "--robot", "grbl:/dev/null"),
            "planning again needs a camera over the sheet; name it with --camera usb:0, or folder:PATH",
        ),
        (
            ("--replan", "5", "--picture", "painting.json"),
            "painting.json is not the picture picture.png that was planned; name that one",
        ),
        (
            ("--replan", "5", "--picture", "picture.png", "--colours", "none.json"),
            "none.json; check its name and folder",
        ),
        (("--replan", "5", "--picture", "none.png"), "none.png; check its name and folder"),
        (
            ("--replan", "5", "--picture", "picture.png", "--tag", "0"),
            "--tag is 0 mm; it must be between 5 and 120 mm",
        ),
    ],
)
def test_words_that_do_not_go_together_are_refused_before_anything_moves(words: tuple[str, ...], text: str) -> None:
    ran = run("paint", "painting.json", *words)
    assert ran.code == 2
    assert text in ran.mistake
    assert sorted(path.name for path in Path().iterdir()) == ["painting.json", "picture.png"]


def test_a_painting_of_no_picture_is_not_planned_again() -> None:
    made = planned().provenance.model_copy(update={"image": None, "image_sha256": None})
    write_painting(planned().model_copy(update={"provenance": made}), Path("painting.json"))
    assert replan().mistake == ("the painting was not planned from a picture, so it cannot be planned again on the way")


@pytest.mark.parametrize("what", ["regions", "guides"])
def test_what_a_person_said_of_places_is_not_planned_over(what: str) -> None:
    made = read_painting("painting.json").provenance
    made = made.model_copy(update={"options": {**made.options, what: "map.png"}})
    write_painting(planned().model_copy(update={"provenance": made}), Path("painting.json"))
    ran = replan()
    assert ran.code == 2
    assert ran.mistake.startswith(f"it was planned with {what}, which planning again on the way does not know; do not")
    assert not Path("painting.log.jsonl").exists()


def test_strokes_of_no_style_are_refused_before_anything_begins() -> None:
    made = planned().provenance.model_copy(
        update={"image": "picture.png", "image_sha256": file_sum(Path("picture.png"))}
    )
    strokes = tuple(stroke.model_copy(update={"style": None}) for stroke in planned().strokes)
    write_painting(planned().model_copy(update={"provenance": made, "strokes": strokes}), Path("painting.json"))
    ran = replan()
    assert ran.code == 2
    assert ran.mistake == "the strokes that are left are not all of one style; only those are planned again"
    assert not Path("painting.log.jsonl").exists()


def test_a_camera_that_did_not_see_the_bare_sheet_cannot_join_later() -> None:
    assert run("paint", "painting.json").code == 0
    ran = replan("--resume")
    assert (ran.code, ran.mistake) == (
        2, "there is no painting.eye.npz, so no camera saw the bare sheet; go on with --replan 0",
    )  # fmt: skip


def test_a_sheet_that_is_not_bare_cannot_be_begun_with_a_camera() -> None:
    ran = replan("--from-stroke", str(STROKES // 2))
    assert ran.code == 2
    assert "photograph it bare and whole" in ran.stderr
    assert not Path("painting.log.jsonl").exists()
