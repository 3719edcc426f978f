"""State that all pages show: one studio, however many pages are open."""

import asyncio
from dataclasses import replace
from pathlib import Path
from typing import final

from maulstick.errors import InputError
from maulstick.studio.state.by_hand import ByHand
from maulstick.studio.state.camera_views import CAMERAS, CameraViews
from maulstick.studio.state.directing import Directing
from maulstick.studio.state.drawing import Drawing
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.gallery import Gallery
from maulstick.studio.state.mixing import MIXED, Mixing
from maulstick.studio.state.own_pictures import with_own
from maulstick.studio.state.plan import Plan
from maulstick.studio.state.plans import Plans
from maulstick.studio.state.presets import PRESETS_FOLDER, Presets
from maulstick.studio.state.reference import Reference
from maulstick.studio.state.run import Run
from maulstick.studio.state.settings import Settings
from maulstick.studio.state.styles import Styles
from maulstick.studio.state.surveys import Surveys
from maulstick.studio.state.svgs import Svgs
from maulstick.studio.state.thrown import STYLES_FOLDER
from maulstick.studio.state.titles import title_of
from maulstick.studio.state.trash import Trash
from maulstick.studio.state.version_words import version_in_words
from maulstick.studio.state.versions import Around, painted_of, version_title, without_own_places
from maulstick.studio.state.weighing import weights_of
from maulstick.studio.workers.desk import Desk
from maulstick.studio.workers.planner import TARGET

_OVER = "planned again over a photograph of the sheet"


@final
class Studio:
    """State of the studio; made in the server's event loop.

    drawing: of the hand that is being drawn.  reference: picture to look at meanwhile.
    gallery: pictures to paint.  plans: finished ones, and those being made.
    settings: what was chosen last.  presets: settings that were kept under a title.
    svgs: drawings to paint as they are.  mixing: of paints.  run: of a machine that paints.
    camera_views: of cameras over a sheet.  by_hand: machine that a person sets up.  trash: what was thrown away.
    """

    def __init__(self, folder: Folder) -> None:
        self.folder, self.desk = folder, Desk()
        self.drawing, self.reference = Drawing(folder, self.desk), Reference()
        self.styles = Styles(folder, self.desk)
        self.gallery = Gallery(folder, self.desk)
        self.plans, self.settings, self.presets = Plans(folder), Settings(folder), Presets(folder)
        self._directed: dict[str, Directing] = {}  # by the plan's name, once somebody does
        self.svgs = Svgs(folder, self.desk)
        self.mixing = Mixing(folder, self.desk)
        self.surveys = Surveys(folder, self.desk)
        self.run = Run(folder, self.desk, self.mixing, self.plans)
        self.camera_views = CameraViews(folder, self.desk)
        self.by_hand = ByHand(self.run.easels)
        self.trash = Trash(
            folder,
            self.styles,
            {
                "hands": self.drawing.hands.take_back,
                "pictures": self.gallery.take_back,
                "plans": self.plans.take_back,
                "drawings": self.svgs.take_back,
                "surveys": self.surveys.take_back,
                STYLES_FOLDER: self.styles.take_back,
                ".": lambda trashed, _: self.mixing.take_back(trashed),
                PRESETS_FOLDER: lambda trashed, _: self.presets.take_back(trashed),
                "easels": lambda trashed, _: self.run.easels.take_back(trashed),
                CAMERAS: lambda trashed, _: self.camera_views.take_back(trashed),
            },
        )

    def directing(self, name: str) -> Directing:
        """Return a person's acts on the plan of that name. Raises InputError where there is no finished one."""
        plan = self.plans.of(name)
        if plan.is_busy or not plan.is_painting:
            raise InputError(f"{plan.title} is not planned yet; direct it once it is")
        if name not in self._directed or self._directed[name].planned != plan.planned:
            self._directed[name] = Directing(plan.folder / "painting.json", self.desk)
        return self._directed[name]

    async def version_of(
        self, name: str, *, is_kept: bool = False, photograph: str = "", weights: dict[str, float] | None = None
    ) -> Plan:
        """Make a version of the plan of that name: planned again around what a person has locked, changed and said.

        is_kept: whether it is the painting as it is now instead, with nothing planned.  photograph: name of a picture
        of the sheet, over which it is planned without the strokes that are painted, or "".  weights: of all terms,
        where others are to matter. Returns the new plan.
        Raises InputError where there is no finished plan, no guide to follow or no stroke to keep, OutputError where
        there is no room.
        """
        directing, plan = self.directing(name), self.plans.of(name)
        said, request = directing.saying, without_own_places(with_own(plan.request, plan.folder), plan.folder)
        files = await said.files(request)
        if not is_kept:
            said.check_guides(files)
        kept = (MIXED, TARGET) if is_kept else (MIXED,)  # planning would make another target
        files |= {file: path.read_bytes() for file in kept if (path := plan.folder / file).is_file()}
        painted = painted_of(plan.folder / "painting.json") if photograph else frozenset()
        under = self.gallery.path(photograph) if photograph else None
        done = "planned again" if under is None else _OVER
        before = None
        if weights is not None:
            before, request = weights_of(request), replace(request, options=replace(request.options, weights=weights))
        if unseen := said.unseen(files):
            done += f" without {' and '.join(f'“{each}”' for each in unseen)}, of which nothing is seen on the picture"
        strokes, hands = await directing.changes(), self.styles.titles()
        if is_kept and not strokes.left:
            raise InputError(f"no stroke of {plan.title} is left; draw one, or undo, before it is kept as a version")
        changes = version_in_words(strokes, said.at_first, said.now, hands, "kept as it is" if is_kept else done)
        written = await directing.write(now := self.folder.incoming())
        title = version_title(plan.title, [title_of(each.folder) for each in self.plans.plans.values()])
        around = Around(now, written.frame, files, changes, is_kept, under, painted, before, written.strokes)
        return self.plans.add(request, title, around)

    def throw_picture_away(self, name: str) -> Path:
        """Move a picture into the trash, while plans that are made from it keep it; return its place there.

        Raises InputError while something is made from it, and OutputError where it cannot be kept or moved.
        """
        picture = self.gallery.path(name)
        if self.run.state.is_on and self.run.state.options.picture == picture:
            raise InputError(
                f"{self.run.title} is planned again by that picture after each look; stop the machine first"
            )
        self.plans.part_with(picture)
        return self.gallery.throw_away(name)

    def stop(self) -> str:
        """Stop every machine at once and lift its pen; return what was stopped, for people."""
        in_hand = self.by_hand.stop()
        return self.run.stop() if self.run.is_busy or not in_hand else in_hand

    async def close(self) -> None:
        """Stop the machine, write what is unsaved, and end all processes."""
        await asyncio.gather(self.by_hand.close(), self.run.close())
        self.settings.write()
        await self.drawing.close()
        await asyncio.to_thread(self.plans.close)
        self.desk.close()
