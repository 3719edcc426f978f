"""How near a painting comes to its picture, with a brush that is calibrated, and with replanning on the way as well.

    .venv/bin/python experiments/sim_to_real.py [--medium M …] [--picture P …] [--seed S …] [--out FOLDER]

A simulated easel holds a tool that the planner has never seen (`simulated_tools.py`). For each medium and seed its
brush is fitted to one sheet of strokes; for each medium, picture and seed two paintings are made of as many strokes:

    calibrated   planned with that brush, and painted without a look
    replanned    the same plan, with photographs on the way, after each of which what is left is planned again

Distances are the root mean square of CIEDE2000 over the picture's area, in units of a just visible difference, after
both images were blurred (in sRGB) by a Gaussian of 1 mm. Each row is appended to FOLDER/rows.jsonl, and not made twice;
in the end all are printed:

    planned                  from the plan's preview to the picture: a machine without faults
    planned_again            the same after as many steps more as the replanned painting gets, on previews of what is
                             painted instead of photographs: what the steps alone do
    calibrated, replanned    from the photograph of the painting to the picture
    floor                    between two paintings of the one plan
    calibrated_plan          from the painting to its plan
    last_plan, last_floor    strokes after the last photograph, where they mark: from the replanned painting to what its
                             last plan says, and between two paintings of these strokes on the same sheet

FOLDER/sim-to-real.jpg shows, of the first picture and seed, for each medium: picture, plan, calibrated, replanned.
"""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image as Pillow
from scipy.ndimage import gaussian_filter
from simulated_tools import TOOLS, Tool, ToolEasel
from skimage import data
from skimage.color import deltaE_ciede2000, rgb2lab

from maulstick.jobs.paint.camera_loop import paint_by_eye, replanned
from maulstick.ordering.sequence import sequenced
from maulstick.painting.brush import Brush, load_brush, write_brush
from maulstick.painting.painting import Painting, Sheet
from maulstick.painting.picture import encode_png, scaled
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.rendering.preview import coverage, preview
from maulstick.storage.arrays import Bools, Image
from maulstick.style import load_style

PICTURES = ("astronaut", "chelsea", "coffee")
"""Pictures of scikit-image. How to plan again was chosen on others, `rocket` and `stereo_motorcycle`, and seed 100."""

SIDE, MOUNT = 0.08, 6e-3
"""Metres: the sheet's side, and the paper that is left white around the picture, which shows where the sheet lies."""

PIXELS = 112
"""Pixels of the sheet's side while planning."""

STROKES, PAINTS, STEPS, EVERY = 240, 6, 800, 60
"""Of a plan; and strokes between two photographs."""

BLUR, SCORED = 1e-3, 2000.0
"""Metres: one sigma of the blur before images are compared; and pixels per metre of them."""

MARKED = 0.05
"""Least share of a pixel that strokes hide where they are said to mark it."""

Row = dict[str, str | int | float]


@dataclass(frozen=True)
class Painted:
    """A replanned painting.

    photograph: of it.  last: the sheet at the last photograph, with the strokes that were still to come as the last
    plan draws them.  again: a photograph of that sheet with these strokes painted once more.
    changed: (H, W), where they mark, on the scored pixels.
    """

    photograph: Image
    last: Image
    again: Image
    changed: Bools


