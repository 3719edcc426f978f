"""Refreshing of what is on a page after changes of the studio's state, the focus of what is new, and pictures in it."""

import base64
from collections.abc import Callable

from nicegui import Event
from nicegui.element import Element


def shown_by(root: Element, event: Event[[]], refresh: Callable[[], object]) -> None:
    """Call `refresh` now and at every such event, until the element `root` leaves its page, or the page is closed."""
    delete = root._handle_delete

    def again() -> None:
        if not root.is_deleted:  # by another refresh at the same event
            refresh()

    def handle_delete() -> None:
        event.unsubscribe(again)  # which would hold on to all panels that pages ever showed
        delete()

    root._handle_delete = handle_delete  # type: ignore[method-assign]
    event.subscribe(again, unsubscribe_on_delete=False)
    refresh()


def focus(element: Element) -> None:
    """Give a new element the focus once it is shown: the element that had it is gone."""
    element.on("vnodeMounted", js_handler="(node) => node.el.focus()")


def as_source(jpeg: bytes) -> str:
    """Return a JPEG as the source of an image on the page."""
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg).decode()}"
