import codecs
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from maulstick.errors import InputError
from maulstick.recording.mocap import motive, motive_header
from maulstick.recording.mocap.motive import read_motive
from maulstick.recording.mocap.take import Take
from tests.support.recording.motive_export import motive_csv

FRAMES = 20


def a_take(frames: int = FRAMES, markers: int = 4) -> Take:
    """A pen and a canvas anywhere, the pen lost in some frames and one marker of each in others."""
    rng = np.random.default_rng(7)
    take = Take(
        np.arange(frames) / 240,
        rng.uniform(-1, 1, (frames, 3)),
        Rotation.random(frames, rng=rng).as_quat(),
        rng.uniform(-1, 1, (frames, markers, 3)),
        rng.uniform(-1, 1, (frames, 3, 3)),
    )
    take.pen_positions[3:6] = take.pen_rotations[3:6] = np.nan
    take.pen_markers[2:7, :1] = take.canvas_markers[-3:-2, 1] = np.nan
    return take


@pytest.fixture
def read(tmp_path: Path) -> Callable[..., Take]:
    """What is read of a file with this content."""

    def read_content(content: bytes, **names: str) -> Take:
        path = tmp_path / "take.csv"
        path.write_bytes(content)
        return read_motive(path, **names)

    return read_content


@pytest.fixture
def complaint(read: Callable[..., Take], tmp_path: Path) -> Callable[..., str]:
    """Why a file with this content cannot be read."""

    def complain(content: bytes, **names: str) -> str:
        with pytest.raises(InputError) as caught:
            read(content, **names)
        start = f"cannot read the Motive export {tmp_path / 'take.csv'}: "
        assert str(caught.value).startswith(start)
        assert len(str(caught.value).splitlines()) == 1
        return str(caught.value).removeprefix(start)

    return complain


