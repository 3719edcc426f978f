"""Title of the page's tab: what waits for a person, how far the work is, or the panel's name."""

from textwrap import shorten

from nicegui import ui

from maulstick.studio.state.plan import Phase
from maulstick.studio.state.studio import Studio

_PERIOD = 1.0  # seconds between two looks at the progress
_LONGEST = 40  # letters of a request; a tab shows fewer


class TabTitle:
    """Title that follows the work while a person is at another tab."""

    def __init__(self, studio: Studio) -> None:
        self._studio, self._panel, self._shown = studio, "", ""
        ui.timer(_PERIOD, self._show)

    def turn_to(self, panel: str) -> None:
        """Show the panel of that name wherever nothing is going on."""
        self._panel, self._shown = panel, ""
        self._show()

    def _show(self) -> None:
        news = news_of(self._studio) or self._panel
        title = f"{news} · Maulstick" if news else "Maulstick"
        if title != self._shown:
            self._shown = title
            ui.page_title(title)


def news_of(studio: Studio) -> str:
    """Return what a machine asks for, else how far it or the first plan is; "" where nothing is going on."""
    state = studio.run.state
    if state.question:
        return shorten(state.question[0].upper() + state.question[1:], _LONGEST, placeholder=" …")
    if state.is_on:
        progress = state.progress
        return f"{0.0 if progress is None else progress.drawn / (progress.metres or 1.0):.0%} {studio.run.title}"
    busy = [plan for plan in studio.plans.plans.values() if plan.phase in (Phase.PLANNING, Phase.STOPPING)]
    return f"{busy[0].done:.0%} {busy[0].title}" if busy else ""
