"""Loads of a studio's panels, each with its socket, and what stays of them once they are closed, as JSON.

    python -m tests.support.studio.page_loads FOLDER LOADS

clients, subscriptions: numbers of pages in memory, and of what they follow, before and after the loads.
kept: bytes that Python has more, per load.  grown: MiB that the process takes more.
"""

import asyncio
import gc
import json
import sys
import time
import tracemalloc
from pathlib import Path

import uvicorn
from nicegui import Client, Event, core

from maulstick.studio.panels.tablet import Door
from maulstick.studio.server.gate import Gate
from maulstick.studio.server.patience import TimelyProtocol
from maulstick.studio.server.server import _app
from maulstick.studio.state.folder import Folder
from maulstick.survey.serve import listening
from tests.support.studio.intruder import Intruder

PANELS = ("/", "/styles", "/plan", "/paints", "/paint", "/survey", "/trash")
_TOKEN = "t"
_ROUNDS_BEFORE = 2  # of all panels: what is loaded once, and then kept, is there before anything is counted
_MIB = 1 << 20
_PATIENCE = 30.0  # seconds, for a desk that starts on a busy machine


async def _load(visitor: Intruder, loads: int) -> None:
    """Open panels in turn, each for as long as its socket takes to be known, and wait until all are gone."""

    def open_panels() -> None:
        for number in range(loads):
            with visitor.tab(PANELS[number % len(PANELS)]):
                pass

    await asyncio.to_thread(open_panels)
    until = time.monotonic() + _PATIENCE
    while _alive() and time.monotonic() < until:  # the desk may still work for a page
        await asyncio.sleep(0.2)


def _alive() -> int:
    """Return the number of pages that memory holds, known to the server or not."""
    gc.collect()
    return sum(type(thing) is Client for thing in gc.get_objects())


def _state() -> tuple[int, int, int, float]:
    """Return the numbers of pages and subscriptions, the bytes that Python has, and MiB of the process."""
    alive = _alive()
    subscriptions = sum(len(event.callbacks) for event in Event.instances)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return alive, subscriptions, tracemalloc.get_traced_memory()[0], 4096 * pages / _MIB


async def _measured(root: Path, loads: int) -> dict[str, object]:
    with Folder.opened(root) as folder, listening("127.0.0.1", 0) as at:
        app = Gate(_app(folder, Door("", is_local=True), browse=False), _TOKEN, is_local=True)
        core.app.config.reconnect_timeout = 0.0  # a closed page is gone at once
        server = uvicorn.Server(uvicorn.Config(app, http=TimelyProtocol, log_level="error"))
        serving = asyncio.create_task(server.serve(sockets=[at]))
        port = at.getsockname()[1]
        visitor = Intruder(port, f"Cookie: maulstick-{port}={_TOKEN}")
        await _load(visitor, _ROUNDS_BEFORE * len(PANELS))
        tracemalloc.start()  # now, since it slows all down
        before = _state()
        await _load(visitor, loads)
        after = _state()
        server.should_exit = True
        await serving
    return {
        "loads": loads,
        "clients": [before[0], after[0]],
        "subscriptions": [before[1], after[1]],
        "kept": (after[2] - before[2]) / loads,
        "grown": round(after[3] - before[3], 1),
    }


if __name__ == "__main__":
    print(json.dumps(asyncio.run(_measured(Path(sys.argv[1]), int(sys.argv[2])))), flush=True)
