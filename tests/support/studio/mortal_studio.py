"""Studio without a page, to be killed: python -m tests.support.studio.mortal_studio ROOT PLAN MACHINE EASEL."""

import asyncio
import sys
from pathlib import Path

from maulstick.jobs.paint.options import PaintOptions
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.mixing import Mixing
from maulstick.studio.state.plans import Plans
from maulstick.studio.state.run import Run
from maulstick.studio.workers.desk import Desk


async def paint(root: Path, plan: str, machine: str, easel: Path) -> None:
    """Print the id of the painting process once it has painted two strokes, and wait for the end."""
    with Folder.opened(root) as folder:
        desk = Desk()
        run = Run(folder, desk, Mixing(folder, desk), Plans(folder))
        await run.begin(plan, PaintOptions(robot=machine, easel=easel))
        while run.state.progress is None or run.state.progress.stroke < 3:
            run.done(run.state.question_number)
            await asyncio.sleep(0.02)
        assert run._process is not None
        print(run._process._process.pid, flush=True)
        await asyncio.sleep(60)


if __name__ == "__main__":
    asyncio.run(paint(Path(sys.argv[1]), sys.argv[2], sys.argv[3], Path(sys.argv[4])))
