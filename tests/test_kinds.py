"""Kinds of what people give in Python."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typing_extensions import TypeAliasType, TypeVar

from maulstick.errors import InputError
from maulstick.kinds import checked

Scalar = TypeVar("Scalar", bound=np.generic)
Array = TypeAliasType("Array", np.ndarray[Any, np.dtype[Scalar]], type_params=(Scalar,))  # as NumPy's own from 2.5 on
Text = TypeAliasType("Text", str)


@checked
def take(picture: Path | Array[np.float64] = Path(), title: Text = "") -> None:
    pass


def test_a_kind_that_has_a_name_takes_what_the_name_stands_for() -> None:
    take(np.zeros(3))
    take(Path("portrait.png"), "Anna")


def test_a_kind_that_has_a_name_refuses_what_the_name_excludes() -> None:
    with pytest.raises(InputError, match="title is 3; it must be of the kind Text"):
        take(title=3)  # type: ignore[arg-type]
