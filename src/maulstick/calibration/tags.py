"""Detection of the tags beside the sheet in a photograph."""

import numpy as np

from maulstick.colour.srgb import light_of
from maulstick.robot.camera.opencv import opencv
from maulstick.robot.camera.tag_frame import MODULES, TAGS
from maulstick.storage.arrays import Floats, Image

_ALONG, _ACROSS = 48, 33  # samples along a side, and across it from the tag's black to its white
_ENDS = 0.1  # share of a side at either end that is left out, as the other sides are near
_FLAT = 6  # samples at either end across a side that are all black or all white


def found_tags(photo: Image) -> dict[int, Floats]:
    """Find the corners (4, 2) of each of the tags 0 to 3 that is seen exactly once, in the order of `TagFrame.corners`.

    photo: (H, W, 3) sRGB in [0, 1].  The corners are in pixels; pixel centres are whole numbers.
    """
    cv2 = opencv()
    light = cv2.cvtColor(light_of(photo), cv2.COLOR_RGB2GRAY)
    seen = _seen(photo)
    return {tag: _refined(light, places[0] - 0.5) for tag, places in seen.items() if len(places) == 1}


def repeated_tags(photo: Image) -> list[int]:
    """Return which of the tags 0 to 3 are seen more than once in a photograph (H, W, 3), sRGB in [0, 1]."""
    return [tag for tag, places in _seen(photo).items() if len(places) > 1]


def is_mirrored(photo: Image) -> bool:
    """Return whether any tag 0 to 3 is seen in the mirror image of a photograph (H, W, 3), sRGB in [0, 1]."""
    return any(_seen(np.ascontiguousarray(photo[:, ::-1])).values())


def _seen(photo: Image) -> dict[int, list[Floats]]:
    """Return where each of the tags 0 to 3 is seen, corners (4, 2) from the pixels' upper left edges, roughly."""
    cv2 = opencv()
    options = cv2.aruco.DetectorParameters()
    options.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_APRILTAG
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36H11)
    grey = cv2.cvtColor(np.round(photo * 255).astype(np.uint8), cv2.COLOR_RGB2GRAY)
    corners, names, _ = cv2.aruco.ArucoDetector(family, options).detectMarkers(grey)
    found = [] if names is None else zip(np.ravel(names).tolist(), corners, strict=True)
    seen: dict[int, list[Floats]] = {tag: [] for tag in TAGS}
    for name, place in found:
        if name in seen:
            seen[name].append(place[0].astype(np.float64))
    return seen


def _refined(light: Image, corners: Floats) -> Floats:
    """Refine corners (4, 2), by straight sides where the light (H, W) is half way between black and white.

    That is done in linear light: in sRGB a pixel that is half white is nearly white, and tags would seem smaller.
    """
    lines = [_side(light, start, end) for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    crossing = zip(lines[-1:] + lines[:-1], lines, strict=True)
    return np.array([np.linalg.solve(np.stack([n1, n2]), [d1, d2]) for (n1, d1), (n2, d2) in crossing])


def _side(light: Image, start: Floats, end: Floats) -> tuple[Floats, float]:
    """Return the normal (2,) of a tag's side, and the side's distance from the origin along it, pixels."""
    length = np.linalg.norm(end - start)
    outward = np.array([end[1] - start[1], start[0] - end[0]]) / length
    reach = length / MODULES / 2
    along = start + np.linspace(_ENDS, 1 - _ENDS, _ALONG)[:, None] * (end - start)
    samples = along[:, None] + np.linspace(-reach, reach, _ACROSS)[:, None] * outward
    profiles = sampled(light, samples)
    black = profiles[:, :_FLAT].mean(axis=1, keepdims=True)
    white = profiles[:, -_FLAT:].mean(axis=1, keepdims=True)
    bright = ((profiles - black) / np.maximum(white - black, 1e-3)).mean(axis=1, keepdims=True).clip(0, 1)
    edge = along + (1 - 2 * bright) * reach * outward
    middle = edge.mean(axis=0)
    normal = np.linalg.svd(edge - middle)[2][1]
    return normal, float(normal @ middle)


def sampled(image: Image, points: Floats) -> Image:
    """Sample the image (H, W) or (H, W, C) at points (..., N, 2), x and y in pixels, linearly between pixels."""
    cv2 = opencv()
    flat = np.ascontiguousarray(points.reshape(-1, points.shape[-2], 2), dtype=np.float32)
    values = cv2.remap(image, flat, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(values.reshape(*points.shape[:-1], *image.shape[2:]))
