"""Style of SVG elements: presentation attributes, the rules of style sheets, and style attributes."""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Self
from xml.etree.ElementTree import Element

from maulstick.drawing.css import READ
from maulstick.recording.files.markup import local_name

_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_BRACE = re.compile(r"([^{}]*)([{}])")
_LINK = re.compile(r"\s*(>)\s*|\s+")
_COMPOUND = re.compile(r"(?=.)(\*|[\w-]*)((?:[.#][\w-]+)*)")  # tag, .class, #id, tag.class.class#id
_NAME = re.compile(r"[.#][\w-]+")
_TAG = re.compile(r"(?<![.#\w-])[\w-]+")


@dataclass(frozen=True, eq=False)
class _Selector:
    """Selector of the kinds that are read, such as ``g.axis > path``.

    tag: of the element, ``*`` for any.  names: of its classes and its id, with their ``.`` and ``#``.
    around: selector of an element around it, or, where of_parent, of its parent; None where they may be any.
    """

    tag: str
    names: frozenset[str]
    around: "_Selector | None"
    of_parent: bool

    @classmethod
    def of(cls, text: str) -> Self | None:
        """Return the selector that a text is, or None where it is of another kind."""
        found = None
        parts = _LINK.split(text)
        for link, part in zip([None, *parts[1::2]], parts[::2], strict=True):
            match = _COMPOUND.fullmatch(part)
            if match is None:
                return None
            found = cls(match[1] or "*", frozenset(_NAME.findall(match[2])), found, link == ">")
        return found


class _Rule(NamedTuple):
    """Rule of a style sheet; weight: numbers of ids, classes and tags, and of the rules before it."""

    weight: tuple[int, int, int, int]
    selector: _Selector
    declared: dict[str, str]


class StyleSheet:
    """Rules of all style sheets in a document.

    unread: the first selector that is of no kind that is read, None where all are.
    """

    def __init__(self, root: Element) -> None:
        self.unread: str | None = None
        self._parents = {child: parent for parent in root.iter() for child in parent}
        self._within: dict[tuple[_Selector, Element], bool] = {}
        self._rules: defaultdict[str, list[_Rule]] = defaultdict(list)  # by a name that their elements have
        self._count = 0
        for element in root.iter():
            if isinstance(element.tag, str) and local_name(element) == "style" and _on_screen(element.get("media", "")):
                for selectors, body in _rules(_COMMENT.sub("", element.text or "")):
                    self._add(selectors, _declared(body))

    def of(self, element: Element) -> dict[str, str]:
        """Return the properties that an element itself has, by name."""
        given = {name: value for name in READ if (value := element.get(name)) is not None}
        if self._rules:
            keys = {"*", local_name(element), *_names(element)}
            found = [rule for key in keys for rule in self._rules.get(key, ()) if self._is_of(rule.selector, element)]
            for rule in sorted(found, key=lambda rule: rule.weight):
                given |= rule.declared
        if (style := element.get("style")) is not None:
            given |= _declared(style)
        return {name: value for name, value in given.items() if value != "inherit"}

    def _add(self, selectors: str, declared: dict[str, str]) -> None:
        for text in (" ".join(each.split()) for each in selectors.split(",")):
            selector = _Selector.of(text)
            if selector is not None:
                weight = text.count("#"), text.count("."), len(_TAG.findall(text)), self._count
                self._rules[min(selector.names, default=selector.tag)].append(_Rule(weight, selector, declared))
                self._count += 1
            elif self.unread is None and declared.keys() & {*READ}:
                self.unread = text

    def _is_of(self, selector: _Selector, element: Element) -> bool:
        """Return whether a selector is of an element."""
        if selector.tag not in ("*", local_name(element)) or not selector.names <= _names(element):
            return False
        if selector.around is None:
            return True
        parent = self._parents.get(element)
        is_there = self._is_of if selector.of_parent else self._is_around
        return parent is not None and is_there(selector.around, parent)

    def _is_around(self, selector: _Selector, element: Element) -> bool:
        """Return whether a selector is of an element or of one around that; found once, however many lie in it."""
        key = selector, element
        if key not in self._within:
            parent = self._parents.get(element)
            around = parent is not None and self._is_around(selector, parent)
            self._within[key] = around or self._is_of(selector, element)
        return self._within[key]


def _names(element: Element) -> set[str]:
    """Return the classes and the id of an element, as selectors name them."""
    return {*(f".{name}" for name in element.get("class", "").split()), f"#{element.get('id', '')}"}


def _rules(text: str) -> Iterator[tuple[str, str]]:
    """Yield the selectors and the declarations of rules, of those in at-rules only what is for every screen."""
    heads: list[str] = []
    for before, brace in _BRACE.findall(text):
        if brace == "{":
            heads.append(before.rpartition(";")[2].strip())  # an @import, which has no block, ends in a semicolon
        elif heads:
            head = heads.pop()
            if not head.startswith("@") and all(_on_screen(each.removeprefix("@media")) for each in heads):
                yield head, before


def _on_screen(media: str) -> bool:
    """Return whether a list of media has every screen in it."""
    return any(each.strip() in ("", "all", "screen", "only screen") for each in media.lower().split(","))


def _declared(text: str) -> dict[str, str]:
    pairs = (each.partition(":") for each in text.split(";"))
    return {name.strip().lower(): value.replace("!important", "").strip() for name, _, value in pairs if value}
