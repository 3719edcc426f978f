"""What a painting should be like: terms, networks, paints and the sheet, as they are asked for on the command line."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import open_clip
import pytest
import torch
from PIL import Image
from safetensors.torch import save_file

from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import read_painting
from maulstick.painting.picture import decode_png
from maulstick.painting.raster import Canvas
from maulstick.planning.mural.planner import plan_mural
from maulstick.planning.result import PlanResult
from maulstick.rendering.preview import preview
from tests.cli.conftest import PORTRAIT, RESULTS, Ran, paint, run
from tests.planning.features.test_clip import TEXT, TRANSFORMER

TINY = ("--steps", "30", "--strokes", "20", "--px", "48", "--seed", "0")
READER = "tiny-reader"


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, ...]:
    """The words that choose a CLIP with random weights, which open_clip knows by a name from now on."""
    folder = tmp_path_factory.mktemp("clip")
    (folder / f"{READER}.json").write_text(json.dumps({"embed_dim": 12, "vision_cfg": TRANSFORMER, "text_cfg": TEXT}))
    open_clip.add_model_config(folder)
    with torch.random.fork_rng():
        torch.manual_seed(0)
        model = open_clip.CLIP(12, TRANSFORMER, TEXT)
        for parameter in model.parameters():
            parameter.data += 0.1 * torch.randn_like(parameter)
    save_file(model.state_dict(), folder / "weights.safetensors")
    return ("--clip", READER, "--clip-weights", str(folder / "weights.safetensors"))


def planned(out: Path, *words: str | Path) -> tuple[Painting, Ran]:
    ran = run("plan", *words, *TINY, "--out", out)
    assert ran.code == 0, ran.stderr
    assert sorted(os.listdir(out)) == RESULTS
    return read_painting(out / "painting.json"), ran


def told_of_the_loss(ran: Ran) -> str:
    words = " ".join(ran.stdout.replace("│", " ").split())
    return words[words.index("loss ") + 5 : words.index(" planned in")]


def refused(folder: Path, *words: str | Path) -> str:
    ran = run("plan", *words, *TINY, "--out", folder / "out")
    assert ran.code == 2
    assert not (folder / "out").exists()
    return ran.mistake


def test_a_picture_is_usually_painted_in_its_tones_alone(tmp_path: Path) -> None:
    painting, ran = planned(tmp_path, PORTRAIT)
    assert painting.provenance.options["weights"] == {"tone": 1.0}
    assert told_of_the_loss(ran) == f"tone {painting.provenance.metrics['tone']:.5f} (100%)"


def test_the_table_tells_the_share_of_each_term(tmp_path: Path) -> None:
    painting, ran = planned(tmp_path, PORTRAIT, "--weight", "likeness=1")
    assert painting.provenance.options["weights"] == {"tone": 1.0, "likeness": 1.0}
    metrics = painting.provenance.metrics
    assert metrics["loss"] == pytest.approx(metrics["tone"] + metrics["likeness"])
    share = metrics["tone"] / metrics["loss"]
    assert told_of_the_loss(ran) == (
        f"tone {metrics['tone']:.5f} ({share:.0%}), likeness {metrics['likeness']:.5f} ({1 - share:.0%})"
    )


def test_a_text_is_painted_without_any_picture(tmp_path: Path, clip: tuple[str, ...]) -> None:
    painting, ran = planned(tmp_path, "--text", "a sailing boat", *clip)
    assert painting.strokes
    assert painting.provenance.image is None
    assert (painting.provenance.options["text"], painting.provenance.options["clip"]) == ("a sailing boat", READER)
    assert painting.area == (0, 0, 0.2, 0.16)
    assert set(painting.provenance.metrics) == {"text", "loss"}
    assert told_of_the_loss(ran) == f"text {painting.provenance.metrics['text']:.5f} (100%)"
    assert "likeness" not in ran.stdout


def test_a_text_beside_a_picture_counts_beside_it(tmp_path: Path, clip: tuple[str, ...]) -> None:
    painting, ran = planned(tmp_path, PORTRAIT, "--text", "a sailing boat", *clip)
    assert painting.provenance.options["weights"] == {"tone": 1.0, "likeness": 1.0, "text": 1.0}
    assert {"psnr", "tone", "likeness", "text"} <= set(painting.provenance.metrics)
    assert ran.stdout.count("likeness") == 1
    other, _ = planned(tmp_path / "other", PORTRAIT, "--text", "a cat", *clip)
    assert other.strokes != painting.strokes


def test_another_picture_lends_its_look(tmp_path: Path, clip: tuple[str, ...]) -> None:
    striped = np.zeros((40, 40, 3), dtype=np.uint8)
    striped[::4] = (255, 0, 0)
    Image.fromarray(striped).save(tmp_path / "look.png")
    painting, ran = planned(tmp_path / "out", PORTRAIT, "--look", tmp_path / "look.png", *clip)
    assert painting.provenance.options["look"] == "look.png"
    assert painting.provenance.options["weights"] == {"tone": 1.0, "likeness": 1.0, "look": 1.0}
    assert "look 0." in told_of_the_loss(ran)


def test_clip_can_be_compared_by_layers_that_are_asked_for(tmp_path: Path, clip: tuple[str, ...]) -> None:
    likeness = ("--weight", "likeness=1")
    painting, _ = planned(tmp_path / "out", PORTRAIT, *clip, "--clip-layers", "0,1", *likeness)
    assert painting.provenance.options["clip_layers"] == [0, 1]
    words = [*clip, "--clip-layers", "0,9", *likeness]
    assert refused(tmp_path / "no", PORTRAIT, *words).startswith("the layer of CLIP is 9; it must be in 0 to")
    words = [*clip, "--clip-layers", "deep", *likeness]
    assert refused(tmp_path / "no", PORTRAIT, *words) == "--clip-layers is 'deep'; it must be numbers from 0, as in 2,3"


def test_a_network_that_nobody_asks_is_refused(tmp_path: Path, clip: tuple[str, ...]) -> None:
    said = refused(tmp_path, PORTRAIT, *clip, "--weight", "likeness=0")
    assert said == "--clip says which network to ask, and no term asks one; leave it out, or weigh likeness"


def test_weights_are_as_they_were_asked_for(tmp_path: Path) -> None:
    words = ("--weight", "edges=2", "--weight", "tone=0.5")
    painting, ran = planned(tmp_path, PORTRAIT, *words)
    assert painting.provenance.options["weights"] == {"tone": 0.5, "edges": 2.0}
    assert [part.split()[0] for part in told_of_the_loss(ran).split(", ")] == ["tone", "edges"]


def test_faces_that_are_not_to_count_more_are_noted_in_the_painting_and_are_no_term(tmp_path: Path) -> None:
    painting, ran = planned(tmp_path, PORTRAIT, "--weight", "faces=0")
    assert painting.provenance.options["weights"] == {"tone": 1.0, "faces": 0.0}
    assert told_of_the_loss(ran) == f"tone {painting.provenance.metrics['tone']:.5f} (100%)"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (
            ["beauty=1"],
            "there is no term to weigh 'beauty'; there are: edges, faces, likeness, look, sketch, text, tone",
        ),
        (["tone=-1"], "the weight of tone is -1.0; it must be from 0 to 1000"),
        (["tone=nan"], "the weight of tone is nan; it must be from 0 to 1000"),
        (["tone=much"], "--weight is 'tone=much'; it must be a term and a number, as in edges=0.5"),
        (["tone"], "--weight is 'tone'; it must be a term and a number, as in edges=0.5"),
        (["=1"], "there is no term to weigh ''; there are: edges, faces, likeness, look, sketch, text, tone"),
        (
            ["tone=0", "likeness=0"],
            "nothing is weighed, so any painting would do; give one of the terms a weight above",
        ),
        (["text=1"], "text weighs a text, and there is none; give it, or leave the weight out"),
        (["look=1"], "look weighs the look of a picture, and there is none; give it, or leave the weight out"),
    ],
)
def test_weights_that_cannot_be_used_are_refused(tmp_path: Path, words: list[str], text: str) -> None:
    options = [word for weight in words for word in ("--weight", weight)]
    assert refused(tmp_path, PORTRAIT, *options).startswith(text)


def test_a_text_without_the_weights_to_read_it_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def unreachable(made: object) -> str:
        raise ConnectionError("no route\nto host")

    monkeypatch.setattr(open_clip, "download_pretrained", unreachable)
    assert refused(tmp_path, "--text", "a sailing boat") == (
        "the openai weights of RN101 are not on this machine and cannot be fetched; give a file of them with "
        "--clip-weights, or try again with a network"
    )


@pytest.mark.parametrize("text", ["", " \n"])
def test_an_empty_text_is_refused(tmp_path: Path, text: str) -> None:
    assert refused(tmp_path, "--text", text) == (
        "--text is empty; say what the painting should show, as in 'a sailing boat at dusk'"
    )


def test_a_text_alone_has_no_picture_to_compare_with(tmp_path: Path, clip: tuple[str, ...]) -> None:
    said = refused(tmp_path, "--text", "a sailing boat", "--weight", "tone=1", *clip)
    assert said == "tone compares with a picture; name one, or leave that weight out"


def test_paints_of_a_file_keep_their_names_and_colours(tmp_path: Path) -> None:
    paints = {"chalk": "#f0eeea", "rust": "#8a4524", "night": "#1b1a3c"}
    (tmp_path / "mine.csv").write_text("name,colour\n" + "".join(f"{name},{hex_}\n" for name, hex_ in paints.items()))
    ran = paint(tmp_path / "out", "--paints-from", tmp_path / "mine.csv")
    assert ran.code == 0, ran.stderr
    found = read_painting(tmp_path / "out" / "painting.json").paints
    assert len(found) > 1
    assert {paint.name: paint.hex for paint in found}.items() <= paints.items()
    assert len({paint.name for paint in found}) == len(found)


def test_two_paints_of_one_colour_are_refused_as_two_such_inks_are(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("night,#1b1a3c\nrust,#8a4524\nink,#1B1A3C\n")
    said = refused(tmp_path, PORTRAIT, "--paints-from", tmp_path / "mine.csv")
    told = "'night' and 'ink' are both #1b1a3c, and a painting tells its paints by colour; leave out one of them"
    assert said == f"{tmp_path / 'mine.csv'}: {told}"


@pytest.mark.parametrize("words", [["--paints", "2"], ["--ink", "black"]])
def test_paints_of_a_file_are_one_way_to_say_what_to_paint_with(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "mine.csv").write_text("rust,#8a4524")
    said = refused(tmp_path, PORTRAIT, "--paints-from", tmp_path / "mine.csv", *words)
    assert said == f"{words[0]} and --paints-from are two ways to say what to paint with; leave one of them out"


def test_paper_of_a_colour_is_seen_where_nothing_is_painted(tmp_path: Path) -> None:
    assert paint(tmp_path / "out", "--paper", "#203040", "--size", "100x50mm").code == 0
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert painting.sheet.paper == pytest.approx((32 / 255, 48 / 255, 64 / 255), abs=1e-6)
    with Image.open(tmp_path / "out" / "preview.png") as image:
        assert image.getpixel((2, 2)) == (0x20, 0x30, 0x40)


def test_a_paper_that_is_no_colour_is_refused(tmp_path: Path) -> None:
    said = refused(tmp_path, PORTRAIT, "--paper", "octarine")
    assert said == "'octarine' is not a colour; write a name such as black, or #rrggbb"


def test_what_is_on_the_sheet_is_in_the_file_and_lies_under_the_strokes(tmp_path: Path) -> None:
    begun = np.full((40, 50, 3), 230, dtype=np.uint8)
    begun[:, :5] = (200, 30, 30)
    Image.fromarray(begun).save(tmp_path / "sheet.png")
    assert paint(tmp_path / "out", "--background", tmp_path / "sheet.png", "--size", "100x80mm").code == 0
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert painting.provenance.options["background"] == "sheet.png"
    assert painting.sheet.picture is not None
    kept = decode_png(painting.sheet.picture)
    assert kept[500, 20] == pytest.approx(begun[0, 0] / 255, abs=2 / 255)
    bare = preview(painting.model_copy(update={"strokes": ()}), Canvas(0.1, 0.08, 500))
    assert np.abs(bare - begun / 255).mean() < 0.01
    assert painting.strokes


def test_on_a_sheet_that_shows_the_picture_already_there_is_little_left_to_paint(
    tmp_path: Path, painted: tuple[Path, Ran]
) -> None:
    words = ("--background", PORTRAIT, "--size", "100x100mm", "--steps", "200")
    assert paint(tmp_path / "out", *words).code == 0
    assert paint(tmp_path / "exact", *words, "--exact").code == 0
    found, exact = (read_painting(tmp_path / name / "painting.json") for name in ("out", "exact"))
    assert len(found.strokes) <= 14 < len(read_painting(painted[0] / "painting.json").strokes)
    assert len(exact.strokes) == 20
    assert found.provenance.metrics["psnr"] > 25


def test_a_photograph_of_another_sheet_is_refused(tmp_path: Path) -> None:
    said = refused(tmp_path, PORTRAIT, "--background", PORTRAIT, "--size", "200x160mm")
    assert said == (
        f"the photograph {PORTRAIT} is 1.000 times as wide as high, and the sheet, 200 x 160 mm, 1.250 times; "
        "cut the photograph at the sheet's edges"
    )


def test_a_photograph_of_the_sheet_shows_the_paper_s_colour_by_itself(tmp_path: Path) -> None:
    said = refused(tmp_path, PORTRAIT, "--background", PORTRAIT, "--paper", "#000000")
    assert said == "--background shows the sheet as it is, and --paper its colour; leave one of them out"


def test_a_canvas_too_large_for_one_piece_is_planned_in_windows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("maulstick.jobs.plan.prepare.LONGEST_PX", 40)
    monkeypatch.setattr("maulstick.jobs.plan.inputs.LONGEST_PX", 40)
    windows: list[int] = []

    def small(*words: Any, **more: Any) -> PlanResult:
        windows.append(24)
        return plan_mural(*words, **more, window_px=24)

    monkeypatch.setattr("maulstick.jobs.plan.prepared.plan_mural", small)
    ran = paint(tmp_path / "out", "--px", "48")
    assert ran.code == 0
    assert windows
    painting = read_painting(tmp_path / "out" / "painting.json")
    assert 10 < len(painting.strokes) <= 20
    assert painting.paint_changes() == len(painting.paints) - 1
    frames = paint(tmp_path / "video", "--px", "48", "--video", "gif")
    assert frames.code == 2
    assert frames.mistake.startswith("--video records one canvas, and this one is planned in windows")
    text = paint(tmp_path / "text", "--px", "48", "--text", "a boat")
    assert text.mistake == "a text is planned in one piece, of at most 40 pixels; choose a smaller --px"
