"""Finished plans in a studio's folder, without the time that planning takes."""

import json
import shutil
from pathlib import Path

import numpy as np

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Painting
from maulstick.painting.painting_file import write_painting
from maulstick.painting.picture import encode_png
from maulstick.storage.files import file_sum
from maulstick.storage.records import write_record
from maulstick.studio.state.mixing import Mixed
from tests.support.planned import STROKES as ENOUGH
from tests.support.planned import picture, planned
from tests.support.robot.small_paintings import line, painting_of

STROKES = 30
LINES = painting_of([line(i, (0.005, 0.001 * i), (0.035, 0.001 * i)) for i in range(STROKES)])
"""Strokes of 30 mm, 0.4 s each at an arm's pace."""


def put_plan(root: Path, name: str, painting: Painting = LINES, mixed: bool = True) -> Path:
    """Put a finished plan into the studio's folder; return its painting.json. mixed: whether its paints are mixed."""
    folder = root / "plans" / name
    folder.mkdir(parents=True)
    photo = None if painting.provenance.image is None else root / "pictures" / name / "picture.png"
    write_painting(painting, folder / "painting.json")
    (folder / "request.json").write_text(json.dumps(_request(photo).as_json()))
    (folder / "preview.png").write_bytes(encode_png(np.ones((40, 60, 3), dtype=np.float32)))
    if mixed:
        write_record(Mixed(paints=tuple(sorted({paint.label for paint in painting.paints}))), folder / "mixed.json")
    return folder / "painting.json"


def put_plan_of_a_picture(root: Path, name: str) -> Path:
    """Put a plan with its picture, by which it can be planned again, into the studio's folder."""
    folder = root / "pictures" / name
    folder.mkdir(parents=True)
    (folder / "picture.png").write_bytes(encode_png(picture()))
    known = {"image": "picture.png", "image_sha256": file_sum(folder / "picture.png")}
    made = planned().provenance.model_copy(update=known)
    return put_plan(root, name, planned().model_copy(update={"provenance": made}))


def put_plan_to_direct(root: Path, name: str) -> Path:
    """Put a plan with its picture, which is planned again in a second, into the studio's folder."""
    file = put_plan_of_a_picture(root, name)
    photo = root / "pictures" / name / "picture.png"
    shutil.copy(photo, photo.with_name("small.jpg"))
    options = PlanOptions(
        size="60x60mm", strokes=ENOUGH, paints=2, brush="marker", style="loops", steps=3, ask_every=1, px=48
    )
    (file.parent / "request.json").write_text(json.dumps(PlanRequest(photo, options).as_json()))
    return file


def _request(photo: Path | None) -> PlanRequest:
    text = None if photo is not None else "lines"
    options = PlanOptions(
        text=text, size="60x40mm", strokes=STROKES, paints=2, brush="marker", style="loops", steps=10, ask_every=1
    )
    return PlanRequest(photo, options)
