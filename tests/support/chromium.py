"""Chromium, which pages are opened in: its headless shell where there is one, since that takes a third less time."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, sync_playwright

_PROGRAMS = ("chromium-headless-shell", "chromium")


@contextmanager
def chromium(*options: str) -> Iterator[Browser]:
    """Run a browser until the block ends; the test is skipped where none is installed."""
    program = next((path for name in _PROGRAMS if (path := shutil.which(name))), None)
    if program is None:
        pytest.skip("Chromium is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu", *options])
        yield browser
        browser.close()
