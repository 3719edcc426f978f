"""The contact sheet of a sweep."""

import io
from pathlib import Path

import numpy as np
from PIL import Image

from maulstick.plots.cells import Print, contact_sheet


def sheet_of(prints: list[Print], columns: int) -> Image.Image:
    return Image.open(io.BytesIO(contact_sheet(prints, columns))).convert("RGB")


def test_every_painting_stands_in_its_place_and_one_that_is_missing_leaves_it_free(tmp_path: Path) -> None:
    colours = ["red", "lime", "blue"]
    for colour in colours:
        Image.new("RGB", (640, 320), colour).save(tmp_path / f"{colour}.png")
    prints = [Print(tmp_path / f"{colour}.png", (colour, "")) for colour in colours]
    pixels = np.asarray(sheet_of([prints[0], Print(None, ("none", "it failed")), prints[1], prints[2]], 2))
    assert pixels.shape == (2 * (160 + 48) + 12, 2 * (320 + 12) + 12, 3)
    places = {
        colour: np.argwhere((pixels == Image.new("RGB", (1, 1), colour).getpixel((0, 0))).all(axis=2))
        for colour in colours
    }
    assert all(len(place) == 320 * 160 for place in places.values())
    assert [places[colour].min(axis=0).tolist() for colour in colours] == [[12, 12], [220, 12], [220, 344]]


def test_a_sheet_of_thousands_can_still_be_opened(tmp_path: Path) -> None:
    Image.new("RGB", (64, 64), "red").save(tmp_path / "red.png")
    sheet = sheet_of([Print(tmp_path / "red.png", ("a very long name " * 9, "")), *[Print(None, ("", ""))] * 1199], 12)
    assert max(sheet.size) <= 16_020
