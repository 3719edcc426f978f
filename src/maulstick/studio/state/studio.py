"""What all pages show: one studio, however many look at it."""

import asyncio
from typing import final

from maulstick.studio.state.drawing import Drawing
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.gallery import Gallery
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.state.plans import Plans
from maulstick.studio.state.run import Run
from maulstick.studio.state.styles import Styles
from maulstick.studio.state.surveys import Surveys
from maulstick.studio.workers.desk import Desk


@final
class Studio:
    """Made in the server's event loop.

    drawing: the hand that is being drawn.  styles: those there are.  gallery: pictures to paint.
    plans: those there are, and those being made.
    mixing: which paints are mixed.  surveys: those there are.  run: the machine, if it paints.
    """

    def __init__(self, folder: Folder) -> None:
        self.folder, self.desk = folder, Desk()
        self.drawing = Drawing(folder, self.desk)
        self.styles = Styles(folder, self.desk)
        self.gallery = Gallery(folder, self.desk)
        self.plans = Plans(folder)
        self.mixing = Mixing(folder, self.desk)
        self.surveys = Surveys(folder, self.desk)
        self.run = Run(folder, self.desk, self.mixing)

    async def close(self) -> None:
        """Stop whatever moves, and let the rest keep what it has."""
        await self.run.close()
        await self.drawing.close()
        await asyncio.to_thread(self.plans.close)
        self.desk.close()
