"""Kinds of what people give in Python: a value that its annotation excludes is refused in one line."""

import inspect
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import wraps
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from reprlib import repr as shortened
from types import UnionType
from typing import Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin

import numpy as np

from maulstick.errors import InputError, option

Given = ParamSpec("Given")
Returned = TypeVar("Returned")


def checked(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
    """Return the function, which then raises InputError for an argument that its annotation excludes."""
    signature = inspect.signature(function)
    kinds = {name: parameter.annotation for name, parameter in signature.parameters.items()}

    @wraps(function)
    def call(*args: Given.args, **named: Given.kwargs) -> Returned:
        check_kinds(signature.bind(*args, **named).arguments, kinds)
        return function(*args, **named)

    return call


def check_kinds(values: Mapping[str, object], kinds: Mapping[str, Any]) -> None:
    """Raise InputError for the first value, by name, that its annotation excludes.

    Numbers pass as any kind of number, for checks of their range say more.
    """
    for name, value in values.items():
        if not _is_a(value, kinds[name]):
            told = re.sub(r"(\w+\.)+", "", inspect.formatannotation(kinds[name]))
            raise InputError.of_range(option(name), " ".join(shortened(value).split()), f"of the kind {told}")


def check_names(given: Iterable[str], known: Collection[str]) -> None:
    """Raise InputError for the first name of an option that is not known."""
    for name in given:
        if name not in known:
            raise InputError.of_choice("option", name, known)


def check_whole(name: str, number: object, least: int, most: int, allowed: str | None = None) -> None:
    """Raise InputError for an option that is no whole number from `least` to `most`; `allowed` says so otherwise."""
    if not isinstance(number, Integral) or isinstance(number, bool) or not least <= int(number) <= most:
        shown = number if isinstance(number, np.number) else repr(number)
        raise InputError.of_range(option(name), shown, allowed or f"from {least} to {most}")


def _is_a(value: object, kind: Any) -> bool:
    kind = getattr(kind, "__value__", kind)  # of a name given by a `type` statement, as NumPy's are from 2.5 on
    origin, parts = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return any(_is_a(value, part) for part in parts)
    if origin is Literal:
        return isinstance(value, tuple(map(type, parts)))
    if origin in (tuple, Sequence):
        return isinstance(value, Collection) and not isinstance(value, str) and all(_is_a(x, parts[0]) for x in value)
    plain = origin or kind
    if plain in (int, float):
        return isinstance(value, Real)
    if plain is Path:
        return isinstance(value, str | PathLike)
    if plain in (Any, inspect.Parameter.empty, np.ndarray):  # an array is whatever can be made one
        return True
    return isinstance(value, plain)
