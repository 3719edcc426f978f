import io
import os
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image, ImageSequence
from rich.console import Console

from maulstick.cli.progress import VideoRecorder, progress_bar
from maulstick.errors import how_to_add
from maulstick.jobs.plan import prepare
from maulstick.painting.painting_file import read_painting
from maulstick.painting.video import Video
from maulstick.planning.result import PlanProgress
from tests.cli.conftest import PORTRAIT, QUICK, RESULTS, Running, paint


def test_ctrl_c_finishes_the_plan_so_far(tmp_path: Path) -> None:
    running = Running("plan", PORTRAIT, *QUICK, "--steps", "100000", "--out", tmp_path / "out")
    running.interrupt_after(r"loss 0\.\d")
    assert running.leave() == 130
    assert "stopping: finishing the plan so far (Ctrl-C again leaves without it)" in running.said
    assert "Traceback" not in running.said
    assert f"maulstick plan --resume {tmp_path / 'out'} goes on from where it was stopped" in running.said
    assert sorted(os.listdir(tmp_path / "out")) == sorted([*RESULTS, "plan-0.npz"])
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert painting.strokes
    assert painting.paint_changes() <= len(painting.paints) - 1


def test_a_second_ctrl_c_leaves_at_once_and_behind_at_most_what_to_go_on_from(tmp_path: Path) -> None:
    words = ("--steps", "100000", "--strokes", "2000", "--px", "200", "--out", tmp_path / "new" / "out")
    running = Running("plan", PORTRAIT, *QUICK, *words)
    running.interrupt_after(r"loss 0\.\d")
    running.interrupt_after("stopping")
    assert running.leave() == 130
    assert "Traceback" not in running.said
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] in ([], ["plan-0.npz"])


def test_ctrl_c_before_the_planning_is_no_traceback_and_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(prepare, "lay_out_for", interrupt)
    assert paint(tmp_path / "out") == (130, "", "")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(("wanted", "end"), [(True, "100 %"), (False, " 30 %")])
def test_the_bar_of_a_plan_that_was_stopped_ends_where_it_was(wanted: bool, end: str) -> None:
    shown = io.StringIO()
    with progress_bar(Console(file=shown, width=100), 1, lambda: wanted) as show:
        show(0.3, 0.5, {})
    assert shown.getvalue().startswith("1 stroke ")
    assert end in shown.getvalue()


def test_a_video_ends_with_the_painting_and_stays_there(tmp_path: Path) -> None:
    ran = paint(tmp_path, "--video", "gif")
    assert ran.code == 0
    assert "progress.gif" in ran.stdout
    with Image.open(tmp_path / "progress.gif") as video:
        frames = [(frame.convert("RGB"), frame.info["duration"]) for frame in ImageSequence.Iterator(video)]
    assert 2 <= len(frames) <= 31
    assert frames[-1][1] >= 2000
    last = np.asarray(frames[-1][0], dtype=float)
    with Image.open(tmp_path / "preview.png") as preview:
        wanted = np.asarray(preview.resize(frames[-1][0].size, Image.Resampling.BOX), dtype=float)
    first = np.asarray(frames[0][0], dtype=float)
    assert np.abs(last - wanted).mean() < np.abs(first - wanted).mean() / 2


def test_a_video_may_be_an_mp4(tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    assert paint(tmp_path, "--video", "mp4").code == 0
    with av.open(tmp_path / "progress.mp4") as video:
        frames = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert len(frames) == 30 + 1 + 40
    assert frames[0].shape == (48, 60, 3)


def test_an_mp4_without_the_package_that_makes_it_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("maulstick.painting.video.find_spec", lambda name: None)
    ran = paint(tmp_path / "out", "--video", "mp4")
    assert ran.code == 2
    assert ran.mistake == f"an mp4 video needs the package av: ask for a gif, or {how_to_add('video')}"


def recorded(steps: int, shape: tuple[int, int] = (4, 5)) -> Image.Image:
    """The video of a canvas that grows lighter with each of so many steps."""
    camera = VideoRecorder(Video("gif"), steps)
    for step in range(steps):
        camera.watch(PlanProgress(step / steps, 0.0, {}, torch.full((3, *shape), step / steps), dict))
    return Image.open(io.BytesIO(camera.video.encode()))


@pytest.mark.parametrize(("steps", "frames"), [(1, 1), (160, 160), (161, 81), (319, 160), (1500, 150), (4000, 160)])
def test_a_video_has_at_most_160_frames(steps: int, frames: int) -> None:
    with recorded(steps) as video:
        assert getattr(video, "n_frames", 1) == frames


@pytest.mark.parametrize(
    ("shape", "size"), [((1440, 1800), (900, 720)), ((100, 2560), (1280, 50)), ((48, 60), (60, 48))]
)
def test_a_video_of_a_large_canvas_is_scaled_down_and_of_a_small_one_not_up(
    shape: tuple[int, int], size: tuple[int, int]
) -> None:
    with recorded(2, shape) as video:
        assert video.size == size
