import base64
import io
import json
import struct
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from pydantic import ValidationError

from maulstick.errors import InputError, OutputError
from maulstick.painting.painting import OFF_SHEET, Paint, Painting, Provenance, Sheet, Stroke, StyleUse, hex_colour
from maulstick.painting.painting_file import read_painting, write_painting
from maulstick.painting.picture import encode_png
from maulstick.painting.raster import Canvas
from maulstick.painting.succession import Succession
from tests.support.nominal import nominal

MICROMETRE = 1e-6
BRUSHES = [nominal("round"), nominal("marker")]

STRIPES = np.zeros((4, 6, 3), dtype=np.float32)
STRIPES[:, 2:4] = 1.0
PNG = encode_png(STRIPES)

CURVE = ((0.01, 0.02, 0.0), (0.03, 0.04, 0.5), (0.1, 0.05, 1.0))
USE = StyleUse(name="free", hash="ab12", code=(0.1, -2.5), pose=(0.01, 0.02, 0.7))
STROKES = (
    Stroke(id=7, paint=0, trajectory=CURVE, style=USE),
    Stroke(id=2, paint=1, trajectory=CURVE[:2], speed=(0.1, 0.2)),
    Stroke(id=5, paint=1, trajectory=CURVE[:1]),
)


def a_painting(strokes: Iterable[Stroke] = STROKES, paints: int = 2) -> Painting:
    options: dict[str, Any] = {"steps": 9, "ink": None}
    return Painting(
        sheet=Sheet(width=0.2, height=0.16),
        provenance=Provenance(version="1", image="a.jpg", image_sha256="0" * 64, seed=3, options=options),
        brushes={"round": nominal("round"), "pen": nominal("fineliner")},
        paints=tuple(Paint(colour=(i / 10, 0.5, 1.0), brush=("round", "pen")[i % 2]) for i in range(paints)),
        strokes=tuple(strokes),
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("paintings")


metres = st.floats(-1, 1)
shares = st.floats(0, 1)
names = st.text(st.characters(categories=("L", "N", "P")), min_size=1, max_size=5)
numbers = st.integers(-(2**60), 2**60) | st.floats(allow_nan=False, allow_infinity=False)
json_values = st.recursive(
    st.none() | st.booleans() | numbers | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)


@st.composite
def strokes_of(draw: st.DrawFn, number: int, paints: int, width: float, height: float) -> Stroke:
    across, down = st.floats(-OFF_SHEET, width + OFF_SHEET), st.floats(-OFF_SHEET, height + OFF_SHEET)
    trajectory = draw(st.lists(st.tuples(across, down, shares), min_size=1, max_size=4))
    speeds = st.lists(st.floats(1e-4, 10), min_size=len(trajectory), max_size=len(trajectory)).map(tuple)
    uses = st.builds(
        StyleUse,
        name=names,
        hash=names,
        code=st.lists(st.floats(-1e3, 1e3), max_size=3).map(tuple),
        pose=st.tuples(metres, metres, st.floats(-7, 7)),
    )
    return Stroke(
        id=number,
        paint=draw(st.integers(0, paints - 1)),
        trajectory=tuple(trajectory),
        speed=draw(st.none() | speeds),
        style=draw(st.none() | uses),
    )


@st.composite
def paintings(draw: st.DrawFn) -> Painting:
    width, height = draw(st.floats(0.01, 10)), draw(st.floats(0.01, 10))
    x, y = width * draw(st.floats(0, 0.5)), height * draw(st.floats(0, 0.5))
    brushes = draw(st.dictionaries(names, st.sampled_from(BRUSHES), min_size=1, max_size=3))
    paint = st.builds(
        Paint,
        colour=st.tuples(shares, shares, shares),
        brush=st.sampled_from(sorted(brushes)),
        name=st.none() | names,
    )
    paints = draw(st.lists(paint, min_size=1, max_size=3))
    ids = draw(st.lists(st.integers(0, 10**9), unique=True, max_size=3))
    options = draw(st.dictionaries(names, json_values, max_size=3))
    return Painting(
        sheet=Sheet(
            width=width,
            height=height,
            paper=draw(st.tuples(shares, shares, shares)),
            picture=draw(st.none() | st.just(PNG)),
        ),
        area=(x, y, width - x, height - y),
        provenance=Provenance(
            version="1",
            image=draw(st.none() | st.text()),
            options=options,
            metrics=draw(st.dictionaries(names, st.floats(allow_nan=False, allow_infinity=False), max_size=3)),
        ),
        brushes=brushes,
        paints=tuple(paints),
        strokes=tuple(draw(strokes_of(number, len(paints), width, height)) for number in ids),
    )


@settings(max_examples=60, deadline=None)
@given(painting=paintings())
def test_a_painting_is_equal_to_the_one_in_its_file(folder: Path, painting: Painting) -> None:
    write_painting(painting, folder / "first.json")
    again = read_painting(folder / "first.json")
    assert again == painting
    write_painting(again, folder / "second.json")
    assert (folder / "second.json").read_bytes() == (folder / "first.json").read_bytes()


@given(st.lists(st.tuples(metres, metres, shares), min_size=1, max_size=9))
def test_a_commanded_point_is_moved_by_no_more_than_half_a_micrometre(points: list[tuple[float, float, float]]) -> None:
    kept = np.array(Stroke(id=0, paint=0, trajectory=tuple(points)).trajectory)
    assert np.abs(kept - np.array(points)).max() <= 0.5001 * MICROMETRE


def test_numbers_are_kept_no_longer_than_they_mean_anything() -> None:
    stroke = Stroke(id=0, paint=0, trajectory=((0.123456789, -1e-9, 2 / 3),), speed=(1 / 3,))
    assert stroke.model_dump_json(exclude_none=True, include={"trajectory", "speed"}) == (
        '{"trajectory":[[0.123457,0.0,0.666667]],"speed":[0.333333]}'
    )
    assert StyleUse(name="free", hash="0", code=(1 / 3,), pose=(0, 0, 2 / 3)).code == (0.333333333,)


@given(st.lists(st.floats(-1e6, 1e6, width=32), max_size=9))
def test_a_float32_code_is_kept_to_the_bit(code: list[float]) -> None:
    use = StyleUse(name="free", hash="0", code=tuple(code), pose=(0, 0, 0))
    assert np.array_equal(np.array(use.code, dtype=np.float32), np.array(code, dtype=np.float32))


def test_a_stroke_is_a_line_of_the_file(tmp_path: Path) -> None:
    write_painting(a_painting(), tmp_path / "painting.json")
    text = (tmp_path / "painting.json").read_text()
    lines = [line.strip().rstrip(",") for line in text.splitlines() if '"trajectory"' in line]
    assert [json.loads(line)["id"] for line in lines] == [7, 2, 5]
    assert lines[2] == '{"id": 5, "paint": 1, "trajectory": [[0.01, 0.02, 0.0]]}'
    assert list(json.loads(text)) == ["schema_version", "sheet", "area", "provenance", "brushes", "paints", "strokes"]
    assert json.loads(text)["provenance"]["options"] == {"steps": 9, "ink": None}


def test_a_file_of_the_first_version_is_read_as_one_of_today(tmp_path: Path) -> None:
    painting = a_painting()
    write_painting(painting, tmp_path / "painting.json")
    text = (tmp_path / "painting.json").read_text()
    (tmp_path / "older.json").write_text(text.replace('"schema_version": 2', '"schema_version": 1'))
    assert read_painting(tmp_path / "older.json") == painting


def test_what_a_person_said_of_a_stroke_is_kept(tmp_path: Path) -> None:
    drawn = Stroke(id=3, paint=1, trajectory=((0.01, 0.02, 0.5),), locked=True, origin="person", region="face")
    write_painting(a_painting([drawn]), tmp_path / "painting.json")
    assert read_painting(tmp_path / "painting.json").strokes == (drawn,)


def test_the_order_of_a_hand_is_kept_where_it_is_known(tmp_path: Path) -> None:
    succession = Succession(jump=-1 / 3, distance=0, along=1, parallel=2, same_way=3, unlike=1e-12)
    painting = a_painting().model_copy(update={"succession": succession})
    write_painting(painting, tmp_path / "painting.json")
    assert read_painting(tmp_path / "painting.json") == painting
    assert json.loads((tmp_path / "painting.json").read_text())["succession"]["jump"] == -0.333333333


def test_four_thousand_strokes_are_read_as_they_were_written_to_the_micrometre(tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((4000, 32, 3)) * (0.2, 0.16, 1)
    painting = a_painting([Stroke(id=i, paint=i % 2, trajectory=path) for i, path in enumerate(points.tolist())])
    write_painting(painting, tmp_path / "painting.json")
    again = read_painting(tmp_path / "painting.json")
    assert np.abs(again.trajectories() - points).max() < MICROMETRE


def test_trajectories_repeat_the_last_point_of_shorter_strokes() -> None:
    trajectories = a_painting().trajectories()
    assert trajectories.shape == (3, 3, 3)
    assert trajectories.dtype == np.float64
    assert trajectories[1].tolist() == [[0.01, 0.02, 0.0], [0.03, 0.04, 0.5], [0.03, 0.04, 0.5]]
    assert trajectories[2].tolist() == [[0.01, 0.02, 0.0]] * 3
    assert a_painting([]).trajectories().shape == (0, 1, 3)


def test_a_stroke_of_half_a_million_points_pads_no_other() -> None:
    coil = np.linspace(0.01, 0.1, 500_000)
    long = tuple((x, x, 0.5) for x in coil.tolist())
    painting = a_painting([*(Stroke(id=i, paint=0, trajectory=CURVE) for i in range(900))])
    strokes = (*painting.strokes, Stroke.model_construct(id=900, paint=1, trajectory=long), *painting.strokes[:50])
    painting = painting.model_copy(update={"strokes": strokes})
    parts = list(painting.parts())
    assert [stroke for part in parts for stroke in part.strokes] == list(strokes)
    assert max(part.trajectories().size for part in parts) <= 3 * 2**20
    assert len(parts) <= 4
    assert painting.lengths()[900] == pytest.approx(0.09 * np.sqrt(2))
    assert painting.lengths()[[0, -1]] == pytest.approx(a_painting().lengths()[0])


def test_a_painting_of_usual_strokes_is_one_part_and_an_empty_one_too() -> None:
    for painting in (a_painting(), a_painting([])):
        (part,) = painting.parts()
        assert part == painting


def test_paint_changes_are_counted_in_painting_order() -> None:
    def changes(*paints: int) -> int:
        path = ((0.0, 0.0, 0.0),)
        return a_painting([Stroke(id=i, paint=p, trajectory=path) for i, p in enumerate(paints)], 3).paint_changes()

    assert changes() == changes(1) == changes(2, 2, 2) == 0
    assert changes(0, 0, 1, 1, 2) == 2
    assert changes(0, 1, 0, 1) == 3


def test_metres_are_added_up_for_each_paint() -> None:
    path = ((0.0, 0.0, 0.0), (0.03, 0.04, 0.5), (0.03, 0.05, 1.0))
    painting = a_painting([Stroke(id=i, paint=p, trajectory=path) for i, p in enumerate((2, 0, 2))], 4)
    assert painting.lengths() == pytest.approx([0.06] * 3)
    assert painting.metres_of_paints() == pytest.approx([0.06, 0, 0.12, 0])
    assert a_painting([]).metres_of_paints().tolist() == [0, 0]
    assert a_painting([], 0).metres_of_paints().tolist() == []


def test_a_paint_is_known_by_its_name_where_it_has_one() -> None:
    assert Paint(colour=(0, 0, 1), brush="round").label == "#0000ff"
    assert Paint(colour=(0, 0, 1), brush="round", name="ultramarine").label == "ultramarine #0000ff"


def test_what_a_painting_does_not_have_is_not_in_its_file(tmp_path: Path) -> None:
    """So that a Maulstick that does not know of it can still read the file."""
    write_painting(a_painting(), tmp_path / "painting.json")
    fields = json.loads((tmp_path / "painting.json").read_text())
    assert list(fields["sheet"]) == ["width", "height", "paper"]
    assert list(fields["paints"][0]) == ["colour", "brush"]


def test_a_painting_of_an_older_maulstick_is_read(tmp_path: Path) -> None:
    write_painting(a_painting(), tmp_path / "painting.json")
    fields = json.loads((tmp_path / "painting.json").read_text())
    del fields["provenance"]["metrics"]
    (tmp_path / "old.json").write_text(json.dumps(fields))
    assert read_painting(tmp_path / "old.json") == a_painting()


def test_a_sheet_is_its_paper_s_colour_or_the_picture_of_what_is_on_it(tmp_path: Path) -> None:
    bare = Sheet(width=0.06, height=0.04, paper=(0.25, 0.5, 1.0))
    canvas = Canvas(0.06, 0.04, 500)
    assert bare.image(canvas).dtype == np.float32
    assert bare.image(canvas).shape == (20, 30, 3)
    assert (bare.image(canvas) == (0.25, 0.5, 1.0)).all()
    sheet = Sheet(width=0.06, height=0.04, picture=PNG)
    used = a_painting([]).model_copy(update={"sheet": sheet, "area": (0, 0, 0.06, 0.04)})
    write_painting(used, tmp_path / "painting.json")
    stored = json.loads((tmp_path / "painting.json").read_text())["sheet"]["picture"]
    assert base64.b64decode(stored, validate=True) == PNG
    again = read_painting(tmp_path / "painting.json").sheet
    image = again.image(canvas)
    assert (image.shape, image.dtype) == ((20, 30, 3), np.float32)
    assert image[10, [2, 15, 27]] == pytest.approx(np.array([[0, 0, 0], [1, 1, 1], [0, 0, 0]]), abs=0.02)
    assert again.image(Canvas(0.06, 0.04, 100)) == pytest.approx(STRIPES)


def test_a_picture_on_a_sheet_must_be_a_png() -> None:
    for wrong in (b"", "hello", 3, [1]):
        with pytest.raises(ValidationError):
            Sheet.model_validate({"width": 0.1, "height": 0.1, "picture": wrong})


def test_the_picture_covers_the_whole_canvas_unless_told_otherwise() -> None:
    assert a_painting().area == (0.0, 0.0, 0.2, 0.16)


def test_a_painting_cannot_be_changed() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        a_painting().strokes = ()


def test_a_colour_is_told_as_painters_programs_tell_it() -> None:
    assert hex_colour((0, 0.5, 1)) == Paint(colour=(0, 0.5, 1), brush="round").hex == "#0080ff"


def test_a_picture_whose_name_is_no_text_can_still_be_recorded(tmp_path: Path) -> None:
    latin = b"caf\xe9.jpg".decode(errors="surrogateescape")
    painting = a_painting().model_copy(
        update={"provenance": Provenance(version="1", image=latin, options={"photo": latin})}
    )
    write_painting(painting, tmp_path / "painting.json")
    again = read_painting(tmp_path / "painting.json")
    assert again == painting
    assert (again.provenance.image, again.provenance.options) == ("caf?.jpg", {"photo": "caf?.jpg"})


def test_a_painting_that_cannot_be_written_leaves_the_one_that_was_there(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="its folder does not exist; make the folder first"):
        write_painting(a_painting(), tmp_path / "none" / "painting.json")


def a_jpeg() -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (9, 9)).save(file, format="JPEG")
    return file.getvalue()


def a_bomb(width: int, height: int) -> bytes:
    """A PNG of a few bytes that says it is so large."""
    parts = ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(b"")))
    chunks = [
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body)) for kind, body in parts
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


