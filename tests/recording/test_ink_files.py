import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.recording.files.ink_files import FORMATS, read_ink_file
from maulstick.storage.arrays import write_arrays
from maulstick.strokes.ink import Ink, write_ink
from tests.support.recording.wacom_files import uim, uim_3_0, will

STROKE = np.array([[1.0, 0.01, 0.02, 0.25], [1.5, 0.04, 0.02, 0.5], [1.75, 0.05, 0.03, 1.0], [2.0, 0.02, 0.01, 0.5]])
INKML = b"""<ink xmlns="http://www.w3.org/2003/InkML"><definitions><context xml:id="c"><inkSource>
<traceFormat><channel name="X" type="integer" units="cm"/><channel name="Y" type="integer"/><channel name="T"/>
<channel name="F" max="9"/></traceFormat><channelProperties><channelProperty channel="X" name="resolution" value="1000"
units="1/cm"/><channelProperty channel="Y" name="resolution" value="100" units="1/mm"/></channelProperties></inkSource>
</context></definitions><trace id="a" contextRef="#c" timeOffset="9">1000 2000 0 3,'3000'0'8'6,"10"9*-3</trace>
<traceGroup><trace contextRef="#c" continuation="end" priorRef="#a">#1F ? 50 9, 4 4 60 * </trace></traceGroup></ink>"""
SVG = b"""<?xml version="1.0"?><!-- drawn --><svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm"
viewBox="0 0 100 50"><defs><path id="a" d="M0 0q2 3 4-5"/></defs><g transform="translate(9,9) rotate(5)"><use href="#a"
x="5"/><path d="M10 10C20 20 30 0 40 10zm1 1a3 2 9 0 1 4 4"/></g><circle r="3" cx="4" cy="4"/><rect width="4" height="3"
rx="1"/><polyline points="0,0 1,1 2,0"/></svg>"""
EVENTS = b"""{"schema_version": 1, "size_mm": [200, 150], "strokes": [[{"timeStamp": 1503.2, "x": 21.5, "y": 40.25,
"pressure": 0.31}, {"timeStamp": 1507.4, "x": 21.9, "y": 40.5, "pressure": 0.36, "tiltX": 3}]]}"""
FILES = {
    "InkML": INKML,
    "SVG": SVG,
    "pointer events": EVENTS,
    "UIM": uim([STROKE, STROKE + np.array([5, 0, 0.01, 0])]),
    "UIM 3.0": uim_3_0([STROKE, STROKE]),
    "UIM splines": uim([STROKE], sensors=False),
    "WILL": will([1e4 * STROKE[:, 1:3], 2e4 * STROKE[:, 1:3]]),
}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("drawings") / "drawing"


def fault(path: Path) -> str:
    """The one line that a file gets instead of being read, without the file's name."""
    with pytest.raises(InputError) as caught:
        read_ink_file(path)
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < len(str(path)) + 300
    return text.replace(str(path), "FILE")


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_known_by_its_content_whatever_its_name(file: Path, name: str) -> None:
    file.write_bytes(FILES[name])
    ink, kind = read_ink_file(file)
    assert kind == name.removesuffix(" 3.0").removesuffix(" splines")
    assert len(ink) >= 1
    assert ink.source == "drawing"


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "iso-8859-1"])
def test_xml_is_read_in_other_encodings(file: Path, encoding: str) -> None:
    declared = encoding.removesuffix("-sig").removesuffix("-le")
    byte_order = "\ufeff" if encoding == "utf-16-le" else ""
    text = f'{byte_order}<?xml version="1.0" encoding="{declared}"?><!-- \xe9 --><svg><path d="M0 0L1 1"/></svg>'
    file.write_bytes(text.encode(encoding))
    assert read_ink_file(file)[1] == "SVG"


@pytest.mark.parametrize(("name", "other"), [("SVG", "ink"), ("InkML", "svg")])
def test_what_a_comment_says_is_not_the_format(file: Path, name: str, other: str) -> None:
    file.write_bytes(f"<!-- not\nan <{other}> -->".encode() + FILES[name].removeprefix(b'<?xml version="1.0"?>'))
    assert read_ink_file(file)[1] == name


@pytest.mark.parametrize(
    ("points", "drawn"), [("1 1 x 9 9", 0), ("x", 0), ("1 1 9 9 x 20 20", 1), ("1 1 9 9 2", 1), ("", 0), ("1,1 9 9", 1)]
)
def test_points_end_before_a_faulty_sign_as_paths_do_and_are_told(file: Path, points: str, drawn: int) -> None:
    notes: list[str] = []
    shape = f'<polyline points="{points}"/>'
    file.write_text(f'<svg width="50mm" height="50mm" viewBox="0 0 50 50">{shape}<path d="M5 0h9"/></svg>')
    ink, _ = read_ink_file(file, note=notes.append)
    told = ["1 path of drawing with faulty data: drawn up to the fault"]
    assert (len(ink), notes) == (1 + drawn, told if points not in ("", "1,1 9 9") else [])
    assert ink.samples[:, 1:3].max() == pytest.approx(0.014), "what is behind a fault is not drawn"


