"""Formats of picture files that are read; HEIC, which telephones write, by a library that only such a file loads."""

from pathlib import Path
from typing import Final

FORMATS: Final = ("JPEG", "PNG", "TIFF", "WEBP", "GIF", "BMP", "PPM", "TGA", "JPEG2000", "HEIF")
"""Names of all formats, as Pillow has them."""

_BRANDS = {b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"}  # of ISO 23008-12


def formats_of(path: Path) -> tuple[str, ...]:
    """Return the formats that the file at a path may have, by its first bytes. Raises OSError where it has none."""
    with path.open("rb") as file:
        head = file.read(12)
    if head[4:8] != b"ftyp" or head[8:12] not in _BRANDS:
        return FORMATS[:-1]
    from pi_heif import register_heif_opener

    register_heif_opener()
    return FORMATS[-1:]
