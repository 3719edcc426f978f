"""How far a painting is from its plan, before the brush is calibrated, after, and with replanning on the way.

    .venv/bin/python experiments/sim_to_real.py [--quick] [--out FOLDER]

A simulated easel holds a tool that the planner has never seen: another medium of libmypaint, of another size, that
lands beside its place and scatters. All that is learned of it is learned from photographs by a simulated webcam. For
each medium there are the stages

    blank        bare paper, beside the plan with the default brush
    default      planned with the built-in brush that is nearest in nominal width
    calibrated   planned with the brush fitted to strokes on one sheet, from one photograph
    replanned    the same, with photographs on the way, after each of which what is left is planned again
    floor        one plan painted and photographed twice

and for each a JSON line with `l1` and `ssim` between what the plan shows and the photograph of what was painted, both
on the pixels of the plan. What a replanned painting's plan shows is the last photograph with the strokes that were
still to come. `picture_l1` is between the photograph and the picture that was to be painted. PNGs of all stages side
by side go into the folder.
"""

import argparse
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Pillow
from skimage.data import astronaut

from maulstick.brush_fit.fit import fit_brush
from maulstick.calibration.collect import collect, trials_of
from maulstick.calibration.eye import Eye
from maulstick.jobs.paint.camera_loop import paint_by_eye, practice, replanned, room_of
from maulstick.ordering.sequence import sequenced
from maulstick.painting.brush import Brush, load_brush
from maulstick.painting.metrics import compare
from maulstick.painting.painting import Painting, Sheet, write_painting
from maulstick.painting.picture import encode_png, scaled
from maulstick.painting.raster import Canvas
from maulstick.planning.from_picture import as_painting, problem_of, provenance_of
from maulstick.planning.layout import lay_out_for
from maulstick.planning.planner import plan
from maulstick.planning.problem import PlannerSettings
from maulstick.rendering.preview import preview
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.journal import Journal, journal_of
from maulstick.robot.routine import Prompt
from maulstick.robot.simulated.camera import SimulatedCamera
from maulstick.robot.simulated.easel import SimulatedEasel
from maulstick.robot.simulated.sheets import MyPaintSheet
from maulstick.robot.workplace import Workplace
from maulstick.style import load_style

Image = NDArray[np.float32]

ROOM = 0.3
"""Metres: what a sheet of strokes to learn from needs at least."""

INK, FLAT = 8000.0, 5000.0
"""Pixels per metre of the simulated sheet, finer than any photograph, and of photographs that are made flat."""


@dataclass(frozen=True)
class Tool:
    """What the easel holds, and what its packet says.

    medium, radius, depth: of the simulated sheet, metres.  offset, scatter: of where strokes land, metres.
    nominal: the built-in brush that is nearest in width.
    """

    medium: str
    radius: float
    depth: float
    offset: tuple[float, float]
    scatter: float
    nominal: str


TOOLS = {
    "marker": Tool("marker_fat", 3.2e-3, 2e-3, (0.6e-3, -0.4e-3), 0.15e-3, "marker"),
    "brush": Tool("brush", 0.6e-3, 8e-3, (-0.5e-3, 0.7e-3), 0.2e-3, "round"),
}


@dataclass(frozen=True)
class Trial:
    """What is painted: side of the sheet, metres, its pixels, and how much of everything."""

    side: float
    pixels: int
    strokes: int
    steps: int
    practice: int
    every: int


WHOLE = Trial(0.16, 320, 400, 800, 60, 100)
QUICK = Trial(0.10, 160, 120, 300, 40, 40)