Damage = Callable[[dict[str, Any]], object]


def of_stroke(index: int, **change: object) -> Damage:
    return lambda painting: painting["strokes"][index].update(change)


def of_picture(content: bytes | str) -> Damage:
    text = content if isinstance(content, str) else base64.b64encode(content).decode()
    return lambda painting: painting["sheet"].update(picture=text)


def of_point(*point: float) -> Damage:
    return lambda painting: painting["strokes"][0]["trajectory"].append(point)


@pytest.mark.parametrize(
    ("damage", "text"),
    [
        (
            lambda p: p.update(schema_version=3),
            "schema_version: it is 3, and this Maulstick reads versions 1 to 2; u",
        ),
        (
            lambda p: p.update(schema_version=0),
            "schema_version: it is 0, and this Maulstick reads versions 1 to 2; w",
        ),
        (lambda p: p.update(schema_version="2"), "schema_version: Input should be 2 (got '2')"),
        (lambda p: p.pop("schema_version"), "schema_version: it is missing; write 2"),
        (lambda p: (p.update(schema_version=9), p["sheet"].clear()), "schema_version: it is 9"),
        (lambda p: p.pop("sheet"), "sheet: Field required"),
        (lambda p: p["sheet"].update(width=0), "sheet.width: Input should be greater than 0 (got 0)"),
        (lambda p: p["sheet"].update(width="wide"), "sheet.width: Input should be a valid number (got 'wide')"),
        (lambda p: p["sheet"].update(paper=[1, 1]), "sheet.paper[2]: Field required"),
        (lambda p: p.update(area=[0.1, 0, 0.2, 0.1]), "area: [0.1, 0.0, 0.2, 0.1] does not lie on the sheet; it must"),
        (
            of_picture("no base64!"),
            "sheet.picture: it is not base64; embed a PNG in base64 (got 'no base64",
        ),
        (of_picture("é"), "sheet.picture: it is not base64; embed a PNG in base64 (got 'é')"),
        (of_picture(b""), "sheet.picture: the picture is not a PNG; save it as one"),
        (of_picture(a_jpeg()), "sheet.picture: the picture is not a PNG; save it as one"),
        (of_picture(PNG[:50]), "sheet.picture: the picture is a damaged PNG: "),
        (of_picture(PNG[:20]), "sheet.picture: the picture is "),
        (of_picture(a_bomb(60_000, 60_000)), "sheet.picture: the picture has more than 4096 pixels on a"),
        (
            of_picture(a_bomb(4097, 1)),
            "sheet.picture: the picture is 4097 x 1 pixels; it must be at most",
        ),
        (lambda p: p["sheet"].update(picture=7), "sheet.picture: Input should be a valid bytes (got 7)"),
        (
            lambda p: p["provenance"].update(metrics={"psnr": float("inf")}),
            "provenance.metrics.psnr: Input should be a finite",
        ),
        (
            lambda p: p["provenance"].update(metrics={"psnr": "high"}),
            "provenance.metrics.psnr: Input should be a valid number",
        ),
        (lambda p: p["paints"][0].update(name=""), "paints[0].name: String should have at least 1 character (got '')"),
        (lambda p: p["provenance"].update(image_sha256="12"), "provenance.image_sha256: String should match pattern"),
        (lambda p: p["provenance"].update(seed=1.5), "provenance.seed: Input should be a valid integer"),
        (
            lambda p: p["provenance"].update(options={"a": [float("nan")]}),
            "provenance.options: Out of range float",
        ),
        (lambda p: p["brushes"]["pen"].update(alpha=-1), "brushes.pen.alpha: Input should be greater than or equal"),
        (lambda p: p["brushes"].pop("pen"), "paints[1].brush: there is no 'pen' in brushes; there are: round"),
        (
            lambda p: p["paints"][0].update(brush="a\nb"),
            "paints[0].brush: a name must be made of printable",
        ),
        (
            lambda p: p["paints"][1].update(colour=[0, 0, 255]),
            "paints[1].colour[2]: Input should be less than or equal",
        ),
        (of_stroke(2, paint=2), "strokes[2].paint: it is 2; it must be an index into the 2 paints, from 0"),
        (of_stroke(2, id=7), "strokes[2].id: 7 is an earlier stroke's; give every stroke its own"),
        (of_stroke(2, id=-1), "strokes[2].id: Input should be greater than or equal to 0 (got -1)"),
        (of_stroke(0, colour="red"), "strokes[0].colour: Extra inputs are not permitted (got 'red')"),
        (of_stroke(0, trajectory=[]), "strokes[0].trajectory: Tuple should have at least 1 item"),
        (of_stroke(1, speed=[0.1]), "strokes[1]: it has 1 speed for 2 points; give one per point"),
        (of_stroke(1, speed=[0.1, 0]), "strokes[1].speed[1]: Input should be greater than 0 (got 0)"),
        (lambda p: p["strokes"][0]["style"].pop("code"), "strokes[0].style.code: Field required"),
        (of_point(0, 0), "strokes[0].trajectory[3][2]: Field required"),
        (of_point(0, 0, 1.2), "strokes[0].trajectory[3][2]: Input should be less than or equal to 1 (got 1.2)"),
        (of_point(0, float("nan"), 1), "strokes[0].trajectory[3][1]: Input should be a finite number (got nan)"),
        (of_point(float("inf"), 0, 1), "strokes[0].trajectory[3][0]: Input should be a finite number (got inf)"),
    ],
)
def test_a_painting_with_a_fault_is_refused_by_file_and_field(tmp_path: Path, damage: Damage, text: str) -> None:
    path = tmp_path / "painting.json"
    write_painting(a_painting(), path)
    content = json.loads(path.read_text())
    damage(content)
    path.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        read_painting(path)
    assert str(caught.value).startswith(f"{path} is not a painting: {text}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("x", "y"), [(-1.0, 80.0), (201.0, 80.0), (100.0, -1.0), (100.0, 161.0)], ids=["left", "right", "above", "below"]
)
def test_a_stroke_off_the_sheet_is_read_within_the_margin_and_refused_by_its_id_beyond(
    tmp_path: Path, x: float, y: float
) -> None:
    path = tmp_path / "painting.json"
    write_painting(a_painting(), path)
    content = json.loads(path.read_text())
    content["strokes"][1]["trajectory"][1][:2] = [x / 1e3, y / 1e3]
    path.write_text(json.dumps(content))
    assert read_painting(path).strokes[1].trajectory[1][:2] == (x / 1e3, y / 1e3)
    further = [number + 0.01 * np.sign(number - middle) for number, middle in ((x, 100), (y, 80))]
    content["strokes"][1]["trajectory"][1][:2] = [number / 1e3 for number in further]
    path.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        read_painting(path)
    assert str(caught.value) == (
        f"{path} is not a painting: stroke 2 reaches 1.01 mm beyond the sheet of 200 x 160 mm, onto a machine's bed; "
        "at most 1 mm is allowed: move the stroke, or give a larger sheet"
    )


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"hello", "the file: Invalid JSON: expected value at line 1 column 1"),
        (b"[1, 2]", "the file: Input should be an object"),
        (b"[" * 100_000, "the file: Invalid JSON: recursion limit exceeded"),
    ],
)
def test_a_file_that_is_something_else_is_refused(tmp_path: Path, content: bytes, text: str) -> None:
    path = tmp_path / "painting.json"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_painting(path)
    assert str(caught.value).startswith(f"{path} is not a painting: {text}")
    assert len(str(caught.value)) < len(str(path)) + 200


