"""Replanning: the camera of a run photographs the sheet on the way, and what is left is planned again."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from maulstick.calibration.camera import read_view
from maulstick.calibration.colour import Colours, read_colours
from maulstick.calibration.eye import Eye
from maulstick.errors import InputError, Remedy, needs_torch, option
from maulstick.jobs.paint.operator import Operator
from maulstick.jobs.paint.options import PaintOptions
from maulstick.jobs.paint.simulation import Simulation
from maulstick.painting.edit import PictureEdit
from maulstick.painting.painting import Painting
from maulstick.painting.picture import READ_PX, encode_png, read_picture
from maulstick.painting.raster import flat_canvas
from maulstick.robot.camera.camera import open_camera
from maulstick.robot.camera.tag_frame import TagFrame
from maulstick.robot.easel import Easel
from maulstick.robot.journal import Journal
from maulstick.robot.routine import PaintLoad
from maulstick.robot.workplace import Workplace
from maulstick.storage.arrays import Image
from maulstick.storage.files import atomic_write, file_sum


@dataclass(frozen=True)
class Replanning:
    """Options of replanning.

    camera: its spec, None for the simulated easel's.  every: strokes between two photographs, 0 for only those that
    the operator asks for.  picture: the one that was planned.  view: the calibration file of a camera that does not
    move, where there are no tags.  tag: the side of a tag's black square, metres.  colours: the file of the colour
    calibration.
    """

    camera: str | None
    every: int
    picture: Path
    view: Path | None
    tag: float
    colours: Path | None

    @classmethod
    def of(cls, options: PaintOptions) -> Self | None:
        """Return replanning by the options, or None. Raises InputError where an option for it is missing or useless."""
        if not (options.replan or options.look):
            if (
                options.replan is None
                and (options.camera, options.picture, options.view, options.tag, options.colours) != (None,) * 5
            ):
                raise InputError(
                    f"{option('camera')}, {option('picture')}, {option('view')}, {option('tag')} and "
                    f"{option('colours')} are for {option('replan')}; add it, or leave them out"
                )
            return None
        if options.picture is None:
            raise InputError("planning again needs the picture that the painting is of", Remedy.NAME_PICTURE)
        if options.simulated:
            if options.camera is not None:
                raise InputError("the simulated easel has a camera of its own", Remedy.LEAVE_OUT_CAMERA)
        elif options.camera is None:
            raise InputError("planning again needs a camera over the sheet", Remedy.NAME_CAMERA)
        return cls(
            options.camera, options.replan or 0, options.picture, options.view, options.tag_side, options.colours
        )

    def check(self, plan: Painting) -> None:
        """Raise InputError where the picture is not the one that was planned, or the plan cannot be planned again."""
        if plan.provenance.image_sha256 is None:
            raise InputError("the painting was not planned from a picture, so it cannot be planned again on the way")
        if file_sum(self.picture) != plan.provenance.image_sha256:
            raise InputError(
                f"{self.picture} is not the picture {plan.provenance.image} that was planned; name that one"
            )
        self._tags(plan)  # refuses a side that no tag has
        self._chart()
        with needs_torch():
            from maulstick.jobs.paint.camera_loop import check_replannable

        check_replannable(plan)

    @contextmanager
    def opened(
        self, plan: Painting, simulation: Simulation | None, before: Journal | None, tell: Callable[[str], None]
    ) -> Iterator[Eye]:
        """Open the camera, as an eye that has seen the bare sheet: now, or in the run `before` that is resumed.

        tell: as in `open_camera`.
        """
        tags = self._tags(plan)
        view = None if self.view is None else read_view(self.view)
        canvas = flat_canvas(plan.sheet.width, plan.sheet.height)
        if before is not None and not (kept := _eye_of(before)).exists():
            raise InputError(f"there is no {kept}, so no camera saw the bare sheet", Remedy.WITHOUT_REPLAN)
        with simulation.camera(tags) if simulation is not None else open_camera(self.camera or "", tell) as camera:
            if before is not None:
                yield Eye.opened_again(camera, canvas, tags, _eye_of(before), view)
            else:
                yield Eye.opened(camera, canvas, tags, plan.sheet.paper, self._chart(), view)

    def keep(self, eye: Eye, journal: Journal) -> None:
        """Write what the eye saw of the bare sheet, for a run that resumes this one."""
        eye.write(_eye_of(journal))

    def paint(self, plan: Painting, workplace: Workplace, eye: Eye, operator: Operator, load: PaintLoad) -> PaintLoad:
        """Paint what is left of the plan, and plan the rest again on the way; returns the machine's load at the end."""
        from maulstick.jobs.paint.camera_loop import paint_by_eye, replanned

        edit = PictureEdit.of(plan.provenance.options)
        picture = read_picture(self.picture, longest_px=edit.read_px(READ_PX))
        journal, first = workplace.journal, workplace.easel

        def look() -> tuple[Image, Easel]:
            """Photograph the sheet; return the picture, and where the sheet lies."""
            with operator.interruptible():
                seen = eye.look()
            for note in seen.notes:
                operator.note(note)
            photograph = _beside(journal, f".r{journal.revisions}.png")
            atomic_write(photograph, encode_png(seen.image))
            operator.show(photograph)
            return seen.image, seen.easel(first, eye.canvas)

        def again(painting: Painting, photograph: Image) -> Painting:
            """Plan the strokes that are left again."""
            with operator.interruptible():
                painting = replanned(painting, journal.painted, photograph, picture)
                operator.expect_plan(painting)
            return painting

        def enough(painted: int) -> bool:
            """Return whether to look at the sheet after so many strokes."""
            return painted == self.every or operator.wants_a_look()

        return paint_by_eye(plan, workplace, look, again, enough, load)

    def _tags(self, plan: Painting) -> TagFrame:
        return TagFrame(plan.sheet.width, plan.sheet.height, side=self.tag)

    def _chart(self) -> Colours | None:
        return None if self.colours is None else read_colours(self.colours)


def _eye_of(journal: Journal) -> Path:
    return _beside(journal, ".eye.npz")


def _beside(journal: Journal, ending: str) -> Path:
    """Return the path of the file beside a journal that has another ending."""
    return journal.path.with_name(journal.path.name.removesuffix(".log.jsonl") + ending)
