"""Docstrings as Markdown, for the page of Python: parameters as a list, examples as code.

Here a docstring says `name: what it is` in lines of its own, or several on one line with two spaces between, and its
examples begin with `>>>`. Markdown would run all of that together.
"""

import re
from typing import Any

from griffe import Extension, Object

_NAMES = r"[a-z_]\w*(?:, [a-z_]\w*)*"
_ENTRY = re.compile(rf"({_NAMES}): (?=\S)")
_NEXT_ENTRY = re.compile(rf"  (?={_NAMES}: )")
_END_OF_LIST = re.compile(r"(Returns?|Raises) ")


class Docstrings(Extension):
    """An extension of griffe that rewrites each docstring when it is read."""

    def on_instance(self, *, obj: Object, **kwargs: Any) -> None:
        """Rewrite the docstring of a module, class, function or attribute."""
        if obj.docstring is not None:
            obj.docstring.value = as_markdown(obj.docstring.value)


def as_markdown(docstring: str) -> str:
    """Return a docstring as Markdown."""
    lines: list[str] = []
    listed = False
    for line in docstring.splitlines():
        if line.lstrip().startswith((">>>", "...")) or _goes_on_with_example(lines, line):
            _add_to_example(lines, line.strip())
            continue
        _end_example(lines)
        parts = _NEXT_ENTRY.split(line) if _ENTRY.match(line) else [line]
        for part in parts:
            if found := _ENTRY.match(part):
                if not listed:
                    lines.append("")
                lines.append(f"- `{found[1].replace(', ', '`, `')}`: {part[found.end() :]}")
                listed = True
            elif listed and _END_OF_LIST.match(part):
                lines += ["", part]
                listed = False
            else:
                listed = listed and bool(part)
                lines.append(f"    {part}" if listed else part)
    _end_example(lines)
    return "\n".join(lines)


def _goes_on_with_example(lines: list[str], line: str) -> bool:
    return _in_example(lines) and bool(line.strip())


def _in_example(lines: list[str]) -> bool:
    return sum(line.startswith("```") for line in lines) % 2 == 1


def _add_to_example(lines: list[str], line: str) -> None:
    if not _in_example(lines):
        lines += ["", "```pycon"]
    lines.append(line)


def _end_example(lines: list[str]) -> None:
    if _in_example(lines):
        lines.append("```")
