import json
import re
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from pydantic import ValidationError

from maulstick.errors import InputError, OutputError
from maulstick.strokes.ink import Ink, write_ink
from maulstick.survey.app import participants
from maulstick.survey.questionnaire import (
    Match,
    Opinions,
    Pair,
    Survey,
    SurveyHand,
    build,
    read_survey,
    read_survey_to_show,
)
from tests.survey.conftest import named, sources


def test_a_survey_is_what_was_built_when_it_is_read(tmp_path: Path) -> None:
    survey = build(tmp_path / "new" / "survey", "Whose?", *sources(tmp_path / "sources"))
    assert read_survey(tmp_path / "new" / "survey") == survey
    assert survey.match is not None
    assert [hand.name for hand in survey.match.hands] == ["Ada", "Bo", "Cy"]


def test_a_survey_is_built_and_read_in_a_folder_that_is_named_in_words(tmp_path: Path) -> None:
    survey = build(str(tmp_path / "survey"), "Whose?", *sources(tmp_path / "sources"))
    assert read_survey(str(tmp_path / "survey")) == survey


def test_a_survey_survives_json() -> None:
    survey = named()
    assert Survey.model_validate_json(survey.model_dump_json()) == survey


def test_every_picture_is_copied_to_its_own_place(tmp_path: Path) -> None:
    match, opinions = sources(tmp_path / "sources")
    survey = build(tmp_path / "survey", "Whose?", match, opinions)
    originals = [path for hand in match.hands for path in (hand.by_hand, *hand.by_machine)]
    originals += [path for pair in opinions.pairs for path in (pair.reference, *pair.looks)]
    copies = list(survey.pictures())
    assert len(set(copies)) == len(originals) == 15
    for original, copy in zip(originals, copies, strict=True):
        with Image.open(original) as before, Image.open(tmp_path / "survey" / copy) as after:
            np.testing.assert_array_equal(np.array(before), np.array(after))


def test_nothing_but_pixels_goes_into_a_survey_and_not_too_many(tmp_path: Path) -> None:
    match, _ = sources(tmp_path / "sources")
    told = PngInfo()
    told.add_text("Author", "a secret")
    Image.new("RGB", (3000, 1500), "red").save(match.hands[0].by_hand, pnginfo=told)
    build(tmp_path / "survey", "Whose?", match, None)
    copy = tmp_path / "survey" / "hand-1.png"
    assert b"secret" not in copy.read_bytes()
    with Image.open(copy) as image:
        assert image.size == (1024, 512)


def test_ink_is_shown_as_it_was_drawn(tmp_path: Path) -> None:
    match, _ = sources(tmp_path / "sources")
    ada, *others = match.hands
    write_ink(Ink.of([np.array([[0, 0.05, 0.05, 1], [1, 0.15, 0.05, 1]])], (0.2, 0.1)), tmp_path / "ada.ink.npz")
    drawn = ada.model_copy(update={"by_hand": tmp_path / "ada.ink.npz"})
    build(tmp_path / "survey", "Whose?", Match(question="whose drawing", hands=(drawn, *others)), None)
    with Image.open(tmp_path / "survey" / "hand-1.png") as image:
        dark = np.array(image.convert("L")) < 128
    assert dark.shape == (512, 1024)
    assert dark[256, 256:768].all()
    assert not dark[np.r_[:250, 262:512]].any()
    assert not dark[:, np.r_[:250, 774:1024]].any()


def test_a_survey_from_before_whole_drawings_asks_what_it_asked(folder: Path) -> None:
    record = json.loads((folder / "survey.json").read_text())
    del record["match"]["question"]
    (folder / "survey.json").write_text(json.dumps(record))
    match = read_survey(folder).match
    assert match is not None
    assert match.question == "same hand"


def test_a_bad_picture_is_told_before_anything_is_written(tmp_path: Path) -> None:
    match, opinions = sources(tmp_path / "sources")
    opinions.pairs[1].looks[1].write_bytes(b"no picture")
    with pytest.raises(InputError, match="is not a picture"):
        build(tmp_path / "survey", "Whose?", match, opinions)
    assert not (tmp_path / "survey").exists()


def test_a_full_disk_leaves_no_half_survey(tmp_path: Path) -> None:
    match, opinions = sources(tmp_path / "sources")
    (tmp_path / "surveys").mkdir()
    full = OutputError("the disk is full")
    with (
        patch("maulstick.survey.questionnaire.write_record", side_effect=full),
        pytest.raises(OutputError, match="the disk is full"),
    ):
        build(tmp_path / "surveys" / "mine", "Whose?", match, opinions)
    assert list((tmp_path / "surveys").iterdir()) == []


