"""Fixtures: a studio in a process of its own, as users start it, and pages of it in a real browser."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Error, Page, expect

from tests.support.chromium import chromium
from tests.support.studio.held_plans import held_plan
from tests.support.studio.warm import Warm, WarmCommand

COMMAND = Path(sys.executable).with_name("maulstick")
_PATIENCE = 60.0  # seconds, for a machine that does much else
_PATIENCE_OF_A_PAGE = 240.0  # seconds, for plans, which are made below everything else
_LONGEST = 900.0  # seconds, of a test in a browser
_OPTIONS = ("--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream")
_OF_A_DEAD_SERVER = re.compile(r"net::ERR_|WebSocket connection")


class RunningStudio:
    """Running ``maulstick studio`` on a folder and a free port.

    link: leads in, with its token.  url: the same without token and last slash.
    """

    def __init__(self, root: Path, *words: str, environment: Mapping[str, str] | None = None) -> None:
        self.folder = root / "studio"
        self.was_killed = False
        self.link = self.url = self.token = ""
        self._words, self._log, self._port = words, root / "log", "0"
        self._environment = os.environ | {"XDG_DATA_HOME": str(root / "data"), "OMP_NUM_THREADS": "1"}
        self._environment |= environment or {}
        self.start()

    def start(self) -> None:
        """Start the studio; after `kill` again, at the same address and on the same folder."""
        with self._log.open("ab") as log:
            before = log.tell()
        words = ["studio", str(self.folder), "--port", self._port, "--no-browser", *self._words]
        self._process = self._begun(words, self._log, self._environment)
        try:
            self.link, self.url, self._port, self.token = self._printed(before)
        except AssertionError:
            self.kill()  # nobody has it yet who would close it
            raise

    def _begun(self, words: Sequence[str], log: Path, environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
        with log.open("ab") as output:
            return subprocess.Popen([COMMAND, *words], stdout=output, stderr=output, env=environment)

    def _printed(self, before: int) -> tuple[str, str, str, str]:
        """Wait for the link in the output after `before` letters; return it, its address, port and token."""
        until = time.monotonic() + _PATIENCE
        while not (link := re.search(r"^(http://\S+:(\d+))/\?token=(\S+)$", self.output[before:], re.MULTILINE)):
            assert self._process.poll() is None, self.output
            assert time.monotonic() < until, "no link came"
            time.sleep(0.05)
        return link[0], link[1], link[2], link[3]

    @property
    def port(self) -> int:
        """Port that it listens at."""
        return int(self._port)

    @property
    def cookie(self) -> tuple[str, str]:
        """Name and value of the cookie that the link leaves in a browser."""
        return f"maulstick-{self._port}", self.token

    def let_in(self, context: BrowserContext) -> BrowserContext:
        """Give a browser the cookie, as if it had come by the link; return the same one."""
        name, value = self.cookie
        context.add_cookies([{"name": name, "value": value, "url": self.url, "httpOnly": True, "sameSite": "Strict"}])
        return context

    @property
    def output(self) -> str:
        """Output of both streams."""
        return self._log.read_text()

    @property
    def data(self) -> Path:
        """Folder of the user's styles."""
        return Path(self._environment["XDG_DATA_HOME"]) / "maulstick"

    def kill(self) -> None:
        """Kill the process, as a power cut would."""
        self._process.kill()
        self._process.wait()
        self.was_killed = True

    def close(self) -> None:
        """Interrupt the process, as Ctrl-C does, and wait for its end."""
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(_PATIENCE)
        finally:
            self._process.kill()
            self._process.wait()


class WarmStudio(RunningStudio):
    """The same with processes that need not load what takes seconds to load."""

    def _begun(self, words: Sequence[str], log: Path, environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
        return WarmCommand(words, log, environment)  # type: ignore[return-value]  # it has what is used here


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the test a data folder of its own, so that no other test holds a lock on its machines."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.fixture(scope="module", autouse=True)
def warm() -> Iterator[None]:
    """Let processes of the studio begin with torch loaded, which takes each of them seconds.

    Modules that test processes themselves have a fixture of this name that does nothing.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("maulstick.studio.workers.process._SPAWN", Warm())
        yield


@pytest.fixture
def held_at(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Let the plans of a `Plans` that is made later stand still at these shares, each until they are told something."""

    def hold(*shares: float) -> None:
        monkeypatch.setattr("maulstick.studio.state.plans.plan_in_process", partial(held_plan, shares))

    return hold


@pytest.fixture
def kind() -> type[RunningStudio]:
    return WarmStudio


@pytest.fixture
def studio(tmp_path: Path, kind: type[RunningStudio]) -> Iterator[RunningStudio]:
    running = kind(tmp_path)
    try:
        yield running
    finally:
        running.close()
    assert "Traceback" not in running.output, running.output


_HAS_FAILED = pytest.StashKey[bool]()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    report = yield
    item.stash[_HAS_FAILED] = item.stash.get(_HAS_FAILED, False) or report.failed
    return report


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.timeout(_LONGEST))


def patient(context: BrowserContext) -> BrowserContext:
    """Give a context time on a machine that does much else, more than Playwright's half minute; return the same one."""
    context.set_default_timeout(1e3 * _PATIENCE_OF_A_PAGE)
    return context


# While Playwright's own loop is held open, asyncio.run fails: tests with a browser have modules of their own.
@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium(*_OPTIONS) as browser:
        expect.set_options(timeout=1e3 * _PATIENCE_OF_A_PAGE)
        yield browser
        expect.set_options(timeout=None)  # it belongs to all modules


@pytest.fixture
def page(studio: RunningStudio, browser: Browser, request: pytest.FixtureRequest) -> Iterator[Callable[..., Page]]:
    """Open the studio in a new browser context: ``page("/styles", color_scheme="dark")``.

    What goes wrong in any of these pages fails the test; that a killed server cannot be reached does not. Of a test
    that fails the report tells what these pages showed, what their consoles said, and when they were loaded.
    """
    contexts: list[BrowserContext] = []
    wrong: list[str] = []
    said: list[str] = []

    def note(message: ConsoleMessage) -> None:
        said.append(message.text)
        if message.type in ("error", "warning"):
            wrong.append(message.text)

    def open_page(path: str = "/", **options: Any) -> Page:
        contexts.append(studio.let_in(patient(browser.new_context(**options))))
        opened = contexts[-1].new_page()
        opened.on("console", note)
        opened.on("framenavigated", lambda frame: said.append(f"loaded {frame.url}"))
        opened.on("pageerror", lambda error: wrong.append(str(error)))
        opened.goto(studio.url + path)
        opened.wait_for_selector(".panel h1")
        return opened

    yield open_page
    if request.node.stash[_HAS_FAILED]:
        for shown in (each for context in contexts for each in context.pages):
            with suppress(Error):  # it may have crashed
                print(f"{shown.url} showed:", shown.locator("body").aria_snapshot(timeout=1e3 * _PATIENCE), sep="\n")
        print("The pages said:", *said, sep="\n")
    for context in contexts:
        context.close()
    assert [text for text in wrong if not (studio.was_killed and _OF_A_DEAD_SERVER.search(text))] == []
