from maulstick.storage.text import counted


def test_one_thing_is_told_in_the_singular_and_any_other_number_in_the_plural_with_commas() -> None:
    assert [counted(number, "stroke") for number in (0, 1, 2, 12_000)] == [
        "0 strokes", "1 stroke", "2 strokes", "12,000 strokes",
    ]  # fmt: skip
    assert [counted(number, "touch", "touches") for number in (1, 2)] == ["1 touch", "2 touches"]
