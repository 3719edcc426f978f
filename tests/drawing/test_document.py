import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.read import read_drawing
from maulstick.errors import InputError
from maulstick.recording.files.svg_paths import coordinates
from tests.drawing.conftest import PAGE, SPACES

ENTITIES = "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True))
LAUGHS = f'<!DOCTYPE svg [<!ENTITY a "ha">{ENTITIES}]>'
OUTSIDE = '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>'


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"", "is empty"),
        (b"   ", "is not an SVG that can be read: no element found"),
        (b"<html/>", "is not an SVG: its outermost element is <html>; it must be <svg>"),
        (b"\x89PNG\r\n\x1a\n", "is not an SVG that can be read"),
        (b"\x1f\x8b\x08\x00rest", "is a compressed SVG; save it as plain SVG"),
        (b"<svg><path d='M0 0L1 1'></svg>", "is not an SVG that can be read: mismatched tag"),
        (f"{LAUGHS}<svg {SPACES}>&i;</svg>".encode(), "declares entities"),
        (f"{OUTSIDE}<svg {SPACES}>&x;</svg>".encode(), "declares entities"),
        (b'<?xml version="1.0" encoding="klingon"?><svg/>', "is not an SVG that can be read"),
        (f'<svg {SPACES} width="0" height="5"/>'.encode(), "its page is 0 x 5 pixels"),
        (f'<svg {SPACES} width="1e-4mm" height="5"><path d="M0 0h1"/></svg>'.encode(), "a height from 0.01 to 1e+07"),
    ],
)  # fmt: skip
def test_what_is_no_svg_is_refused_in_a_sentence(tmp_path: Path, content: bytes, fault: str) -> None:
    file = tmp_path / "drawing.svg"
    file.write_bytes(content)
    with pytest.raises(InputError) as refused:
        read_drawing(file)
    assert fault in str(refused.value)
    assert str(file) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no drawing .*none\.svg"):
        read_drawing(tmp_path / "none.svg")


def test_a_document_type_as_inkscape_and_illustrator_write_it_is_nothing_to_fear(tmp_path: Path) -> None:
    file = tmp_path / "drawing.svg"
    kind = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
    file.write_text(f'<?xml version="1.0"?>\n{kind}<svg {SPACES} {PAGE}><path d="M0 0L9 9"/></svg>')
    assert len(read_drawing(file).painting.strokes) == 1


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_other_encodings_and_elements_without_a_namespace_are_read(tmp_path: Path, encoding: str) -> None:
    file = tmp_path / "drawing.svg"
    said = '<?xml version="1.0" encoding="latin-1"?>' if encoding == "latin-1" else ""
    file.write_bytes(f'{said}<svg {PAGE}><title>é</title><path d="M0 0L9 9"/></svg>'.encode(encoding))
    assert len(read_drawing(file).painting.strokes) == 1


def test_ten_megabytes_are_read(tmp_path: Path) -> None:
    file = tmp_path / "drawing.svg"
    line = '<polyline points="' + " ".join(f"{i % 97}.25,{i % 47}.5" for i in range(100_000)) + '"/>'
    file.write_text(f"<svg {SPACES} {PAGE}>{line * 10}</svg>")
    assert file.stat().st_size > 8e6
    painting = read_drawing(file).painting
    assert [len(stroke.trajectory) for stroke in painting.strokes] == [100_000] * 10


def test_a_long_line_needs_little_more_memory_than_its_numbers() -> None:
    text = "0.25,1.5 " * 50_000
    tracemalloc.start()
    try:
        read, whole = coordinates(text)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert read == [0.25, 1.5] * 50_000
    assert whole
    assert peak < 100 * len(read)


NASTY = [
    "0",
    "-1",
    "1e400",
    "nan",
    "%",
    "none",
    "z",
    "A",
    "scale(0)",
    "url(#c)",
    "#p",
    "<",
    "use",
    "clipPath",
    "mm",
    "",
]
WHOLE = (
    f'<svg {SPACES} {PAGE}><style>.a{{fill:red}}</style><defs><path id="p" d="M0 0c9 0 9 9 20 9a9 9 0 1 1-5-5"/></defs>'
    '<clipPath id="c"><circle cx="50%" cy="20" r="15"/></clipPath><g clip-path="url(#c)" transform="rotate(9 1 2)">'
    '<use xlink:href="#p" x="30" y="9" class="a"/><ellipse cx="40" cy="20" rx="9" ry="5mm"/></g>'
    '<svg x="5" width="40" height="30" viewBox="0 0 9 9"><rect width="7" height="7" rx="1" stroke="blue"/></svg></svg>'
)


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.tuples(st.integers(0, len(WHOLE)), st.integers(0, 9), st.sampled_from(NASTY)), min_size=1, max_size=3)
)
def test_a_damaged_file_is_drawn_or_refused_in_a_sentence(
    tmp_path_factory: pytest.TempPathFactory, damages: list[tuple[int, int, str]]
) -> None:
    text = WHOLE
    for place, length, nasty in damages:
        text = text[:place] + nasty + text[place + length :]
    file = tmp_path_factory.mktemp("damaged") / "drawing.svg"
    file.write_text(text)
    strokes, said = 1, f"{file}"
    try:
        strokes = len(
            read_drawing(file, DrawingOptions(hatch=2e-3, size=(0.1, 0.05), no_repeats=True)).painting.strokes
        )
    except InputError as refused:
        said = str(refused)
    assert strokes > 0
    assert str(file) in said
    assert "\n" not in said
