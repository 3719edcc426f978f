"""libmypaint through ctypes: a brush engine independent of ours, for experiments and the simulator's sheet.

The library is ISC, its brushes are CC0; both come from Debian and are loaded only when a sheet is made.
"""

import colorsys
import ctypes
import json
import math
import weakref
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from maulstick.errors import InputError
from maulstick.painting.raster import Canvas
from maulstick.storage.arrays import Floats, Image
from maulstick.strokes.strokes import path_lengths, resample

MEDIA = {
    "acrylic": "tanda/acrylic-04-paint",
    "brush": "classic/brush",
    "marker": "ramon/Marker",
    "marker_fat": "classic/marker_fat",
}
"""Names of the media, and the file of each among libmypaint's brushes."""

_LIBRARY = "libmypaint-1.5.so.1"
_BRUSHES = Path("/usr/share/mypaint-data/2.0/brushes")  # those of 1.0 expect the speeds of an older library
_TILE, _ONE = 64, 1 << 15  # pixels per side of a tile; 1.0 in libmypaint's fixed point
_SCREEN = 96 / 0.0254  # pixels per metre of the screens that the brushes were made on
_PERIOD = 2e-3  # seconds between two reports of the pen's place
_LIFTED = 10.0  # seconds above the first point; without them some media draw a trail from the corner of the sheet
_STAY = 0.25  # seconds on the last point: some media lag behind the pen by 45 ms, and still have to reach it
_SLOWEST = 1e-3  # metres per second: the slowest stroke accepted, which bounds the number of reports


class _TileRequest(ctypes.Structure):
    _fields_ = (
        ("tx", ctypes.c_int),
        ("ty", ctypes.c_int),
        ("readonly", ctypes.c_int),
        ("buffer", ctypes.POINTER(ctypes.c_uint16)),
        ("context", ctypes.c_void_p),
        ("thread_id", ctypes.c_int),
        ("mipmap_level", ctypes.c_int),
    )


_P, _I, _F = ctypes.c_void_p, ctypes.c_int, ctypes.c_float
_SIGNATURES = {
    "mypaint_init": (None, ()),
    "mypaint_brush_new": (_P, ()),
    "mypaint_brush_unref": (None, (_P,)),
    "mypaint_brush_from_defaults": (None, (_P,)),
    "mypaint_brush_from_string": (_I, (_P, ctypes.c_char_p)),
    "mypaint_brush_stroke_to": (_I, (_P, _P, _F, _F, _F, _F, _F, ctypes.c_double)),
    "mypaint_fixed_tiled_surface_new": (_P, (_I, _I)),
    "mypaint_fixed_tiled_surface_interface": (_P, (_P,)),
    "mypaint_surface_unref": (None, (_P,)),
    "mypaint_surface_begin_atomic": (None, (_P,)),
    "mypaint_surface_end_atomic": (None, (_P, _P)),
    "mypaint_tile_request_init": (None, (ctypes.POINTER(_TileRequest), _I, _I, _I, _I)),
    "mypaint_tiled_surface_tile_request_start": (None, (_P, ctypes.POINTER(_TileRequest))),
    "mypaint_tiled_surface_tile_request_end": (None, (_P, ctypes.POINTER(_TileRequest))),
}


