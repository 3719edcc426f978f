"""Comparison of some styles: how much and in what their strokes differ, and all of them on one map."""

from collections.abc import Sequence
from dataclasses import replace

from nicegui import html, ui

from maulstick.studio.panels.styles.map import StrokeMap
from maulstick.studio.panels.styles.shown import AS_TURNED, address_of, shown_later
from maulstick.studio.state.studio import Studio
from maulstick.studio.workers.style_work import Difference, Map


def show_compared(studio: Studio, names: Sequence[str]) -> ui.element:
    """Build the comparison; return the element to focus."""
    styles = studio.styles
    back = (
        ui.button("All hands", icon="arrow_back", on_click=lambda: ui.navigate.to(address_of([])))
        .props("flat")
        .classes("back")
    )
    titles = studio.styles.titles()
    named = [titles.get(name, name) for name in names]
    html.h1(f"{', '.join(named[:-1])} and {named[-1]}")

    def show_differences(found: Sequence[Difference]) -> None:
        _differences([replace(each, first=titles[each.first], second=titles[each.second]) for each in found])

    def show_map(found: Map) -> StrokeMap:
        return StrokeMap(replace(found, names=tuple(named)))

    with ui.element().classes("halves"):
        with html.section().classes("sheet"):
            html.h2("How different they are")
            shown_later("Comparing their strokes …", lambda: styles.differences_of(names), show_differences)
        with html.section().classes("sheet"):
            html.h2("All their strokes, sorted by likeness")
            html.p(AS_TURNED).classes("hint")
            shown_later("Finding out which strokes are alike …", lambda: styles.map_of(names), show_map)
    return back


def _differences(differences: Sequence[Difference]) -> None:
    html.p(
        "0: they could be one person's. 1: as different as two people usually are. "
        "More: strokes of another kind altogether."
    ).classes("hint")
    _table(differences)
    with html.ul().classes("words"):
        for each in differences:
            html.li(_sentence(each))


def _table(differences: Sequence[Difference]) -> None:
    between = {(each.first, each.second): each.distance for each in differences}
    names = list(dict.fromkeys(name for pair in between for name in pair))
    with ui.element().classes("scrolled"), html.table().classes("distances"):
        with html.thead(), html.tr():
            html.td()
            for name in names:
                html.th(name).props('scope="col"')
        with html.tbody():
            for row in names:
                with html.tr():
                    html.th(row).props('scope="row"')
                    for column in names:
                        known = between.get((row, column), between.get((column, row)))
                        html.td("" if known is None else f"{known:.1f}").classes("figure")


def _sentence(each: Difference) -> str:
    if each.shared == 1:
        return f"{each.first} and {each.second} were learned from the same strokes."
    part = " Some strokes belong to both." if each.shared else ""
    told = f"Of 100 strokes, {100 * each.accuracy:.0f} give away whose they are; by chance it would be 50."
    return f"Beside {each.first}, the strokes of {each.second} {each.words}. {told}{part}"