def assert_same(got: Take, want: Take, error: float = 0.6e-6) -> None:
    """All numbers are the same, rotations up to the sign of the quaternion, and what was not seen is NaN in both."""
    signs = np.sign((got.pen_rotations * want.pen_rotations).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(got.pen_rotations * signs, want.pen_rotations, rtol=0, atol=error)
    for name in ("times", "pen_positions", "pen_markers", "canvas_markers"):
        np.testing.assert_allclose(getattr(got, name), getattr(want, name), rtol=0, atol=error)


def swapped(content: bytes, *names: bytes) -> bytes:
    """The content with the names in each other's places."""
    first, second = names
    return content.replace(first, b"\x1a").replace(second, first).replace(b"\x1a", second)


@pytest.mark.parametrize("version", ["1.2", "1.21", "1.23", "1.24", "1.31"])
@pytest.mark.parametrize("rotation", ["Quaternion", "XYZ", "ZYX", "YXZ"])
@pytest.mark.parametrize(("unit", "delimiter"), [("m", ","), ("mm", ";"), ("cm", ",")])
@pytest.mark.parametrize("canvas", ["Canvas", None])
def test_a_take_is_read_as_it_was_exported(
    read: Callable[..., Take], version: str, rotation: str, unit: str, delimiter: str, canvas: str | None
) -> None:
    take = a_take()
    content = motive_csv(take, version=version, rotation=rotation, unit=unit, delimiter=delimiter, canvas_name=canvas)
    assert_same(read(content), take)


def test_euler_angles_turn_about_the_axes_of_the_body(read: Callable[..., Take]) -> None:
    take = a_take(1)
    content = motive_csv(take, rotation="XYZ").split(b"\r\n")
    cells = content[-2].split(b",")
    content[-2] = b",".join([*cells[:2], b"90", b"90", b"0", *cells[5:]])
    # About X: y becomes z.  Then about the new Y, which is the old Z: x becomes y.
    turned = Rotation.from_quat(read(b"\r\n".join(content)).pen_rotations).apply([1.0, 0.0, 0.0])
    np.testing.assert_allclose(turned, [[0, 1, 0]], atol=1e-12)


def test_measured_markers_are_preferred_and_those_of_the_rigid_bodies_taken_without_them(
    read: Callable[..., Take],
) -> None:
    take = a_take()
    assert b",Marker," in motive_csv(take)
    assert b",Marker," not in motive_csv(take, measured=False)
    assert_same(read(motive_csv(take)), take)
    assert_same(read(motive_csv(take, measured=False)), take)


def test_columns_are_found_by_the_header_wherever_they_are(read: Callable[..., Take]) -> None:
    lines = [line.split(b",") for line in motive_csv(a_take()).split(b"\r\n")]
    order = [0, 1, *np.random.default_rng(1).permutation(np.arange(2, len(lines[-2])))]
    moved = [[line[place] for place in order] if len(line) == len(order) else line for line in lines]
    assert moved != lines
    got = read(b"\r\n".join(b",".join(line) for line in moved))
    canvas = got.canvas_markers[:, np.argsort(got.canvas_markers[0, :, 0])]
    want = a_take().canvas_markers
    np.testing.assert_allclose(canvas, want[:, np.argsort(want[0, :, 0])], rtol=0, atol=0.6e-6)
    np.testing.assert_allclose(got.pen_positions, a_take().pen_positions, rtol=0, atol=0.6e-6)


def test_columns_of_other_things_are_passed_over(read: Callable[..., Take]) -> None:
    lines = [line.split(b",") for line in motive_csv(a_take()).split(b"\r\n")]
    others = {
        2: [b"", b"", b"", b"", b"TimeCode", b"15:26:46:12.02"],
        20: [b"Bone", b"Pen", b"7", b"Rotation", b"X", b"text"],
        40: [b"Bone Marker", b"Pen:Marker1", b"7", b"Position", b"X", b"1e9"],
    }
    for place, (*headings, cell) in others.items():
        for line, heading in zip(lines[2:], [*headings, *[cell] * FRAMES], strict=False):
            line.insert(place, heading)
    assert_same(read(b"\r\n".join(b",".join(line) for line in lines)), a_take())


@pytest.mark.parametrize(
    ("pen", "canvas", "names"),
    [
        ("Brush", "Sheet of paper", {}),
        ("My PEN", "Drawing-Board", {}),
        ("Rigid Body 1", "Canvas", {}),
        ("A", "B", {"pen": "A", "canvas": "B"}),
        ("A", "B", {"canvas": "B"}),
        ("Paper", "Pen", {"pen": "Paper", "canvas": "Pen"}),
        ("Sheet", None, {}),
        ("Pen_1", "Pen_1_canvas", {"pen": "Pen_1"}),
    ],
)
def test_pen_and_canvas_are_told_by_their_names(
    read: Callable[..., Take], pen: str, canvas: str | None, names: dict[str, str]
) -> None:
    assert_same(read(motive_csv(a_take(), pen_name=pen, canvas_name=canvas), **names), a_take())


def test_a_pen_or_a_canvas_that_cannot_be_told_lists_what_there_is(complaint: Callable[..., str]) -> None:
    there = "there are the rigid bodies 'A' (4 markers), 'B' (3 markers) and 0 loose markers"
    content = motive_csv(a_take(), pen_name="A", canvas_name="B")
    assert complaint(content) == (
        "there is no telling which is the canvas; name it (sheet), a rigid body of exactly three markers, "
        f"or let exactly three markers be loose: {there}"
    )
    assert complaint(content, pen="C") == f"there is no rigid body 'C'; {there}"
    assert (
        complaint(content, pen="A", canvas="A") == "the pen and the canvas are both 'A'; they must be two rigid bodies"
    )
    assert complaint(content, canvas="A") == (
        "the canvas 'A' has 4 markers; it must have exactly three, each at a corner"
    )
    bones = content.replace(b"Rigid Body,", b"Bone,")
    assert complaint(bones).endswith("there are no rigid bodies and 7 loose markers")
    pens = motive_csv(a_take(), pen_name="Pen", canvas_name="Brush")
    assert complaint(pens, canvas="Brush", pen="Brush").startswith("the pen and the canvas are both 'Brush'")


def test_two_rigid_bodies_of_one_name_are_refused(complaint: Callable[..., str]) -> None:
    pens = motive_csv(a_take(), canvas_name="Other").replace(b"Other", b"Pen")
    told = "two rigid bodies are called 'Pen'; rename one in Motive, and try again"
    assert complaint(pens) == complaint(pens, pen="Pen") == told


def header(content: bytes, old: bytes, new: bytes) -> bytes:
    assert old in content
    return content.replace(old, new, 1)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        (b"Meters", b"Furlongs", "its Length Units are 'Furlongs'; they must be Meters, Centimeters or Millimeters"),
        (b"Length Units,", b"", "its Length Units are ''; they must be Meters, Centimeters or Millimeters"),
        (b"Quaternion", b"XYX", "its Rotation Type is 'XYX'; it must be Quaternion, or an order of axes, as XYZ"),
        (b"Space,Global", b"Space,Local", "its Coordinate Space is 'Local'; export it in Global coordinates"),
        (
            b"Frames,20",
            b"Frames,10000001",
            "it has 10000001 frames, and at most 10000000 can be read; export a shorter",
        ),
        (b"Format Version", b"Version", "it does not begin with 'Format Version'; export it from Motive as CSV"),
        (b"Format", b"\xff\xfeF\0", "it is in UTF-16; save it as CSV in UTF-8"),
        (b"Frame,Time", b"Picture,Time", "its header has no line that begins with 'Frame'; export it again"),
        (b"Time (Seconds)", b"Clock", "it has no column 'Time (Seconds)'; export it again, header included"),
        (b"Frame,Time (Seconds),X,Y,Z,W,", b"Frame,Time (Seconds),X,Y,Z,,", "the pen 'Pen' has no column Rotation W;"),
        (b"Frame,Time (Seconds),X,Y,Z,W,", b"Frame,Time (Seconds),X,Y,Y,W,", "two columns are Rotation 'Y' of 'Pen'"),
        (b"19,0.079167", b"19,0.075000", "the time in line 27 does not rise; export it again"),
        (b"19,0.079167", b"19,", "the time in line 27 does not rise; export it again"),
        (b"19,0.079167", b"19,0.079167,", "line 27 has 68 cells, and its header 67; export it again"),
        (b"19,0.079167", b"19", "line 27 has 66 cells, and its header 67; export it again"),
        (b"19,0.079167", b"19,soon", "cell 2 of line 27 is 'soon'; it must be a number or empty"),
        (b"19,0.079167", b"19,inf", "cell 2 of line 27 is 'inf'; it must be a number or empty"),
        (b"19,0.079167", b"19,0.0\x009167", "there are zero bytes among its numbers; it is damaged, export it again"),
    ],
)
def test_a_file_with_a_fault_is_refused_with_what_to_do(
    complaint: Callable[..., str], old: bytes, new: bytes, text: str
) -> None:
    assert complaint(header(motive_csv(a_take()), old, new)).startswith(text)


