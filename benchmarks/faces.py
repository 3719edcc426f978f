"""What it changes that faces count more: one JSON object per line, then the differences.

    .venv/bin/python benchmarks/faces.py [IMAGE ...] [--seeds N]

image: a photograph with a frontal face that comes along with scikit-image or Matplotlib, 256 pixels high, planned with
    400 strokes of the nominal round brush, 12 paints and 500 steps, by tones alone.
faces: how much more a face counts, as in `maulstick plan --weight faces=0`.
psnr, ssim: over the whole picture, at the truth, as in `plan.py`.  face_psnr: over the square of the face, as the
    planner finds it.
face_share: that square's share of the picture.
gain: with faces=1 less with faces=0 at the same seed: the mean over seeds, and its 95 % interval (Student's t).
"""

import argparse
import json
from dataclasses import dataclass
from functools import cache

import numpy as np
from intervals import of_few
from matplotlib.cbook import get_sample_data
from photographs import BRUSH, HEIGHT
from PIL import Image as Pillow
from skimage import data

from maulstick.painting.metrics import compare
from maulstick.painting.painting import Sheet
from maulstick.planning.attention import find_faces
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import HEIGHT_PX, Layout, lay_out_for
from maulstick.planning.losses import LossOptions
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.planning.weights import FACES
from maulstick.rendering.preview import truth
from maulstick.style import load_style

IMAGES = ("astronaut", "grace_hopper")


@dataclass(frozen=True)
class Row:
    """One plan, as described above."""

    image: str
    faces: float
    seed: int
    psnr: float
    ssim: float
    face_psnr: float
    face_share: float


@cache
def laid_out(image: str) -> Layout:
    """Return the photograph on all of a sheet 160 mm high."""
    if image == "grace_hopper":
        picture = np.asarray(Pillow.open(get_sample_data("grace_hopper.jpg", asfileobj=False)).convert("RGB"))
    else:
        picture = getattr(data, image)()
    sheet = Sheet(width=HEIGHT * picture.shape[1] / picture.shape[0], height=HEIGHT)
    return lay_out_for(picture.astype(np.float32) / 255, sheet, BRUSH, "contain", HEIGHT_PX)


def measure(image: str, faces: float, seed: int) -> Row:
    """Plan the photograph, and compare the plan with it."""
    layout, settings = laid_out(image), PlannerSettings(seed=seed)
    style = load_style("free", layout.canvas)
    problem = problem_of(layout, (BRUSH,), style, settings, LossOptions(weights={FACES: faces}))
    painting = as_painting(plan(problem, settings), layout, (BRUSH,), style, provenance_of(settings))
    assert layout.target is not None
    painted, target = layout.crop(truth(painting, layout.canvas)), layout.crop(layout.target)
    whole = compare(painted, target)
    (face,) = find_faces(target)
    square = tuple(slice(round(middle - face.radius), round(middle + face.radius)) for middle in (face.y, face.x))
    share = target[square].size / target.size
    return Row(image, faces, seed, whole.psnr, whole.ssim, compare(painted[square], target[square]).psnr, share)


def gain(name: str, rows: list[Row]) -> dict[str, float]:
    """Return what faces=1 adds to a measure: the mean over seeds, and the ends of its interval."""
    by_seed = {(row.seed, row.faces): getattr(row, name) for row in rows}
    gains = np.array([by_seed[seed, 1.0] - by_seed[seed, 0.0] for seed in sorted({row.seed for row in rows})])
    low, high = of_few(gains)
    return {"mean": round(gains.mean(), 3), "low": low, "high": high}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", nargs="*", default=IMAGES, metavar="IMAGE", help=" or ".join(IMAGES))
    parser.add_argument("--seeds", type=int, default=3)
    asked = parser.parse_args()
    if unknown := [image for image in asked.images if image not in IMAGES]:
        parser.error(f"there is no image {unknown[0]}; there are: {', '.join(IMAGES)}")
    for image in asked.images:
        rows = []
        for seed in range(asked.seeds):
            for faces in (1.0, 0.0):
                rows.append(measure(image, faces, seed))
                print(json.dumps(vars(rows[-1])), flush=True)
        gains = {name: gain(name, rows) for name in ("psnr", "ssim", "face_psnr")}
        print(json.dumps({"image": image, "gain": gains}), flush=True)


if __name__ == "__main__":
    main()