def test_a_folder_with_something_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "survey").mkdir()
    (tmp_path / "survey" / "answers.sqlite").write_bytes(b"precious")
    with pytest.raises(OutputError, match="choose a new folder"):
        build(tmp_path / "survey", "Whose?", *sources(tmp_path / "sources"))
    assert [path.name for path in (tmp_path / "survey").iterdir()] == ["answers.sqlite"]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("x" * 300, "cannot look into .*: File name too long; choose another folder"),
        ("a\0b", r"cannot make the folder .*a\?b: embedded null byte; choose another"),
    ],
)
def test_a_folder_that_cannot_be_is_told(tmp_path: Path, name: str, says: str) -> None:
    with pytest.raises(OutputError, match=says):
        build(tmp_path / name, "Whose?", *sources(tmp_path / "sources"))


@pytest.mark.parametrize(("title", "says"), [("", "at least 1"), ("two\nlines", "plain text"), ("x" * 121, "120")])
def test_a_title_is_one_short_line(tmp_path: Path, title: str, says: str) -> None:
    with pytest.raises(InputError, match=rf"this is not a survey: title.*{says}"):
        build(tmp_path / "survey", title, *sources(tmp_path / "sources"))


def test_a_survey_asks_something(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a survey needs hands to match, or pairs for opinions"):
        build(tmp_path / "survey", "Whose?", None, None)


def test_hands_have_names_of_their_own_and_the_same_motifs() -> None:
    ada = SurveyHand(name="Ada", by_hand=Path("a.png"), by_machine=(Path("b.png"),))
    with pytest.raises(ValidationError, match="two hands have one name"):
        Match(hands=(ada, ada))
    with pytest.raises(ValidationError, match="as many drawings by machine"):
        Match(hands=(ada, SurveyHand(name="Bo", by_hand=Path("c.png"), by_machine=(Path("d.png"), Path("e.png")))))


def test_nobody_is_asked_about_more_than_there_is() -> None:
    hands = named().match
    assert hands is not None
    with pytest.raises(ValidationError, match="asked is 6; it must be at most the 5 hands"):
        Match(hands=hands.hands, asked=6)
    pair = Pair(reference=Path("a.png"), looks=(Path("b.png"), Path("c.png")))
    with pytest.raises(ValidationError, match="asked is 2; it must be at most the 1 pairs"):
        Opinions(systems=("old", "new"), pairs=(pair,), asked=2)
    with pytest.raises(ValidationError, match="both systems have one name"):
        Opinions(systems=("old", "old"), pairs=(pair,))


@pytest.mark.parametrize(
    "name", ["../secret.png", "/etc/passwd", "..", "a/b.png", "a\\b.png", "a.svg", "survey.json", "a.png\n", ".png"]
)
def test_a_survey_that_names_files_elsewhere_is_refused(folder: Path, name: str) -> None:
    record = json.loads((folder / "survey.json").read_text())
    record["match"]["hands"][1]["by_machine"][0] = name
    (folder / "survey.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match="must be the name of a PNG beside it"):
        read_survey(folder)


@pytest.mark.parametrize(("name", "what"), [("hand-2.png", "picture"), ("survey.json", "survey")])
def test_a_link_in_the_place_of_a_file_is_refused(folder: Path, tmp_path: Path, name: str, what: str) -> None:
    (folder / name).rename(tmp_path / "secret")
    (folder / name).symlink_to(tmp_path / "secret")
    with pytest.raises(InputError, match=re.escape(f"{name} is a link; put the {what} itself in its place")):
        read_survey(folder)


def test_a_picture_that_is_missing_is_named(folder: Path) -> None:
    (folder / "pair-1-look-2.png").unlink()
    with pytest.raises(InputError, match=r"there is no picture .*pair-1-look-2\.png"):
        read_survey(folder)


def test_a_picture_that_was_damaged_is_named_before_anybody_is_shown_it(folder: Path) -> None:
    picture = folder / "hand-2.png"
    picture.write_bytes(picture.read_bytes()[:-30])
    assert read_survey(folder).title == "Whose strokes?", "whose results are still there"
    with pytest.raises(InputError, match=r"cannot read the picture .*hand-2\.png"):
        read_survey_to_show(folder)
    with pytest.raises(InputError, match=r"cannot read the picture .*hand-2\.png"):
        participants(folder, lambda: None)


def test_a_field_that_is_not_known_is_refused(folder: Path) -> None:
    record = json.loads((folder / "survey.json").read_text())
    (folder / "survey.json").write_text(json.dumps(record | {"script": "x"}))
    with pytest.raises(InputError, match="is not a survey: script"):
        read_survey(folder)
