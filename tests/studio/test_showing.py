import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from nicegui import Client, Event, core, ui

from maulstick.studio.widgets.showing import shown_by


@contextmanager
def loaded() -> Iterator[Client]:
    """A page that a browser has loaded, until it is closed."""
    client = Client(ui.page(""), request=None)
    with client:
        yield client
    client.delete()


def in_a_loop(act: Callable[[], None]) -> None:
    async def run() -> None:
        core.loop = asyncio.get_running_loop()
        act()

    asyncio.run(run())


def test_a_thousand_pages_that_were_closed_leave_no_subscription() -> None:
    def load() -> None:
        event = Event[[]]()
        for _ in range(1000):
            with loaded():
                shown_by(ui.label(), event, lambda: None)
        assert event.callbacks == []

    in_a_loop(load)


def test_what_left_its_page_is_not_refreshed_and_what_stays_is() -> None:
    def load() -> None:
        event, shown = Event[[]](), list[str]()
        with loaded():
            left, stays = ui.label(), ui.label()
            shown_by(left, event, lambda: shown.append("left"))
            shown_by(stays, event, lambda: shown.append("stays"))
            left.delete()
            assert len(event.callbacks) == 1
            event.emit()
        assert shown == ["left", "stays", "stays"]
        assert event.callbacks == []

    in_a_loop(load)
