"""Camera of the browser's own device, without a browser."""

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

from maulstick.errors import InputError
from maulstick.studio.widgets.webcam import _Camera


class Silent:
    """Stand-in for the page, the dialog and all in it, whose browser asks a person who does not answer."""

    id = 1

    def __init__(self, is_left: bool) -> None:
        self.is_deleted, self.is_open = is_left, False

    def open(self) -> None:
        self.is_open = True

    def close(self) -> None:
        self.is_open = False

    async def run_javascript(self, script: str, timeout: float) -> None:
        raise TimeoutError(f"JavaScript did not respond within {timeout:.1f} s")


def camera_of(page: Silent) -> _Camera:
    camera: Any = object.__new__(_Camera)
    camera.__dict__.update(dict.fromkeys(("_chooser", "_client", "_dialog", "_video"), page))
    camera._take = SimpleNamespace(enable=lambda: None)
    return camera  # type: ignore[no-any-return]


def test_a_browser_that_is_not_allowed_in_time_is_said_and_its_dialog_closed() -> None:
    page = Silent(is_left=False)
    with pytest.raises(InputError, match="did not let the page use the camera within 60 s; ask again"):
        asyncio.run(camera_of(page).see())
    assert not page.is_open


def test_nothing_is_said_of_a_camera_that_was_left_meanwhile() -> None:
    asyncio.run(camera_of(Silent(is_left=True)).see())
