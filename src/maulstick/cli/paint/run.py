"""Painting from a terminal."""

from collections.abc import Collection
from dataclasses import dataclass

from rich.console import Console

from maulstick.cli.paint.operator import TerminalOperator, confirm, in_words
from maulstick.jobs.paint import session
from maulstick.jobs.paint.request import PaintRequest
from maulstick.jobs.paint.setup import PaintSetup


@dataclass(frozen=True)
class Run:
    """A request, and how to carry it out.

    dry_run: only print what would be painted.
    unfinished: whether the stroke that was under the brush is painted, where that is known.
    """

    request: PaintRequest
    dry_run: bool
    unfinished: bool | None


def run(run: Run) -> None:
    """Paint, go on painting, or print what would be painted."""
    console = Console(stderr=True, markup=False, highlight=False)
    if run.dry_run:
        estimate = session.rehearse(run.request)
        for sentence in (*(f"note: {note}" for note in estimate.notes), in_words(estimate)):
            console.print(sentence, soft_wrap=True)
        return

    def is_painted(number: int) -> bool:
        question = f"stroke {number} was under the brush when the run ended. Is it on the paper?"
        if run.unfinished is None:
            return confirm(console, question, "add --unfinished painted, or --unfinished again")
        return run.unfinished

    def operator_for(setup: PaintSetup, painted: Collection[int]) -> TerminalOperator:
        what_next = f"maulstick paint {run.request.painting} --resume goes on"
        return TerminalOperator(console, setup.plan, setup.robot, len(painted), what_next)

    session.paint(run.request, is_painted, operator_for)
