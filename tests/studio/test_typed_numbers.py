"""Numbers that people type into fields."""

import pytest

from maulstick.errors import InputError
from maulstick.studio.state.typed_numbers import number, whole_number


def test_a_field_says_a_whole_number_within_its_range() -> None:
    assert [whole_number(typed, "the number of paints", 1, 64) for typed in (1, 12.0, 64)] == [1, 12, 64]


@pytest.mark.parametrize(
    ("typed", "shown"), [(None, "nothing"), (0, "0"), (65, "65"), (2.5, "2.5"), (float("nan"), "nan")]
)
def test_what_is_no_whole_number_is_refused_in_a_sentence(typed: float | None, shown: str) -> None:
    sentence = f"the number of paints is {shown}; it must be a whole number from 1 to 64"
    with pytest.raises(InputError, match=sentence):
        whole_number(typed, "the number of paints", 1, 64)


def test_a_number_has_a_unit_in_what_is_said_of_it() -> None:
    assert [number(typed, "the speed", 0.1, 100, "mm/s") for typed in (0.1, 2.5, 100)] == [0.1, 2.5, 100]
    for typed, shown in ((None, "nothing"), (0, "0 mm/s"), (100.5, "100.5 mm/s"), (float("nan"), "nan mm/s")):
        with pytest.raises(InputError, match=f"the speed is {shown}; it must be from 0.1 to 100 mm/s"):
            number(typed, "the speed", 0.1, 100, "mm/s")