def test_paths_that_end_early_at_a_faulty_sign_are_told_by_their_number(file: Path) -> None:
    paths = "".join(
        f'<path d="M1 1L9 {y}{rest}"/>' for y, rest in ((5, ""), (6, " ;L50 50"), (7, " L90 10 x"), (8, "z"))
    )
    file.write_text(f'<svg width="100mm" height="50mm" viewBox="0 0 100 50">{paths}</svg>')
    notes: list[str] = []
    ink, _ = read_ink_file(file, note=notes.append)
    assert (len(ink), notes) == (4, ["2 paths of drawing with faulty data: drawn up to the fault"])


def test_size_and_longest_are_passed_on(file: Path) -> None:
    file.write_bytes(SVG)
    assert read_ink_file(file)[0].size == pytest.approx((0.1, 0.05), abs=1e-9)
    assert read_ink_file(file, size=(0.3, 0.2))[0].size == (0.3, 0.2)
    ink, _ = read_ink_file(file, longest=0.3)
    assert np.ptp(ink.samples[:, 1:3], axis=0).max() == pytest.approx(0.3)


def test_ink_strokes_and_takes_are_no_drawings_to_record(tmp_path: Path) -> None:
    write_ink(Ink.of([STROKE], (0.1, 0.1)), tmp_path / "cat.ink.npz")
    text = "FILE holds ink already; there is nothing to record; look at it with maulstick show"
    assert fault(tmp_path / "cat.ink.npz") == text
    write_arrays(tmp_path / "cat.take.npz", "take", {})
    assert fault(tmp_path / "cat.take.npz") == "FILE holds a take; read it with maulstick record motive"


def test_what_is_none_of_the_formats_is_refused_with_their_names(file: Path) -> None:
    for content in (b"\0\1\2", b"hello", b"<html></html>", b"RIFF\0\0\0\0WAVE", b"\xff\xfe"):
        file.write_bytes(content)
        assert fault(file) == f"FILE is none of the drawings that can be read; there are: {FORMATS}"


def test_a_compressed_svg_is_refused_with_the_remedy(file: Path) -> None:
    file.write_bytes(gzip.compress(b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0L1 1"/></svg>'))
    assert fault(file) == "FILE is compressed, as an SVG may be; save it as plain SVG"


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"<ink><trace>1 2", "cannot read FILE as InkML: no element found: line 1, column 15"),
        (b"<ink></ink>", "cannot read FILE as InkML: there are no strokes in it"),
        (b"<ink><trace>1 1e400</trace></ink>", "cannot read FILE as InkML: a sample has no place: its x or y is no"),
        (
            b'<!DOCTYPE a [<!ENTITY a "b">]><ink/>',
            "cannot read FILE as InkML: it declares entities; save it as plain InkML",
        ),
        (b'<svg><path d="M1 1 L foo 2"/></svg>', "cannot read FILE as SVG: it is damaged; save it again as plain SVG"),
        (
            b'<svg><path transform="rotate(oops)" d="M1 1h3"/></svg>',
            "cannot read FILE as SVG: it is damaged; save it again as plain SVG",
        ),
        (b"<svg/>", "cannot read FILE as SVG: there is no path or shape in it; convert text and objects to paths"),
        (
            b"<ink>" + b"<traceGroup>" * 9999 + b"</traceGroup>" * 9999 + b"</ink>",
            "cannot read FILE as InkML: it is nested",
        ),
        (
            b"<svg>" + b"<g>" * 9999 + b"</g>" * 9999 + b"</svg>",
            "cannot read FILE as SVG: it is nested too deeply, or re",
        ),
        (
            b"<ink><context contextRef='#a' id='a'/></ink>",
            "cannot read FILE as InkML: it is nested too deeply, or refers",
        ),
        (b'{"schema_version": 2}', "cannot read FILE as pointer events: schema_version: Input should be 1 (got 2)"),
        (b"RIFF\0\0\0\0UINKHEAD", "cannot read FILE as UIM: Parser does not support this format. "),
        (b"PK\3\4", "cannot read FILE as WILL: File is not a zip file"),
    ],
)
def test_a_damaged_file_is_refused_by_its_format(file: Path, content: bytes, text: str) -> None:
    file.write_bytes(content)
    assert fault(file).startswith(text)


def test_a_file_too_large_to_be_a_drawing_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "large.svg"
    with path.open("wb") as large:
        large.truncate(64 * 2**20 + 1)
    assert fault(path) == "FILE is larger than 64 MiB, too large for a drawing; name another"


def test_a_missing_file_is_told() -> None:
    assert fault(Path("none.svg")) == "there is no drawing FILE; check its name and folder"


numbers = st.sampled_from([b"0", b"-1", b"1e9", b"1e400", b"nan", b"99999999999999999999", b".", b'"', b"*", b"#"])
pieces = st.one_of(st.binary(max_size=4), numbers)


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=120, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused_in_one_line(file: Path, name: str, data: st.DataObject) -> None:
    content = bytearray(FILES[name])
    for _ in range(data.draw(st.integers(1, 5))):
        place = data.draw(st.integers(0, max(len(content) - 1, 0)))
        content[place : place + data.draw(st.integers(0, 6))] = data.draw(pieces)
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content))) :]
    file.write_bytes(content or b"\0")
    try:
        ink, _ = read_ink_file(file)
    except InputError:
        fault(file)
    else:
        assert np.isfinite(ink.samples[:, 1:3]).all()