def main() -> None:
    """Paint what is asked for and is not there yet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("sim-to-real"))
    parser.add_argument("--medium", choices=sorted(TOOLS), nargs="*", default=sorted(TOOLS))
    parser.add_argument("--picture", nargs="*", default=list(PICTURES), help="names of pictures in skimage.data")
    parser.add_argument("--seed", type=int, nargs="*", default=list(range(5)))
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    made = {(row["medium"], row["picture"], row["seed"]) for row in rows_in(asked.out)}
    for seed in asked.seed:
        for medium in asked.medium:
            for name in asked.picture:
                if (medium, name, seed) not in made:
                    row = Study(TOOLS[medium], name, seed, asked.out).row()
                    with (asked.out / "rows.jsonl").open("a") as file:
                        file.write(json.dumps(row) + "\n")
    for row in rows_in(asked.out):
        print(json.dumps(row))
    write_plot(asked.out)


class Study:
    """One tool, one picture, one seed: both paintings, and how near they come."""

    def __init__(self, tool: Tool, name: str, seed: int, out: Path) -> None:
        self.tool, self.name, self.seed, self.out = tool, name, seed, out
        self.canvas = Canvas(SIDE, SIDE, PIXELS / SIDE)
        self.scored = Canvas(SIDE, SIDE, SCORED)
        self.style = load_style("loops", self.canvas)
        self.picture = mounted((getattr(data, name)() / 255).astype(np.float32))

    def row(self) -> Row:
        """All distances."""
        planned = self.plan(self.brush())
        shown = preview(planned, self.scored)
        seeds = np.random.SeedSequence(self.seed).generate_state(3).tolist()
        once, twice = (self.seen(ToolEasel(self.tool, SIDE, seed).paint(planned)) for seed in seeds[:2])
        by_eye = self.painted_by_eye(planned, seeds[2])
        picture = self.seen(self.picture)
        self.keep([picture, shown, once, by_eye.photograph])
        return {
            "medium": self.tool.medium,
            "picture": self.name,
            "seed": self.seed,
            "planned": distance(shown, picture),
            "planned_again": distance(preview(self.planned_again(planned), self.scored), picture),
            "calibrated": distance(once, picture),
            "replanned": distance(by_eye.photograph, picture),
            "floor": distance(once, twice),
            "calibrated_plan": distance(once, shown),
            "last_plan": distance(by_eye.photograph, by_eye.last, by_eye.changed),
            "last_floor": distance(by_eye.photograph, by_eye.again, by_eye.changed),
        }

    def brush(self) -> Brush:
        """The brush of the tool, fitted once."""
        path = self.out / f"{self.tool.medium}-{self.seed}.json"
        if not path.exists():
            write_brush(self.tool.calibrated(self.style, self.seed), path)
        return load_brush(str(path))

    def plan(self, brush: Brush) -> Painting:
        """Plan the picture."""
        layout = lay_out_for(self.picture, Sheet(width=SIDE, height=SIDE), brush, "contain", PIXELS)
        options = PlannerSettings(STROKES, exact=True, paints=PAINTS, steps=STEPS, seed=self.seed)
        planned = plan(problem_of(layout, (brush,), self.style, options), options)
        made = provenance_of(options, self.name, None, {"style": "loops", "fit": "contain", "px": PIXELS})
        return sequenced(as_painting(planned, layout, (brush,), self.style, made), (0.0, 0.0))

    def planned_again(self, painting: Painting) -> Painting:
        """Plan it again as often as on the way, as if the sheet always looked as planned."""
        for done in range(EVERY, STROKES, EVERY):
            painted = {stroke.id for stroke in painting.strokes[:done]}
            painting = replanned(painting, painted, preview(painting, self.scored, done), self.picture)
        return painting

    def painted_by_eye(self, painting: Painting, seed: int) -> Painted:
        """Paint it, and plan again on the way."""
        easel = ToolEasel(self.tool, SIDE, seed)
        looks: list[tuple[Image, Painting, Image]] = []  # each photograph, what is painted after it, and the sheet

        with easel.at_work(painting) as workplace:

            def again(before: Painting, photograph: Image) -> Painting:
                painted = workplace.journal.painted
                after = replanned(before, painted, photograph, self.picture)
                assert len(after.strokes) == len(painting.strokes)
                rest = tuple(stroke for stroke in after.strokes if stroke.id not in painted)
                looks.append((photograph, after.model_copy(update={"strokes": rest}), easel.sheet.image()))
                return after

            paint_by_eye(
                painting,
                workplace,
                lambda: (easel.photograph(), easel.told),
                again,
                lambda painted: painted == EVERY,
            )
        seen = self.seen(easel.photograph())
        photograph, rest, sheet = looks[-1]
        easel.sheet.lay(sheet)
        twice = self.seen(easel.paint(rest))
        under = Sheet.model_validate({"width": SIDE, "height": SIDE, "picture": encode_png(photograph)})
        last = preview(rest.model_copy(update={"sheet": under}), self.scored)
        return Painted(seen, last, twice, coverage(rest, self.scored) > MARKED)

    def seen(self, image: Image) -> Image:
        """An image of the sheet on the pixels that are scored."""
        size = self.scored.width_px, self.scored.height_px
        return scaled(image, size, (0.0, 0.0, image.shape[1], image.shape[0]))

    def keep(self, images: list[Image]) -> None:
        """Write images side by side."""
        strip = (255 * np.concatenate(images, axis=1).clip(0, 1)).round().astype(np.uint8)
        Pillow.fromarray(strip).save(self.out / f"{self.tool.medium}-{self.name}-{self.seed}.png")


def mounted(picture: Image) -> Image:
    """The middle of a picture, square, in a white mount."""
    high, wide = picture.shape[:2]
    side = min(high, wide)
    within = round(SCORED * (SIDE - 2 * MOUNT))
    middle = scaled(picture, (within, within), ((wide - side) / 2, (high - side) / 2, side, side))
    border = round(SCORED * MOUNT)
    return np.pad(middle, ((border, border), (border, border), (0, 0)), constant_values=1.0)


def distance(one: Image, other: Image, where: Bools | None = None) -> float:
    """Root mean square of CIEDE2000 of two images of the sheet, blurred by `BLUR`, within the mount.

    where: (H, W), the scored pixels that count; all of them when left out.
    """
    border = round(SCORED * MOUNT)
    inner = slice(border, -border), slice(border, -border)
    sigma = SCORED * BLUR
    labs = [rgb2lab(gaussian_filter(image.astype(np.float64), (sigma, sigma, 0)).clip(0, 1)) for image in (one, other)]
    squares = np.square(deltaE_ciede2000(*labs))[inner]
    return float(np.sqrt(squares.mean() if where is None else squares[where[inner]].mean()))


def rows_in(folder: Path) -> list[Row]:
    """All rows in the folder."""
    path = folder / "rows.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def write_plot(folder: Path) -> None:
    """The strips of the first picture and seed, one below the other."""
    strips = [np.asarray(Pillow.open(path)) for path in sorted(folder.glob(f"*-{PICTURES[0]}-0.png"))]
    Pillow.fromarray(np.concatenate(strips)).save(folder / "sim-to-real.jpg", quality=90)


if __name__ == "__main__":
    main()
