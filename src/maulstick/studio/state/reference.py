"""Picture to look at while a hand is drawn: on all pages, and never in what is drawn."""

from dataclasses import dataclass, replace
from typing import final

from nicegui import Event


@dataclass(frozen=True)
class Look:
    """Look of the picture. name: of it in the gallery, None for none.  is_under: under the sheet, and not beside it.

    strength: of one under the sheet, from 0, where nothing of it is seen, to 1.
    """

    name: str | None = None
    is_under: bool = True
    strength: float = 0.4


@final
class Reference:
    """Reference picture of the sheet that is drawn on. changed: emitted after its look has changed."""

    def __init__(self) -> None:
        self.changed = Event[[]]()
        self.look = Look()

    def show(self, name: str | None) -> None:
        """Show the picture of that name, or none."""
        self._take(replace(self.look, name=name))

    def place(self, *, under: bool) -> None:
        """Lay the picture under the sheet, or beside it."""
        self._take(replace(self.look, is_under=under))

    def fade(self, strength: float) -> None:
        """Show the picture so strongly."""
        self._take(replace(self.look, strength=min(max(strength, 0.0), 1.0)))

    def _take(self, look: Look) -> None:
        if look != self.look:
            self.look = look
            self.changed.emit()
