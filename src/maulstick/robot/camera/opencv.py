"""The optional import of OpenCV, which only cameras need."""

from typing import Any

from maulstick.errors import InputError, how_to_add


def opencv() -> Any:
    """Return the module cv2, with its own log switched off. Raises InputError where it is not installed."""
    try:
        import cv2
    except ImportError:
        raise InputError(f"OpenCV is needed, and not installed; {how_to_add('camera')}") from None
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    return cv2
