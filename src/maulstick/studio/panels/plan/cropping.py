"""Frame over a picture around what is kept of it: its edges and corners are dragged, or moved by arrow keys."""

from collections.abc import Callable
from math import isfinite
from typing import final

from nicegui import events
from nicegui.element import Element

from maulstick.painting.edit import WHOLE, Crop

_THROTTLE = 0.1  # seconds between two crops while somebody drags


@final
class CropFrame(Element, component="crop.js"):
    """Frame over a picture. cropped: called with each crop that a person makes, while they drag, too."""

    def __init__(self, cropped: Callable[[Crop], object]) -> None:
        super().__init__()
        self._cropped = cropped
        self._props.update(source="", crop=list(WHOLE), ratio=0.0)
        self.on("dragged", self._take, throttle=_THROTTLE)
        self.on("laid", self._take)  # at once, before whatever is done next

    def show(self, source: str, ratio: float) -> None:
        """Show the picture at an address.

        ratio: of width to height, in shares of the picture, that the frame has while it is dragged; 0 for any.
        """
        with self._props.suspend_updates():
            self._props.update(source=source, ratio=ratio)
        self.update()

    def lay(self, crop: Crop) -> None:
        """Lay the frame elsewhere, unless a person is dragging it."""
        self._remember(crop)
        self.run_method("lay", list(crop))

    def _take(self, event: events.GenericEventArguments) -> None:
        crop = crop_of(event.args)
        if crop is not None and list(crop) != self._props["crop"]:
            self._remember(crop)
            self._cropped(crop)

    def _remember(self, crop: Crop) -> None:
        """Keep the crop for when the frame is made again; sending it now could undo what is dragged meanwhile."""
        with self._props.suspend_updates():
            self._props["crop"] = list(crop)


def crop_of(sent: object) -> Crop | None:
    """Return the crop that a browser sent, or None where it is none."""
    if not isinstance(sent, list) or len(sent) != 4:
        return None
    numbers = [float(each) for each in sent if isinstance(each, int | float) and isfinite(each)]
    if len(numbers) != 4:
        return None
    left, top, right, bottom = numbers
    return (left, top, right, bottom) if 0 <= left < right <= 1 and 0 <= top < bottom <= 1 else None


def shaped(crop: Crop, ratio: float) -> Crop:
    """Return the largest crop inside one, about its middle, of this ratio of width to height in shares of a picture."""
    left, top, right, bottom = crop
    wide = min(right - left, (bottom - top) * ratio)
    beside, above = (right - left - wide) / 2, (bottom - top - wide / ratio) / 2
    edges = (left + beside, top + above, right - beside, bottom - above)
    first, second, third, last = (round(edge, 4) for edge in edges)
    return first, second, third, last
