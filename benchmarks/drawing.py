"""How long a large SVG takes to be read and ordered, and how much memory; one JSON object.

    .venv/bin/python benchmarks/drawing.py [--paths N]

name: `svg`, half of whose paths are two Béziers, half three straight lines, on A4 in no order.
megabytes: of the file.  points: of all polylines, to 0.02 mm.
seconds_to_read: by `read_drawing` with the order kept; seconds_to_order: what the quick order takes beside that.
pen_up_before, pen_up: metres between paths in the order of the file, and in the quick one.
memory_mb: the most that the process took, Python and libraries included.
"""

import argparse
import json
import resource
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from maulstick.drawing.options import DrawingOptions
from maulstick.drawing.read import read_drawing
from maulstick.painting.painting import Painting

PAGE = (297.0, 210.0)  # millimetres
SHAPES = ("l1,1 1.5,0 2,-1", "c1,0 2,1 2,2s-1,2 -2,2")


def write_svg(path: Path, paths: int) -> None:
    """Write an SVG of so many paths at random places."""
    places = np.random.default_rng(0).uniform((5, 5), (PAGE[0] - 7, PAGE[1] - 7), (paths, 2))
    lines = [
        f'<path d="M{x:.3f},{y:.3f} {SHAPES[i % 2]}" fill="none" stroke="black" stroke-width="0.3"/>'
        for i, (x, y) in enumerate(places.tolist())
    ]
    size = f'width="{PAGE[0]:g}mm" height="{PAGE[1]:g}mm" viewBox="0 0 {PAGE[0]:g} {PAGE[1]:g}"'
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n' + "\n".join(lines) + "\n</svg>\n")


def timed(path: Path, keep_order: bool) -> tuple[Painting, float]:
    """The painting of an SVG, and the seconds it took."""
    started = time.perf_counter()
    painting = read_drawing(path, DrawingOptions(keep_order=keep_order)).painting
    return painting, time.perf_counter() - started


def pen_up(painting: Painting) -> float:
    """Metres between the strokes."""
    ends = np.array([[s.trajectory[0][:2], s.trajectory[-1][:2]] for s in painting.strokes])
    return float(np.hypot(*(ends[1:, 0] - ends[:-1, 1]).T).sum())


def main(paths: int) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "drawing.svg"
        write_svg(path, paths)
        painting, whole = timed(path, keep_order=False)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        after = pen_up(painting)
        points = sum(len(stroke.trajectory) for stroke in painting.strokes)
        del painting
        plain, reading = timed(path, keep_order=True)
        row = {
            "name": "svg",
            "paths": paths,
            "megabytes": path.stat().st_size / 1e6,
            "points": points,
            "seconds_to_read": reading,
            "seconds_to_order": whole - reading,
            "pen_up_before": pen_up(plain),
            "pen_up": after,
            "memory_mb": memory,
        }
    print(json.dumps({name: round(value, 1) if isinstance(value, float) else value for name, value in row.items()}))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--paths", type=int, default=100_000)
    main(parser.parse_args().paths)
