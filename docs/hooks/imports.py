"""The imports between rooms as a picture on the page of rooms, made out of the code when the site is built."""

import tomllib
from collections import Counter
from html import escape

import grimp
from elsewhere import ROOT
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- imports -->"
CELL, LABEL = 26, 92
"""Sizes in the SVG's units: of a square, and of the names beside them."""


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put the picture where the page has its mark."""
    return markdown.replace(MARK, drawn(rooms(), imports())) if MARK in markdown else markdown


def rooms() -> list[str]:
    """Return all rooms, highest first, in the order that the import-linter checks."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [room.strip() for layer in layers for room in layer.split("|")]


def imports() -> Counter[tuple[str, str]]:
    """Count the modules that a module imports from another room, as (room that imports, room imported)."""
    graph = grimp.build_graph("maulstick", cache_dir=None)
    counts = Counter[tuple[str, str]]()
    for module in graph.modules:
        for imported in graph.find_modules_directly_imported_by(module):
            by, of = (name.split(".")[1:2] for name in (module, imported))
            if by and of and by != of:
                counts[by[0], of[0]] += 1
    return counts


def drawn(names: list[str], counts: Counter[tuple[str, str]]) -> str:
    """Return an SVG with a row and a column per room, and in a square how often the row's room imports the column's."""
    side, most = LABEL + CELL * len(names), max(counts.values())
    place = {name: LABEL + CELL * number for number, name in enumerate(names)}
    middle = CELL / 2
    parts = [f'<figure class="imports"><svg viewBox="0 0 {side + CELL} {side}" role="img" aria-label="Imports">']
    for name, at in place.items():
        parts += [
            f'<text x="{LABEL - 6}" y="{at + middle}" text-anchor="end">{escape(name)}</text>',
            f'<text transform="translate({at + middle} {LABEL - 6}) rotate(-60)">{escape(name)}</text>',
            f'<rect class="self" x="{at}" y="{at}" width="{CELL}" height="{CELL}"/>',
        ]
    for (by, of), count in sorted(counts.items()):
        x, y, strength = place[of], place[by], 0.12 + 0.7 * (count / most) ** 0.5
        parts += [
            f'<rect x="{x}" y="{y}" width="{CELL}" height="{CELL}" fill-opacity="{strength:.2f}">'
            f"<title>{by} imports {of}: {count}</title></rect>",
            f'<text class="count" x="{x + middle}" y="{y + middle}">{count}</text>',
        ]
    return "".join([*parts, "</svg></figure>"])
