import io
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray

from maulstick.errors import InputError, OutputError
from maulstick.storage.arrays import VERSION, kind_of, read_arrays, write_arrays


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("arrays")


def fault(path: Path, kind: str = "leaves", names: tuple[str, ...] = ("a",)) -> str:
    """The one line that a file gets instead of being read, without the file's name."""
    with pytest.raises(InputError) as caught:
        read_arrays(path, kind, names)
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    return text.replace(str(path), "FILE")


def zipped(path: Path, **entries: NDArray[Any] | bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, entry in entries.items():
            content = io.BytesIO()
            if isinstance(entry, bytes):
                content.write(entry)
            else:
                np.lib.format.write_array(content, entry)
            file.writestr(f"{name}.npy", content.getvalue())
    return path


def of_leaves(path: Path, **entries: NDArray[Any] | bytes) -> Path:
    return zipped(path, **{"kind": np.array("leaves"), "version": np.array(VERSION), **entries})


@settings(max_examples=40, deadline=None)
@given(
    arrays(np.float64, array_shapes(min_dims=0, min_side=0, max_dims=3)),
    arrays(np.int64, array_shapes(max_dims=1)),
    st.text(st.characters(categories=("L", "N", "P")), max_size=9),
)
def test_arrays_are_read_as_they_were_written(folder: Path, a: NDArray[Any], b: NDArray[Any], text: str) -> None:
    path = folder / "file.npz"
    write_arrays(path, "leaves", {"a": a, "b": b, "text": np.array(text)})
    again = read_arrays(path, "leaves", ("b", "a", "text"))
    assert list(again) == ["b", "a", "text"]
    assert np.array_equal(again["a"], a, equal_nan=True)
    assert np.array_equal(again["b"], b)
    assert again["a"].dtype == a.dtype
    assert str(again["text"]) == text
    assert kind_of(path) == "leaves"


def test_the_same_arrays_are_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        write_arrays(tmp_path / name, "leaves", {"a": np.arange(5.0)})
    assert (tmp_path / "first").read_bytes() == (tmp_path / "second").read_bytes()


def test_numpy_alone_can_read_the_file(tmp_path: Path) -> None:
    write_arrays(tmp_path / "file.npz", "leaves", {"a": np.arange(5.0)})
    with np.load(tmp_path / "file.npz", allow_pickle=False) as file:
        assert sorted(file) == ["a", "kind", "version"]
        assert file["a"].tolist() == [0, 1, 2, 3, 4]


def test_a_file_that_cannot_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="its folder does not exist; make the folder first"):
        write_arrays(tmp_path / "none" / "file.npz", "leaves", {})


def test_a_file_of_another_kind_or_a_later_version_is_refused(tmp_path: Path) -> None:
    assert fault(zipped(tmp_path / "a", kind=np.array("roots"))) == "FILE holds roots; it must be a file of leaves"
    later = of_leaves(tmp_path / "b", version=np.array(2), a=np.zeros(1))
    assert fault(later) == "FILE is of version 2, and this Maulstick reads 1; write it again"


def test_a_file_without_an_array_is_refused_by_the_name_of_the_array(tmp_path: Path) -> None:
    text = "FILE is not a file of leaves, or it is damaged: \"There is no item named 'a.npy' in the archive\""
    assert fault(of_leaves(tmp_path / "a")) == text
    assert fault(zipped(tmp_path / "b", a=np.zeros(1))).endswith("\"There is no item named 'kind.npy' in the archive\"")
    assert kind_of(tmp_path / "b") is None


def test_what_is_no_zip_is_no_file_of_arrays(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("leaves")
    np.save(tmp_path / "one.npy", np.zeros(3))
    for name in ("text", "one.npy"):
        assert fault(tmp_path / name) == "FILE is not a file of leaves, or it is damaged: File is not a zip file"
        assert kind_of(tmp_path / name) is None


def test_a_file_that_is_not_there_is_said_to_be_missing(tmp_path: Path) -> None:
    assert fault(tmp_path / "none") == "there is no leaves FILE; check its name and folder"
    with pytest.raises(InputError, match=r"there is no file .*none; check its name and folder"):
        kind_of(tmp_path / "none")


def test_pickled_objects_are_never_loaded(tmp_path: Path) -> None:
    class Explodes:
        def __reduce__(self) -> tuple[Any, ...]:
            return (pytest.fail, ("a pickle was loaded",))

    content = io.BytesIO()
    np.lib.format.write_array(content, np.array([Explodes()], dtype=object), allow_pickle=True)
    for name in ("a", "kind", "version"):
        text = fault(of_leaves(tmp_path / name, **{"a": np.zeros(1), name: content.getvalue()}))
        assert text.endswith("Object arrays cannot be loaded when allow_pickle=False")


@pytest.mark.parametrize("array", [np.array(["2020"], "datetime64[Y]"), np.zeros(1, complex), np.zeros(1, "f8,i4")])
def test_arrays_of_neither_numbers_nor_text_are_refused(tmp_path: Path, array: NDArray[Any]) -> None:
    text = f"FILE is not a file of leaves: a is made of {array.dtype}, not of numbers or text"
    assert fault(of_leaves(tmp_path / "file", a=array)) == text


def test_a_zip_bomb_is_refused_by_the_size_that_it_declares(tmp_path: Path) -> None:
    path = of_leaves(tmp_path / "file", a=np.zeros(1))
    content = bytearray(path.read_bytes())
    place = content.rindex(b"PK\x01\x02")  # the last entry of the directory
    content[place + 24 : place + 28] = struct.pack("<I", 3 * 2**30)
    path.write_bytes(content)
    assert fault(path) == "FILE unpacks to 3072 MiB; no leaves is that large"
    with pytest.raises(InputError, match="unpacks to 3072 MiB; no file is that large"):
        kind_of(path)


def test_a_zip_bomb_that_lies_about_its_size_is_read_no_further_than_that(tmp_path: Path) -> None:
    path = of_leaves(tmp_path / "file", a=np.zeros(2**20))
    content = bytearray(path.read_bytes())
    place = content.rindex(b"PK\x01\x02")
    content[place + 24 : place + 28] = struct.pack("<I", 1000)
    path.write_bytes(content)
    assert "FILE is not a file of leaves, or it is damaged: Bad CRC-32" in fault(path)


def test_an_array_that_claims_to_be_larger_than_its_file_is_refused(tmp_path: Path) -> None:
    content = io.BytesIO()
    np.lib.format.write_array_header_1_0(content, {"descr": "<f8", "fortran_order": False, "shape": (2**45,)})
    assert "FILE is not a file of leaves, or it is damaged: " in fault(
        of_leaves(tmp_path / "file", a=content.getvalue())
    )


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_a_damaged_file_is_read_or_refused_in_one_line(folder: Path, data: st.DataObject) -> None:
    path = folder / "damaged.npz"
    write_arrays(path, "leaves", {"a": np.arange(20.0)})
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place : place + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
    path.write_bytes(content or b"\0")
    try:
        assert set(read_arrays(path, "leaves", ("a",))) == {"a"}
    except InputError:
        fault(path)
