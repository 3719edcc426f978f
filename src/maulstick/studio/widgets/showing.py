"""Refreshing of what is on a page after changes of the studio's state."""

from collections.abc import Callable

from nicegui import Event
from nicegui.element import Element


def shown_by(root: Element, event: Event[[]], refresh: Callable[[], object]) -> None:
    """Call `refresh` now and at every such event, for as long as the element `root` is on its page."""

    def again() -> None:
        if root.is_deleted:  # another panel took its place, or the page is gone
            event.unsubscribe(again)
        else:
            refresh()

    event.subscribe(again, unsubscribe_on_delete=False)  # else the page would hold on to all panels that it ever showed
    refresh()
