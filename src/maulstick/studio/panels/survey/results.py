"""The tables of a survey's results (paper: the confusion matrix, and the table of opinions)."""

from nicegui import html

from maulstick.survey.results import Matching, Rows, matching_rows


def taken_table(matching: Matching) -> None:
    """For whose strokes they were taken: the confusion matrix, the darker the more."""
    told = matching_rows(matching)
    shades = [["" if share != share else f"--share: {share:.3f}" for share in row] for row in matching.shares.tolist()]
    _table("For whose strokes they were taken", told, shades)


def right_table(right: Rows) -> None:
    """How often the right hand was found."""
    _table("How often the right hand was found", right, None)


def opinions_table(opinions: Rows) -> None:
    """What people prefer."""
    _table("Which look they chose", opinions, None)


def _table(caption: str, told: Rows, shades: list[list[str]] | None) -> None:
    region = html.div().classes("scrolled").props(f'tabindex=0 role="region" aria-label="{caption}"')
    with region, html.table().classes("told figure"):
        html.caption(caption)
        with html.thead(), html.tr():
            for head in told.heads:
                html.th(head).props("scope=col")
        with html.tbody():
            for number, (name, *cells) in enumerate(told.rows):
                with html.tr():
                    html.th(name).props("scope=row")
                    for column, cell in enumerate(cells):
                        shown = html.td(cell)
                        if shades is not None:
                            shown.classes("shade").style(shades[number][column])