def main() -> None:
    """Print a line for each medium and stage."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a small canvas, in a few minutes")
    parser.add_argument("--out", type=Path, default=Path("sim-to-real"))
    parser.add_argument("--medium", choices=sorted(TOOLS), nargs="*", default=sorted(TOOLS))
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    for name in asked.medium:
        study = Study(name, QUICK if asked.quick else WHOLE, asked.out)
        for stage, shown, photograph in study.stages():
            metrics = compare(photograph, shown)
            line = {
                "medium": name,
                "stage": stage,
                "l1": float(np.abs(photograph - shown).mean()),
                "ssim": metrics.ssim,
            }
            print(json.dumps({**line, "picture_l1": float(np.abs(photograph - study.picture).mean())}), flush=True)
        study.write_plot()


class Study:
    """One tool, through all stages."""

    def __init__(self, name: str, trial: Trial, out: Path) -> None:
        self.name, self.tool, self.trial, self.out = name, TOOLS[name], trial, out
        self.canvas = Canvas.of_height((trial.side, trial.side), trial.pixels)
        whole = (astronaut() / 255).astype(np.float32)
        side = min(whole.shape[:2])
        self.picture = scaled(whole, (trial.pixels, trial.pixels), (0.0, 0.0, side, side))
        self.shown: list[tuple[str, Image]] = [("picture", self.picture)]

    def stages(self) -> Iterator[tuple[str, Image, Image]]:
        """Each stage by its name: what the plan shows, and the photograph."""
        built_in = load_brush(self.tool.nominal)
        nominal = built_in.model_copy(update={"depth": (0.0, self.tool.depth)})
        first = self.plan(nominal)
        shown = preview(first, self.canvas)
        self.shown.append(("default: plan", shown))
        yield "blank", shown, self.small(Easel(self, 0).photograph())
        photograph = self.painted(first, 1)
        self.shown.append(("default: painted", photograph))
        yield "default", shown, photograph
        brush = self.calibrated(nominal)
        second = self.plan(brush)
        shown = preview(second, self.canvas)
        photograph = self.painted(second, 3)
        self.shown += [("calibrated: plan", shown), ("calibrated: painted", photograph)]
        yield "calibrated", shown, photograph
        again = self.painted(second, 4)
        shown, by_eye = self.painted_by_eye(second, 5)
        self.shown += [("replanned: plan", shown), ("replanned: painted", by_eye)]
        yield "replanned", shown, by_eye
        yield "floor", photograph, again

    def plan(self, brush: Brush) -> Painting:
        """Plan the picture in six paints with that brush."""
        sheet = Sheet(width=self.trial.side, height=self.trial.side)
        layout = lay_out_for(self.picture, sheet, brush, "cover", self.trial.pixels)
        style = load_style("loops", layout.canvas)
        options = PlannerSettings(self.trial.strokes, paints=6, steps=self.trial.steps)
        planned = plan(problem_of(layout, brush, style, options), options)
        made = provenance_of(
            options, "astronaut.png", None, {"style": "loops", "fit": "cover", "px": self.trial.pixels}
        )
        return sequenced(as_painting(planned, layout, brush, style, made), (0.0, 0.0))

    def painted(self, painting: Painting, seed: int) -> Image:
        """Paint it on a new sheet; the photograph."""
        easel = Easel(self, seed)
        with easel.at_work(painting) as workplace:
            workplace.do(workplace.left_of(painting))
        return self.small(easel.photograph())

    def painted_by_eye(self, painting: Painting, seed: int) -> tuple[Image, Image]:
        """Paint it and plan again on the way: what the last plan shows, and the photograph."""
        easel = Easel(self, seed)
        shown = [preview(painting, self.canvas)]

        with easel.at_work(painting) as workplace:

            def again(before: Painting, photograph: Image) -> Painting:
                painted = workplace.journal.painted
                after = replanned(before, painted, photograph, self.picture, steps=self.trial.steps // 4)
                rest = tuple(stroke for stroke in after.strokes if stroke.id not in painted)
                shown.append(_over(photograph, after.model_copy(update={"strokes": rest}), self.canvas))
                return after

            paint_by_eye(
                painting,
                workplace,
                lambda: (easel.photograph(), easel.told),
                again,
                lambda painted: painted == self.trial.every,
            )
        return shown[-1], self.small(easel.photograph())

    def small(self, photograph: Image) -> Image:
        """A photograph on the pixels of the plan."""
        size = self.canvas.width_px, self.canvas.height_px
        return scaled(photograph, size, (0.0, 0.0, photograph.shape[1], photograph.shape[0]))

    def calibrated(self, nominal: Brush) -> Brush:
        """The brush, from one sheet of strokes and a photograph before and after."""
        style = load_style("loops", self.canvas)
        side = max(2 * self.trial.side, ROOM)
        sheet = practice(style, nominal, Sheet(width=side, height=side), self.trial.practice)
        easel = Easel(self, 2, side)
        with easel.at_work(sheet) as workplace, TemporaryDirectory() as folder:
            photographs = collect(sheet, workplace, easel.photograph, Path(folder), each=False)
            trials = trials_of(
                sheet,
                photographs,
                Path(folder) / "trials",
                medium=self.name,
                depth=(0.0, self.tool.depth),
                room=room_of(nominal),
            )
            found = fit_brush(trials, trials.pixels_per_metre, self.name, source=self.name, depth=trials.depth)
        print(json.dumps({"medium": self.name, "fit": found.brush.model_dump(exclude_defaults=True)}), flush=True)
        return found.brush

    def write_plot(self) -> None:
        """All that was shown, side by side."""
        height = 2 * self.trial.pixels
        plot = np.ones((height, sum(height for _ in self.shown), 3), dtype=np.float32)
        for place, (_, image) in enumerate(self.shown):
            large = Pillow.fromarray((255 * image).round().astype(np.uint8)).resize((height, height))
            plot[:, place * height : (place + 1) * height] = np.asarray(large) / 255
        Pillow.fromarray((255 * plot).astype(np.uint8)).save(self.out / f"{self.name}.png")


class Easel:
    """A new sheet before the machine, and the camera over it."""

    def __init__(self, study: Study, seed: int, side: float | None = None) -> None:
        tool, side = study.tool, side or study.trial.side
        canvas = Canvas(side, side, INK)
        rng = np.random.default_rng(seed)
        self.sheet = MyPaintSheet(canvas, tool.medium, tool.radius, tool.depth)
        self.robot = SimulatedEasel(self.sheet, offset=tool.offset, scatter=tool.scatter, rng=rng)
        self.told = self.robot.easel(side, side)
        self.camera = SimulatedCamera(self.sheet.image, canvas, rng)
        self.eye = Eye.opened(self.camera, Canvas(side, side, FLAT), TagFrame(side, side))

    def photograph(self) -> Image:
        """The flat sheet, as finely as it is seen."""
        return self.eye.look().image

    @contextmanager
    def at_work(self, painting: Painting) -> Iterator[Workplace]:
        """The machine, painting that, with somebody who changes its pens."""

        def ask(action: Prompt) -> None:
            self.robot.hold(painting.paints[action.paint].colour)

        with TemporaryDirectory() as folder:
            path = Path(folder) / "painting.json"
            write_painting(painting, path)
            with self.robot, Journal.open(journal_of(path)) as journal:
                journal.revise(path)
                yield Workplace(self.robot, self.told, journal, ask)


def _over(photograph: Image, rest: Painting, canvas: Canvas) -> Image:
    size = {"width": rest.sheet.width, "height": rest.sheet.height, "picture": encode_png(photograph)}
    return preview(rest.model_copy(update={"sheet": Sheet.model_validate(size)}), canvas)


if __name__ == "__main__":
    main()
