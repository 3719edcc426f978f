"""Acts on a plan, as in a studio that is opened for them."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

from maulstick.studio.state.directing import Directing
from maulstick.studio.workers.desk import Desk


def acting(root: Path, act: Callable[[Directing], Awaitable[None]]) -> Directing:
    """Open the acts on the plan `six` as a new studio does, act on them, and return them."""

    async def go() -> Directing:
        desk = Desk()
        directing = Directing(root / "plans" / "six" / "painting.json", desk)
        try:
            await act(directing)
        finally:
            desk.close()
        return directing

    return asyncio.run(go())