@pytest.mark.parametrize("content", [b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", b"GIF89a"])
def test_a_picture_is_said_to_be_one_that_is_planned_first(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "cat"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_painting(path)
    assert str(caught.value) == f"{path} is a picture; plan it first, with maulstick plan {path}"


def test_an_svg_is_no_painting_and_of_a_folder_its_painting_is_named(tmp_path: Path) -> None:
    (tmp_path / "boat.svg").write_text("<svg/>")
    with pytest.raises(
        InputError, match=r"boat\.svg is an SVG, and a painting is needed; name the painting\.json of a"
    ):
        read_painting(tmp_path / "boat.svg")
    write_painting(a_painting(), tmp_path / "painting.json")
    with pytest.raises(InputError, match=rf"is a folder; name {tmp_path}/painting\.json$"):
        read_painting(tmp_path)


def test_a_truncated_painting_is_refused_wherever_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "painting.json"
    write_painting(a_painting(), path)
    whole = path.read_bytes()
    for length in range(1, len(whole) - 2, 97):
        path.write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"is not a painting: the file: Invalid JSON: EOF while parsing"):
            read_painting(path)


def test_a_painting_that_is_missing_empty_a_folder_or_huge_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no painting .*none\.json; check its name and folder"):
        read_painting(tmp_path / "none.json")
    with pytest.raises(InputError, match="is a folder; name the painting itself"):
        read_painting(tmp_path)
    (tmp_path / "empty.json").touch()
    with pytest.raises(InputError, match=r"the painting .*empty\.json is empty"):
        read_painting(tmp_path / "empty.json")
    with (tmp_path / "huge.json").open("wb") as file:
        file.truncate(2**34)  # a hole: it takes no disk
    with pytest.raises(InputError, match=r"huge\.json is larger than 256 MiB; no painting is"):
        read_painting(tmp_path / "huge.json")
