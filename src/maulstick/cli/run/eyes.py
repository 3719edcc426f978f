"""The camera of a run: it looks at the sheet on the way, and what is left is planned again."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from maulstick.calibration.eye import Eye
from maulstick.canvas import Canvas
from maulstick.errors import InputError
from maulstick.files import atomic_write, file_sum
from maulstick.painting import Painting
from maulstick.picture import encode_png, read_picture
from maulstick.robot.camera import Camera, open_camera
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal
from maulstick.robot.tag_frame import TagFrame
from maulstick.robot.workplace import Workplace

if TYPE_CHECKING:
    from maulstick.cli.run.simulation import Simulation

Image = NDArray[np.float32]

_READ_PX = 4096
_FINE, _MOST_PX = 5000, 2048  # pixels a metre of a photograph's flat sheet, and on its longer side


@dataclass(frozen=True)
class Watching:
    """camera: its word.  every: strokes between two photographs.  picture: that the plan was made of.

    tag: the side of a tag's black square, metres.
    """

    camera: str
    every: int
    picture: Path
    tag: float

    def check(self, plan: Painting) -> None:
        """Raise InputError where the picture is not the one that was planned."""
        if plan.made.image_sha256 is None:
            raise InputError("the painting was not planned from a picture, so it cannot be planned again on the way")
        if file_sum(self.picture) != plan.made.image_sha256:
            raise InputError(f"{self.picture} is not the picture {plan.made.image} that was planned; name that one")

    def paint(self, plan: Painting, workplace: Workplace, simulation: "Simulation | None", console: Console) -> None:
        """Paint what is left of the plan, and plan again on the way."""
        from maulstick.loop import check_replannable, paint_by_eye, replanned  # loads torch

        picture = read_picture(self.picture, longest_px=_READ_PX)
        journal, first = workplace.journal, workplace.easel
        check_replannable(plan, journal.painted)
        camera = simulation.camera(self._tags(plan)) if simulation is not None else open_camera(self.camera)
        with camera:
            eye = self._eye(camera, plan, journal)

            def look() -> tuple[Image, Easel]:
                sight = eye.look()
                for note in sight.notes:
                    console.print(f"note: {note}", soft_wrap=True)
                atomic_write(_beside(journal, f".r{journal.revisions}.png"), encode_png(sight.image))
                return sight.image, sight.easel(first, eye.canvas)

            def again(painting: Painting, photograph: Image) -> Painting:
                return replanned(painting, journal.painted, photograph, picture)

            paint_by_eye(plan, workplace, look, again, every=self.every)

    def _tags(self, plan: Painting) -> TagFrame:
        return TagFrame(plan.canvas.width, plan.canvas.height, side=self.tag)

    def _eye(self, camera: Camera, plan: Painting, journal: Journal) -> Eye:
        """One that has seen the bare sheet, in this run or in the one that this goes on with."""
        size = plan.canvas.width, plan.canvas.height
        canvas, kept = Canvas(*size, min(_FINE, _MOST_PX / max(size))), _beside(journal, ".eye.npz")
        if journal.painted:
            if not kept.exists():
                raise InputError(f"there is no {kept}, so no camera saw the bare sheet; go on without --replan")
            return Eye.opened_again(camera, canvas, self._tags(plan), kept)
        eye = Eye.opened(camera, canvas, self._tags(plan), plan.canvas.paper)
        eye.write(kept)
        return eye


def _beside(journal: Journal, ending: str) -> Path:
    return journal.path.with_name(journal.path.name.removesuffix(".log.jsonl") + ending)
