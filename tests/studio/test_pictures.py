"""Uploaded pictures: one that is broken or unpacks to too much is refused in one sentence, and leaves nothing."""

import asyncio
import errno
import io
import os
import struct
import zlib
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import patch

import pytest
from PIL import Image

from maulstick.errors import InputError, OutputError
from maulstick.jobs.plan.request import demo_picture
from maulstick.studio.state.folder import Folder
from maulstick.studio.state.gallery import Gallery, keep_picture, picture_of
from maulstick.studio.widgets.uploading import incoming
from maulstick.studio.workers.desk import Desk


def png(width: int, height: int, *chunks: tuple[bytes, bytes], pixels: bytes | None = None) -> bytes:
    """Make a PNG in 8-bit grey. pixels: compressed; of a white picture where left out."""
    if pixels is None:
        pixels = zlib.compress((b"\0" + b"\xff" * width) * height)
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    parts = [(b"IHDR", header), *chunks, (b"IDAT", pixels), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        for kind, content in parts
    )


@cache
def swelling() -> bytes:
    """Compress 64 MiB of zeros into 64 KiB."""
    packer = zlib.compressobj(9)
    return b"".join(packer.compress(bytes(2**20)) for _ in range(64)) + packer.flush()


def cut(kind: str) -> bytes:
    file = io.BytesIO()
    Image.effect_noise((200, 200), 60).convert("RGB").save(file, format=kind)
    return file.getvalue()[: len(file.getvalue()) // 2]


BROKEN = {
    "of 60,000 x 60,000 pixels": lambda: png(60_000, 60_000, pixels=b""),
    "of more pixels than there are numbers": lambda: png(2**31 - 1, 2**31 - 1, pixels=b""),
    "with a profile that swells": lambda: png(4, 4, (b"iCCP", b"icc\0\0" + swelling())),
    "with a text that swells": lambda: png(4, 4, (b"zTXt", b"Comment\0\0" + swelling())),
    "with a text of the world that swells": lambda: png(4, 4, (b"iTXt", b"Comment\0\1\0\0\0" + swelling())),
    "with a thousand texts": lambda: png(4, 4, *[(b"tEXt", b"Comment\0" + bytes(500_000))] * 200),
    "without pixels": lambda: png(4, 4, pixels=b""),
    "that is SVG": lambda: b'<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>',
    "that is HTML": lambda: b"<!doctype html><script>alert(1)</script>",
    "that is PostScript": lambda: b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n(%pipe%id) (r) file\n",
    "that is empty": lambda: b"",
    "that is half a JPEG": lambda: cut("JPEG"),
    "that is half a GIF": lambda: cut("GIF"),
    "that is half a TIFF": lambda: cut("TIFF"),
    "that is half a WebP": lambda: cut("WEBP"),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_picture_is_refused_in_a_sentence_where_it_is_one(tmp_path: Path, kind: str) -> None:
    (tmp_path / "brought").write_bytes(BROKEN[kind]())
    with pytest.raises(InputError) as refused:
        keep_picture(tmp_path / "brought", tmp_path / "kept")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "kept").exists()


def test_a_picture_of_thousands_of_frames_is_its_first(tmp_path: Path) -> None:
    frames = [Image.new("L", (8, 8), i % 2 * 255) for i in range(3000)]
    frames[0].save(tmp_path / "brought", format="GIF", save_all=True, append_images=frames[1:])
    keep_picture(tmp_path / "brought", tmp_path / "kept")
    with Image.open(picture_of(tmp_path / "kept")) as kept:
        assert (kept.size, kept.convert("L").getextrema()) == ((8, 8), (0, 0))


def test_nothing_but_the_pixels_of_a_picture_is_kept(tmp_path: Path) -> None:
    where_taken = Image.Exif()
    where_taken[0x010E] = "<script>alert(1)</script>"
    Image.new("RGB", (600, 20), "red").save(tmp_path / "brought.jpg", exif=where_taken, comment=b"secret")
    keep_picture(tmp_path / "brought.jpg", tmp_path / "kept")
    assert sorted(path.name for path in (tmp_path / "kept").iterdir()) == ["picture.png", "small.jpg"]
    for path in (tmp_path / "kept").iterdir():
        assert b"script" not in path.read_bytes()
        assert b"secret" not in path.read_bytes()
        with Image.open(path) as image:
            assert not image.getexif()


def test_a_picture_comes_along(tmp_path: Path) -> None:
    keep_picture(demo_picture(), tmp_path / "kept")
    with Image.open(tmp_path / "kept" / "small.jpg") as small:
        assert small.size == (480, 480)


def test_of_two_pictures_that_come_at_once_under_one_name_the_first_stays_whole(tmp_path: Path) -> None:
    keep_picture(demo_picture(), tmp_path / "kept")
    before = picture_of(tmp_path / "kept").read_bytes()
    (tmp_path / "brought").write_bytes(png(9, 9))
    with pytest.raises(InputError, match="there is a picture kept meanwhile; use that one, or bring yours again"):
        keep_picture(tmp_path / "brought", tmp_path / "kept")
    assert picture_of(tmp_path / "kept").read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["brought", "kept"]


def test_the_example_picture_comes_once_however_often_it_is_asked_for(tmp_path: Path) -> None:
    async def ask(folder: Folder) -> list[str]:
        gallery = Gallery(folder, desk := Desk())
        try:
            return await asyncio.gather(gallery.keep_portrait(), gallery.keep_portrait())
        finally:
            desk.close()

    with Folder.opened(tmp_path / "studio") as folder:
        assert asyncio.run(ask(folder)) == ["portrait", "portrait"]
        assert folder.names("pictures") == ["portrait"]


def test_a_full_disk_is_told_in_a_sentence_while_a_picture_comes_and_while_it_is_kept(tmp_path: Path) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    sentence = "cannot write into .*: No space left on device; make room for it there"

    async def save(path: Path) -> None:
        path.touch()
        raise full

    async def bring(folder: Folder) -> None:
        file = SimpleNamespace(save=save, name="cat.jpg")
        async with incoming(folder, SimpleNamespace(file=file)):  # type: ignore[arg-type]
            pass

    with Folder.opened(tmp_path / "studio") as folder:
        with pytest.raises(OutputError, match=sentence):
            asyncio.run(bring(folder))
        assert not list(folder.root.glob(".incoming-*"))
        with patch.object(Image.Image, "save", side_effect=full), pytest.raises(OutputError, match=sentence):
            keep_picture(demo_picture(), folder.of("pictures", "cat"))
        assert folder.names("pictures") == []
