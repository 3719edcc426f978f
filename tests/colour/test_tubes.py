import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.colour.tubes import USUAL_PAINTS, NamedPaint, read_paints
from maulstick.errors import InputError

names = st.text(st.characters(categories=("L", "N", "P")), min_size=1, max_size=9).filter(lambda name: '"' not in name)
colours = st.tuples(*[st.integers(0, 255)] * 3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("paints")


@settings(max_examples=50, deadline=None)
@given(st.dictionaries(names, colours, min_size=1, max_size=9), st.booleans())
def test_a_set_of_paints_is_read_as_it_was_written(
    folder: Path, tubes: dict[str, tuple[int, int, int]], heading: bool
) -> None:
    tubes = {name: colour for name, colour in tubes.items() if name == name.casefold()} or {"a": (1, 2, 3)}
    expected = [(name, pytest.approx([channel / 255 for channel in colour])) for name, colour in tubes.items()]
    hexes = {name: "#{:02x}{:02x}{:02x}".format(*colour) for name, colour in tubes.items()}
    lines = ["Name, Colour"] * heading + [f'"{name}", {colour}' for name, colour in hexes.items()]
    (folder / "paints.csv").write_text("\n".join(lines), encoding="utf-8")
    (folder / "paints.json").write_text(json.dumps([{"name": n, "colour": c} for n, c in hexes.items()]))
    for file in ("paints.csv", "paints.json"):
        assert [(paint.name, list(paint.colour)) for paint in read_paints(folder / file)] == expected


def test_spreadsheets_marks_blank_lines_and_names_of_colours_are_understood(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes("\ufeffname,colour\r\n\r\n Ochre , #c08a35\r\nsnow,white\r\n,\r\n".encode())
    assert read_paints(tmp_path / "a.csv") == (
        NamedPaint("Ochre", (192 / 255, 138 / 255, 53 / 255)),
        NamedPaint("snow", (1.0, 1.0, 1.0)),
    )


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ("a,#ffffff\nb,octarine\n", ", line 2: 'octarine' is not a colour; write a name such as black, or #rrggbb"),
        ("a,#ffffff\n\nA,black\n", ", line 3: there is already a paint 'A'; give every paint its own name"),
        ("a,#ffffff,2\n", ", line 1: it has 3 columns and must have 2; write name,colour, as in: ultramarine,#2a2f8f"),
        ("#ffffff\n", ", line 1: it has 1 column and must have 2; write name,colour, as in: ultramarine,#2a2f8f"),
        (",#ffffff\n", ", line 1: the name must have 1 to 80 printable characters"),
        ("a\u202eb,#ffffff\n", ", line 1: the name must have 1 to 80 printable characters"),
        (f"{'a' * 81},white\n", ", line 1: the name must have 1 to 80 printable characters"),
        ("name,colour\n", " has no paints; write one per line, as in: ultramarine,#2a2f8f"),
        (" \n", " has no paints; write one per line, as in: ultramarine,#2a2f8f"),
        ("[]", " has no paints; write one per line, as in: ultramarine,#2a2f8f"),
        ("\n".join(f"p{i},#ffffff" for i in range(257)), " has more than 256 paints; leave out those that are not at"),
        (f"{'a' * 200_000},white\n", ", line 1: field larger than field limit (131072); write name,colour"),
        ('[{"name": "a", "colour": "octarine"}]', ", entry 1: 'octarine' is not a colour; write"),
        ('[{"name": "a"}]', " is not a list of paints: [0].colour: Field required"),
        (
            '[{"name": 3, "colour": "red"}]',
            " is not a list of paints: [0].name: Input should be a valid string (got 3)",
        ),
        ('{"a": "#ffffff"}', " is not a list of paints: the file: Input should be a valid array"),
        ("[" * 100_000, " is not a list of paints: the file: Invalid JSON: recursion limit exceeded"),
        ("a,red\0", " is not text; write one paint per line, as in: ultramarine,#2a2f8f"),
    ],
)
def test_a_file_with_a_fault_is_refused_by_its_line(tmp_path: Path, content: str, text: str) -> None:
    path = tmp_path / "paints.csv"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_paints(path)
    assert str(caught.value).startswith(f"{path}{text}")
    assert "\n" not in str(caught.value)


def test_a_file_that_is_binary_huge_or_not_there_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    with pytest.raises(InputError, match=r"a\.png is not text; write one paint per line"):
        read_paints(tmp_path / "a.png")
    with (tmp_path / "huge.csv").open("wb") as file:
        file.truncate(2**34)  # a hole: it takes no disk
    with pytest.raises(InputError, match=r"huge\.csv is larger than 1 MiB, too large for a file of paints"):
        read_paints(tmp_path / "huge.csv")
    with pytest.raises(InputError, match=r"there is no file of paints .*none\.csv; check its name and folder"):
        read_paints(tmp_path / "none.csv")


def test_the_usual_paints_are_a_dozen_with_a_white_and_a_black_at_the_ends() -> None:
    assert len({paint.name for paint in USUAL_PAINTS}) == 12
    light = sorted(USUAL_PAINTS, key=lambda paint: sum(paint.colour))
    assert (light[0].name, light[-1].name) == ("ivory black", "titanium white")
