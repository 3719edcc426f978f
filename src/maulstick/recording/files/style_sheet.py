"""Style of SVG elements: presentation attributes, the rules of style sheets, and style attributes."""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, Self
from xml.etree.ElementTree import Element

from maulstick.recording.files.css import GEOMETRY, INHERITED, MOVES, READ, Style, inherited
from maulstick.recording.files.markup import local_name

_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_BRACE = re.compile(r"([^{}]*)([{}])")
_BLOCK = re.compile(r"@(?:layer\b.*|supports\b(?!\s*not\b).*|media\b(.*))", re.IGNORECASE | re.DOTALL)
_SCREENS = ("", "all", "screen", "only screen", "not print")
_MARK = re.compile(r"[,()\[\]]")
_LINK = re.compile(r"\s*(>)\s*|\s+")
_COMPOUND = re.compile(r"(?=.)(\*|[\w-]*)((?:[.#][\w-]+)*)")  # tag, .class, #id, tag.class.class#id
_IN_USE = re.compile(r"::|:(?:hover|focus|active|visited|target|before|after)\b", re.IGNORECASE)
_IMPORTANT = re.compile(r"!\s*important", re.IGNORECASE)
_NAME = re.compile(r"[.#]?[\w-]+")
_TAG = re.compile(r"(?<![.#\w-])[\w-]+")
_KNOWN = MOVES | {*READ}
_BY_WORD = (_KNOWN | GEOMETRY) - {*INHERITED}  # properties that an element has from its parent only where it says so
_OF_WORDS = frozenset({"clip-rule", "display", "fill-rule", "overflow", "transform-box", "visibility"})  # of any case


@dataclass(frozen=True, eq=False)
class _Selector:
    """Selector of the kinds that are read, such as ``g.axis > path``.

    names: of the element: its tag, its classes and its id, these with their ``.`` and ``#``.
    needs: the same with the names of all that must lie around it.
    key: one of these that few have, ``*`` where there is none.
    around: selector of an element around it, or, where of_parent, of its parent; None where they may be any.
    """

    names: frozenset[str]
    needs: frozenset[str]
    key: str
    around: "_Selector | None"
    of_parent: bool

    @classmethod
    def of(cls, text: str) -> Self | None:
        """Return the selector that a text is, or None where it is of another kind."""
        found: Self | None = None
        parts = _LINK.split(text)
        for link, part in zip([None, *parts[1::2]], parts[::2], strict=True):
            if _COMPOUND.fullmatch(part) is None:
                return None
            names = frozenset(_NAME.findall(part))
            key = min(names, default="*")  # an id, else a class, else a tag
            if found is None:
                found = cls(names, names, key, None, of_parent=False)
            else:
                key = key if key[0] in "#." else found.key
                found = cls(names, names | found.needs, key, found, link == ">")
        return found


class _Declared(NamedTuple):
    """Properties that are declared, by name, and those of them that are ``!important``."""

    usual: dict[str, str]
    important: dict[str, str]


class _Rule(NamedTuple):
    """Rule of a style sheet; weight: numbers of ids, classes and tags, and of the rules before it."""

    weight: tuple[int, int, int, int]
    selector: _Selector
    declared: _Declared