def test_numbers_that_cannot_be_are_refused(complaint: Callable[..., str]) -> None:
    take = a_take()
    take.pen_rotations[11] *= 1.1
    assert complaint(motive_csv(take)) == "line 19 has a quaternion that is not of length 1; export it again"
    take = a_take()
    wrong = header(motive_csv(take, unit="mm"), b"Millimeters", b"Meters")
    assert "has a place over 100 m away; check its Length Units and export it again" in complaint(wrong)


def test_a_file_of_another_kind_is_refused(complaint: Callable[..., str], tmp_path: Path) -> None:
    for content in (b"x,y\n1,2\n", b"\0" * 100, bytes(range(256)) * 100, b"\n", b"Format Version"):
        complaint(content)
    with pytest.raises(InputError, match="there is no Motive export"):
        read_motive(tmp_path / "none.csv")


def test_a_file_that_ends_within_its_header_or_before_its_frames_is_refused(complaint: Callable[..., str]) -> None:
    lines = motive_csv(a_take()).split(b"\r\n")
    for count in range(1, 7):
        assert "in its header; export it again" in complaint(b"\r\n".join(lines[:count]) + b"\r\n")
    assert complaint(b"\r\n".join(lines[:7]) + b"\r\n\r\n") == "it has no frames; export it again"


def test_a_last_line_that_was_cut_is_left_out(read: Callable[..., Take]) -> None:
    content = motive_csv(a_take())
    for cut in (3, 10, 200):
        assert len(read(content[:-cut])) == FRAMES - 1
    assert len(read(content + b"\r\n\r\n")) == FRAMES


def test_marks_of_the_byte_order_and_bare_line_feeds_do_no_harm(read: Callable[..., Take]) -> None:
    assert_same(read(codecs.BOM_UTF8 + motive_csv(a_take()).replace(b"\r\n", b"\n")), a_take())


def test_names_are_read_in_utf_8_and_in_latin_1(read: Callable[..., Take]) -> None:
    content = motive_csv(a_take(), pen_name="Füller")
    assert_same(read(content, pen="Füller"), a_take())
    assert_same(read(content.decode().encode("latin-1"), pen="Füller"), a_take())


