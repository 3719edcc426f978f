"""Tables of a survey's results (paper: the confusion matrix, and the table of opinions)."""

from nicegui import html

from maulstick.survey.results import Matching, Rows, matching_rows


def confusion_table(matching: Matching) -> None:
    """Show the confusion matrix; the larger a share, the darker its cell."""
    rows = matching_rows(matching)
    shades = [["" if share != share else f"--share: {share:.3f}" for share in row] for row in matching.shares.tolist()]
    _table("For whose hand they were taken", rows, shades)


def right_table(right: Rows) -> None:
    """Show how often the right hand was found."""
    _table("How often the right hand was found", right, None)


def opinions_table(opinions: Rows) -> None:
    """Show which look people chose."""
    _table("Which look they chose", opinions, None)


def _table(caption: str, rows: Rows, shades: list[list[str]] | None) -> None:
    region = html.div().classes("scrolled").props(f'tabindex=0 role="region" aria-label="{caption}"')
    with region, html.table().classes("told figure"):
        html.caption(caption)
        with html.thead(), html.tr():
            for head in rows.heads:
                html.th(head).props("scope=col")
        with html.tbody():
            for number, (name, *cells) in enumerate(rows.rows):
                with html.tr():
                    html.th(name).props("scope=row")
                    for column, cell in enumerate(cells):
                        shown = html.td(cell)
                        if shades is not None:
                            shown.classes("shade").style(shades[number][column])
