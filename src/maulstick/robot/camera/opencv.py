"""OpenCV, which only those need who have a camera."""

from typing import Any

from maulstick.errors import InputError


def opencv() -> Any:
    """The module cv2, silent about what is reported in our own words; raises InputError where it is not installed."""
    try:
        import cv2
    except ImportError:
        raise InputError("OpenCV is needed, and not installed; run: pip install 'maulstick[camera]'") from None
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    return cv2
