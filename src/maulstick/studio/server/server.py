"""Server of the studio: one page, its pictures, the survey, and a gate in front of all of them."""

import asyncio
import logging
import resource
import sys
import webbrowser
from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager, suppress
from pathlib import Path
from types import FrameType

import nicegui
import uvicorn
from fastapi import FastAPI
from nicegui import ui

from maulstick.errors import MaulstickError
from maulstick.studio.panels.frame import page
from maulstick.studio.panels.tablet import Door
from maulstick.studio.server.gate import Gate
from maulstick.studio.server.link import is_loopback, kept_token, link_to, page_that_leads_to
from maulstick.studio.server.packed import KeptGZip
from maulstick.studio.server.patience import TimelyProtocol
from maulstick.studio.server.routes import routes
from maulstick.studio.server.survey_pages import survey_pages
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.file_chooser import uploads
from maulstick.studio.workers.kept import SETTLED
from maulstick.survey.serve import listening

_GRACE = 3  # seconds for pages to close
_FAVICON = Path(__file__).with_name("favicon.svg")


class _PatientServer(uvicorn.Server):
    """Server that closes once: a second Ctrl-C does not take the studio from a machine that lifts its pen."""

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Begin to close, at the first signal."""
        if not self.should_exit:
            super().handle_exit(sig, frame)


def serve(root: Path, host: str, port: int, browse: bool) -> None:
    """Serve the studio of this folder until Ctrl-C.

    host: an address of this machine; unless it is the loopback, others come in by the link too.
    browse: open a browser, too.
    Raises InputError where the port or the folder is in use, and OutputError where the folder cannot be written.
    """
    is_local = is_loopback(host)
    with Folder.opened(root) as folder, listening(host, port) as at:
        token = kept_token(folder.root)
        door = Door(link_to(host, at.getsockname()[1], token), is_local)
        app = Gate(_app(folder, door, browse), token, is_local=is_local)
        server = _PatientServer(
            uvicorn.Config(
                app,
                http=TimelyProtocol,
                log_level="error",
                timeout_graceful_shutdown=_GRACE,
                server_header=False,
            )
        )
        _raise_limit_of_files()
        server.run(sockets=[at])


def _app(folder: Folder, door: Door, browse: bool) -> FastAPI:
    @asynccontextmanager
    async def open_studio(app: FastAPI) -> AsyncIterator[None]:
        app.state.studio = studio = Studio(folder)
        _announce(folder.root, door)
        with ExitStack() as kept:
            if browse:
                leading = kept.enter_context(page_that_leads_to(door.link, folder.root))
                await asyncio.to_thread(webbrowser.open, leading)
            warming = asyncio.create_task(_warm(studio))
            try:
                yield
            finally:
                warming.cancel()
                if studio.run.doing or studio.plans.doing or studio.by_hand.doing:
                    print(
                        "The studio closes: a machine lifts its pen, and plans keep what they have; wait.", flush=True
                    )
                await studio.close()

    app = FastAPI(lifespan=open_studio, openapi_url=None)
    app.include_router(routes)
    app.include_router(uploads)
    app.mount("/survey", survey_pages())
    nicegui.run.process_pool_start_method = "spawn"
    nicegui.app.config.quasar_config["loadingBar"]["skipHijack"] = True  # a bar without a name, at each upload
    logging.getLogger("nicegui").addFilter(_is_for_the_terminal)
    ui.run_with(
        app,
        root=lambda: page(app.state.studio, door),
        title="Maulstick",
        favicon=_FAVICON,
        dark=None,
        language="en-GB",
        tailwind=False,
        show_welcome_message=False,
        reconnect_timeout=30,
        gzip_middleware_factory=KeptGZip,  # type: ignore[arg-type]  # it is called with the app alone
    )
    return app


def _announce(root: Path, door: Door) -> None:
    """Print the link, and on a terminal a picture of it that a tablet's camera reads, where that can come in."""
    print(f"The studio of {root} is open; Ctrl-C closes it.\n{door.link}", flush=True)
    if sys.stdout.isatty() and not door.is_local:
        import segno

        segno.make(door.link, micro=False).terminal(compact=True)
        print("A tablet in the same network comes in if you point its camera at this.", flush=True)


async def _warm(studio: Studio) -> None:
    """Warm up the desk, once the first page has loaded."""
    await asyncio.sleep(SETTLED)
    with suppress(MaulstickError):
        await studio.desk.warm_up()


def _is_for_the_terminal(record: logging.LogRecord) -> bool:
    """Whether the terminal shows the record: a person's mistake is shown on their page alone, slowness nowhere."""
    is_mistake = record.exc_info and isinstance(record.exc_info[1], MaulstickError)
    return record.levelno >= logging.ERROR and not is_mistake


def _raise_limit_of_files() -> None:
    """Let the process have as many open files as it may, so that there are some left for whoever presses STOP."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    with suppress(ValueError, OSError):  # a system that says it knows no limit may have one
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
