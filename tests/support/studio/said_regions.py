"""Regions as a person says them on the canvas, without a canvas."""

from maulstick.studio.workers.said import SaidRegion, map_colours


def region(id: int, outline: list[tuple[float, float]], **fields: object) -> SaidRegion:
    """Make a region of one outline, metres, with a name and a colour by its id."""
    said = {"id": id, "name": f"region {id}", "colour": map_colours()[id], "area": [[outline]], **fields}
    return SaidRegion.model_validate(said)


def box(left: float, top: float, right: float, bottom: float) -> list[tuple[float, float]]:
    """Return the corners of a box, metres."""
    return [(left, top), (right, top), (right, bottom), (left, bottom)]