class StyleSheet:
    """Rules of all style sheets in a document.

    unread: the first selector of a drawing at rest that is of no kind that is read, None where all are.
    """

    def __init__(self, root: Element) -> None:
        self.unread: str | None = None
        self._rules: defaultdict[str, list[_Rule]] = defaultdict(list)  # by their selectors' keys
        self._count = 0
        for element in root.iter():
            if isinstance(element.tag, str) and local_name(element) == "style" and _on_screen(element.get("media", "")):
                for selectors, body in _rules(_COMMENT.sub("", element.text or "")):
                    self._add(selectors, _declared(body))
        self._parents = {child: parent for parent in root.iter() for child in parent}
        self._names: dict[Element, frozenset[str]] = {}  # of those that selectors need
        self._around: dict[Element, frozenset[str]] = {root: frozenset()}  # those of all elements around one
        self._found: dict[tuple[_Selector, Element], bool] = {}
        if self._rules:
            self._survey(root)

    def of(self, element: Element) -> dict[str, str]:
        """Return the properties that an element itself has, by name."""
        said = self._said_of(element)
        for name in [name for name, value in said.items() if value.lower() == "inherit"]:
            said[name] = self._parents_own(element, name) if name in _BY_WORD else "unset"
        return {name: value for name, value in said.items() if value.lower() != "unset"}

    def _said_of(self, element: Element) -> dict[str, str]:
        """Return what is said of an element, by name, also that it inherits."""
        given = {name: value for name in READ if (value := element.get(name)) is not None}
        declared: list[_Declared] = []
        if self._rules:
            keys = {"*"} | self._names[element] | self._around[element]
            found = [rule for key in keys for rule in self._rules.get(key, ()) if self._is_of(rule.selector, element)]
            declared = [rule.declared for rule in sorted(found, key=lambda rule: rule.weight)]
        declared.append(_declared(_COMMENT.sub("", element.get("style", ""))))
        for properties in (*(each.usual for each in declared), *(each.important for each in declared)):
            given |= properties
        return {name: value.lower() if name in _OF_WORDS else value for name, value in given.items()}

    def _parents_own(self, element: Element, name: str) -> str:
        """Return the property that the nearest element around one has of its own, where all between inherit it."""
        value = "inherit"
        while value.lower() == "inherit":
            if element not in self._parents:
                return "unset"
            element = self._parents[element]
            value = self._said_of(element).get(name, "unset")
        return value

    def where_it_stands(self, element: Element) -> Style:
        """Return the style of an element by itself and all around it, and not by what refers to it."""
        line = [element]
        while line[-1] in self._parents:
            line.append(self._parents[line[-1]])
        style: Style = {}
        for each in reversed(line):
            style = inherited(style, self.of(each))
        return style

    def _add(self, selectors: str, declared: _Declared) -> None:
        for text in filter(None, (" ".join(each.split()) for each in _listed(selectors))):
            selector = _Selector.of(text)
            if selector is not None:
                weight = text.count("#"), text.count("."), len(_TAG.findall(text)), self._count
                self._rules[selector.key].append(_Rule(weight, selector, declared))
                self._count += 1
            elif self.unread is None and _is_at_rest(text) and any(each.keys() & _KNOWN for each in declared):
                self.unread = text

    def _survey(self, root: Element) -> None:
        """Note the names that each element, and those around it, have."""
        needed = {name for rules in self._rules.values() for rule in rules for name in rule.selector.needs}
        for element in root.iter():
            classes = (f".{name}" for name in element.get("class", "").split())
            names = frozenset(needed.intersection((local_name(element), f"#{element.get('id', '')}", *classes)))
            inside = self._around[element]
            if not names <= inside:  # else one set is shared by all of them
                inside |= names
            self._names[element] = names
            for child in element:
                self._around[child] = inside

    def _is_of(self, selector: _Selector, element: Element) -> bool:
        """Return whether a selector is of an element."""
        if not selector.names <= self._names[element]:
            return False
        if selector.around is None:
            return True
        if selector.of_parent:
            return element in self._parents and self._is_of(selector.around, self._parents[element])
        return self._is_around(selector.around, element)

    def _is_around(self, selector: _Selector, element: Element) -> bool:
        """Return whether a selector is of one around an element; found once for all with one parent."""
        if element not in self._parents or not selector.needs <= self._around[element]:
            return False
        parent = self._parents[element]
        key = selector, parent
        if key not in self._found:
            self._found[key] = self._is_around(selector, parent) or self._is_of(selector, parent)
        return self._found[key]


def _rules(text: str) -> Iterator[tuple[str, str]]:
    """Yield the selectors and the declarations of rules, of those in at-rules only what is for every screen."""
    heads: list[str] = []
    for before, brace in _BRACE.findall(text):
        if brace == "{":
            heads.append(before.rpartition(";")[2].strip())  # an @import, which has no block, ends in a semicolon
        elif heads:
            head = heads.pop()
            blocks = [_BLOCK.fullmatch(each) for each in heads]
            if not head.startswith("@") and all(block and _on_screen(block[1] or "") for block in blocks):
                yield head, before


def _listed(selectors: str) -> Iterator[str]:
    """Yield the selectors in a list; a comma in parentheses parts none."""
    start = depth = 0
    for mark in _MARK.finditer(selectors):
        if mark[0] != ",":
            depth += 1 if mark[0] in "([" else -1
        elif depth == 0:
            yield selectors[start : mark.start()]
            start = mark.end()
    yield selectors[start:]


def _is_at_rest(selector: str) -> bool:
    """Return whether a selector may be of a drawing that nobody points at, as one with ``:not(:hover)`` is."""
    outside = selector.partition("(")[0] + selector.rpartition(")")[2]
    return _IN_USE.search(outside) is None


def _on_screen(media: str) -> bool:
    """Return whether a list of media has every screen in it."""
    return any(each.strip() in _SCREENS for each in media.lower().split(","))


def _declared(text: str) -> _Declared:
    declared = _Declared({}, {})
    for name, _, value in (each.partition(":") for each in text.split(";")):
        if value:
            said, is_important = _IMPORTANT.subn("", value)
            (declared.important if is_important else declared.usual)[name.strip().lower()] = said.strip()
    return declared