class MyPaintPaper:
    """Sheet that libmypaint draws on: white until another is laid."""

    def __init__(self, canvas: Canvas) -> None:
        """Make a sheet of the canvas' size. Raises InputError where libmypaint or its brushes are not installed."""
        self.canvas = canvas
        self._library = _library(_LIBRARY)
        if not brushes_exist():
            raise _not_installed()
        surface = self._library.mypaint_fixed_tiled_surface_new(canvas.width_px, canvas.height_px)
        weakref.finalize(self, self._library.mypaint_surface_unref, surface)
        self._surface = self._library.mypaint_fixed_tiled_surface_interface(surface)
        for _, tile in self._tiles():
            tile[:] = _ONE  # opaque white; a new surface comes filled with 0xffff, which is no colour

    def draw(
        self,
        trajectory: Floats,
        medium: str,
        *,
        radius: float,
        colour: tuple[float, float, float] = (0.0, 0.0, 0.0),
        speed: float = 0.05,
    ) -> None:
        """Draw a trajectory (n, 3), metres and pressure in [0, 1], at a constant speed in metres per second.

        radius: the medium's base radius, metres; the medium decides how wide its mark is at each pressure.
        colour: sRGB in [0, 1].
        The same strokes make the same picture on every sheet. What lies beside the sheet is lost, and a stroke
        without length leaves no mark, except by a medium that flows while it rests (brush).
        Raises InputError for a medium that does not exist, and for numbers that cannot be drawn.
        """
        if medium not in MEDIA:
            raise InputError.of_choice("medium", medium, MEDIA)
        if not (math.isfinite(radius) and radius > 0):
            raise InputError.of_range("the radius", radius, "above 0 metres")
        if not (math.isfinite(speed) and speed >= _SLOWEST):
            raise InputError.of_range("the speed", speed, f"at least {_SLOWEST:g} metres per second")
        reports = self._reports(trajectory, speed)
        brush = self._brush(medium, radius, colour)
        library, surface = self._library, self._surface
        tick = _PERIOD * self._slowdown
        try:
            library.mypaint_surface_begin_atomic(surface)
            x, y, _ = reports[0]
            library.mypaint_brush_stroke_to(brush, surface, x, y, 0.0, 0.0, 0.0, _LIFTED * self._slowdown)
            for x, y, pressure in reports:
                library.mypaint_brush_stroke_to(brush, surface, x, y, pressure, 0.0, 0.0, tick)
            library.mypaint_surface_end_atomic(surface, None)
        finally:
            library.mypaint_brush_unref(brush)

    def lay(self, picture: Image) -> None:
        """Put a picture (height_px, width_px, 3), sRGB in [0, 1], on the sheet, in place of what is there."""
        for (top, left), tile in self._tiles():
            part = picture[top : top + _TILE, left : left + _TILE]
            tile[: part.shape[0], : part.shape[1], :3] = (part * _ONE).round()

    def photograph(self) -> Image:
        """Return the sheet as it is now, (height_px, width_px, 3) sRGB in [0, 1]."""
        width, height = self.canvas.width_px, self.canvas.height_px
        picture = np.empty((height, width, 3), dtype=np.float32)
        for (top, left), tile in self._tiles():
            part = picture[top : top + _TILE, left : left + _TILE]
            part[:] = tile[: part.shape[0], : part.shape[1], :3]
        picture /= _ONE
        return picture

    @property
    def _slowdown(self) -> float:
        """Factor by which time is stretched for the brush.

        It measures speed in pixels per second; with time stretched like lengths, a medium is the same at every
        resolution.
        """
        return self.canvas.pixels_per_metre / _SCREEN

    def _reports(self, trajectory: Floats, speed: float) -> list[list[float]]:
        """Return places in pixels and pressure, (m, 3), one per period. Raises InputError for a bad trajectory."""
        path = np.array(trajectory, dtype=np.float64)
        if path.ndim != 2 or path.shape[0] < 1 or path.shape[1] != 3:
            raise InputError(f"a trajectory has shape {path.shape}; it must be (n, 3) with n of at least 1")
        if not np.isfinite(path).all():
            raise InputError("a point of the trajectory is not a finite number")
        if path[:, 2].min() < 0 or path[:, 2].max() > 1:
            raise InputError.of_range("pressure", f"{path[:, 2].min():g} to {path[:, 2].max():g}", "in [0, 1]")
        reach = max(self.canvas.width, self.canvas.height)  # libmypaint's memory grows with the distance
        path[:, :2] = path[:, :2].clip(-reach, 2 * reach)
        moving = resample(path, 1 + math.ceil(float(path_lengths(path[:, :2])) / (speed * _PERIOD)))
        moving[:, :2] *= self.canvas.pixels_per_metre
        staying = np.repeat(moving[-1:], round(_STAY / _PERIOD), axis=0)
        reports: list[list[float]] = np.concatenate([moving, staying]).tolist()
        return reports

    def _brush(self, medium: str, radius: float, colour: tuple[float, float, float]) -> int:
        """Make a brush, to be released by the caller; each starts with the same random numbers."""
        made = json.loads(_settings_of(medium).read_bytes())
        base = {
            "radius_logarithmic": math.log(radius * self.canvas.pixels_per_metre),
            **dict(zip(("color_h", "color_s", "color_v"), colorsys.rgb_to_hsv(*colour), strict=True)),
        }
        for setting, stretched in (("slow_tracking", 1), ("speed1_slowness", 1), ("dabs_per_second", -1)):
            base[setting] = made["settings"][setting]["base_value"] * self._slowdown**stretched
        for setting, value in base.items():
            made["settings"][setting]["base_value"] = value
        brush: int = self._library.mypaint_brush_new()
        self._library.mypaint_brush_from_defaults(brush)
        self._library.mypaint_brush_from_string(brush, json.dumps(made).encode())
        return brush

    def _tiles(self) -> Iterator[tuple[tuple[int, int], NDArray[np.uint16]]]:
        """Yield (top, left) in pixels of each tile, and its (64, 64, 4) premultiplied sRGB and alpha, writable."""
        request = _TileRequest()
        for top in range(0, self.canvas.height_px, _TILE):
            for left in range(0, self.canvas.width_px, _TILE):
                self._library.mypaint_tile_request_init(request, 0, left // _TILE, top // _TILE, 0)
                self._library.mypaint_tiled_surface_tile_request_start(self._surface, request)
                yield (top, left), np.ctypeslib.as_array(request.buffer, (_TILE, _TILE, 4))
                self._library.mypaint_tiled_surface_tile_request_end(self._surface, request)


def library_loads() -> bool:
    """Return whether the library is installed."""
    try:
        ctypes.CDLL(_LIBRARY)
    except OSError:
        return False
    return True


def brushes_exist() -> bool:
    """Return whether the library's brushes are installed."""
    return all(_settings_of(medium).is_file() for medium in MEDIA)


@cache
def _library(name: str) -> ctypes.CDLL:
    try:
        library = ctypes.CDLL(name)
    except OSError as error:
        raise _not_installed() from error
    for function, (result, arguments) in _SIGNATURES.items():
        declared = getattr(library, function)
        declared.restype, declared.argtypes = result, arguments
    library.mypaint_init()
    _hush_c()
    return library


def _hush_c() -> None:
    """Let what C prints go nowhere; what Python prints stays.

    Where rounding leaves a step of no time libmypaint prints that time is running backwards, goes on as it should, and
    that line would stand among those of a command, or in what a script reads.
    """
    c = ctypes.CDLL(None)
    c.fopen.restype = ctypes.c_void_p
    try:
        ctypes.c_void_p.in_dll(c, "stdout").value = c.fopen(b"/dev/null", b"w")
    except ValueError:  # another C library than Debian's has no variable of that name
        return


def _settings_of(medium: str) -> Path:
    return _BRUSHES / f"{MEDIA[medium]}.myb"


def _not_installed() -> InputError:
    return InputError(
        "libmypaint or its brushes are not installed; run: apt-get install libmypaint-1.5-1 mypaint-brushes"
    )