def test_a_take_is_the_same_whatever_blocks_it_is_read_in(
    read: Callable[..., Take], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(motive, "_BLOCK", 3000)
    assert_same(read(motive_csv(a_take(100))), a_take(100))


def test_what_is_too_long_is_refused_before_it_fills_the_memory(
    complaint: Callable[..., str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    content = motive_csv(a_take())
    monkeypatch.setattr(motive, "_BLOCK", 3000)
    lines = content.split(b"\r\n")
    endless = b"\r\n".join(lines[:8]) + b"\r\n" + b"1" * 10_000
    assert complaint(endless) == "one of its lines is longer than 16 MiB; export it again"
    monkeypatch.setattr(motive_header, "_LONGEST", 3000)
    assert complaint(b"Format Version," + b"1" * 10_000 + b"\n").startswith("it ends or has too long a line in line")
    monkeypatch.setattr(motive, "MOST_FRAMES", 15)
    lying = header(content, b"Total Exported Frames,20", b"Total Exported Frames,2")
    assert complaint(lying) == "it has over 15 frames, and no more can be read; export a shorter range of frames"
    with (tmp_path / "huge.csv").open("wb") as file:
        file.truncate(2**33 + 2**32)  # takes no room on the disk
    with pytest.raises(InputError, match=r"it has 12\.0 GiB, and at most 8 GiB can be read; export a shorter range"):
        read_motive(tmp_path / "huge.csv")


SMALL = motive_csv(a_take(8, 2))
PLACES = st.integers(0, len(SMALL) - 1)
LINES = SMALL.split(b"\r\n")


def cut(at: int) -> bytes:
    return SMALL[:at]


def flipped(flips: list[tuple[int, int]]) -> bytes:
    content = bytearray(SMALL)
    for place, byte in flips:
        content[place] = byte
    return bytes(content)


def with_line(at: int, line: bytes) -> bytes:
    return b"\r\n".join([*LINES[:at], line, *LINES[at:]])


def with_cell(row: int, place: int, cell: bytes) -> bytes:
    cells = LINES[row].split(b",")
    cells[place % len(cells)] = cell
    return b"\r\n".join([*LINES[:row], b",".join(cells), *LINES[row + 1 :]])


def with_columns(first: int, second: int, rows: int) -> bytes:
    lines = [line.split(b",") for line in LINES]
    for line in lines[rows:]:
        if len(line) > max(first, second):
            line[first], line[second] = line[second], line[first]
    return b"\r\n".join(b",".join(line) for line in lines)


CELLS = st.sampled_from(
    [b"nan", b"inf", b"-1e400", b"1e300", b"text", b"0x1f", b"1_0", b" 1 ", b'"', b"True", b"-", b"1;2", b"\r", b"\xff"]
)
MUTATIONS = st.one_of(
    st.builds(cut, PLACES),
    st.builds(flipped, st.lists(st.tuples(PLACES, st.integers(0, 255)), min_size=1, max_size=4)),
    st.builds(with_line, st.integers(0, len(LINES)), st.one_of(st.binary(max_size=60), st.sampled_from(LINES))),
    st.builds(with_cell, st.integers(0, len(LINES) - 1), st.integers(0, 60), CELLS),
    st.builds(with_columns, st.integers(0, 50), st.integers(0, 50), st.integers(0, 8)),
    st.binary(max_size=300).map(lambda tail: b"Format Version," + tail),
)


@settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=MUTATIONS)
def test_a_damaged_file_gives_a_whole_take_or_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(content)
    try:
        take = read_motive(path)
    except InputError as error:
        complaint = str(error)
    else:
        complaint = ""
        assert_whole(take)
    assert len(complaint.splitlines()) == (complaint != "")


def assert_whole(take: Take) -> None:
    """Everything has its shape and is either seen or not."""
    frames, markers = take.pen_markers.shape[:2]
    assert 0 < frames <= 9
    assert take.times.shape == (frames,)
    assert (np.diff(take.times) > 0).all()
    assert np.isfinite(take.times).all()
    shapes = [(frames, 3), (frames, 4), (frames, markers, 3), (frames, 3, 3)]
    arrays = [take.pen_positions, take.pen_rotations, take.pen_markers, take.canvas_markers]
    for array, shape in zip(arrays, shapes, strict=True):
        assert array.shape == shape
        seen = np.isfinite(array).all(axis=-1)
        assert np.isnan(array[~seen]).all()
    length = np.linalg.norm(take.pen_rotations, axis=1)
    np.testing.assert_allclose(length[np.isfinite(length)], 1, rtol=0, atol=0.011)
