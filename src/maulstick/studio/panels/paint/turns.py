"""Order of the pens or paints of a run, and how long each of them draws."""

from nicegui import html, ui

from maulstick.jobs.paint.estimate import Estimate
from maulstick.jobs.paint.turns import Turn, in_minutes
from maulstick.studio.workers.planned_paints import display_name


class TurnList:
    """List of the turns of an estimate, hidden where there is only one."""

    def __init__(self) -> None:
        with html.section().classes("turns") as self.root:
            html.h2("In this order")
            self._list = html.ol()
        self._shown: tuple[Turn, ...] = ()

    def show(self, estimate: Estimate | None) -> None:
        """Show the turns of an estimate, or none."""
        turns = () if estimate is None else estimate.turns
        self.root.visible = len(turns) > 1
        if turns == self._shown:
            return
        self._shown = turns
        self._list.clear()
        brushes = {turn.paint.brush for turn in turns}
        with self._list:
            for turn in turns:
                with html.li():
                    html.span().classes("dab").style(f"background: {turn.paint.hex}").props("aria-hidden=true")
                    brush = "" if len(brushes) == 1 else f", {turn.paint.brush}"
                    ui.label(f"{display_name(turn.paint, turn.index)}{brush}: {in_minutes(turn.seconds)}")
