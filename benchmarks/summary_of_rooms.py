"""Figures of the ledger that belong to one room each: hands, brushes, machines, exports, the studio; for summary.py.

hand_distance: what is learned from 20 strokes of the five mocap sessions, one seed: energy distance to the session's
    other strokes, 0 those 20 themselves, 1 other people; as in `style.py few_shot`.
brush_error_ratio: error of a brush fitted to 60 strokes of libmypaint's acrylic, over that of the paper's seven
    numbers, on strokes that taught nothing; as in `brush.py fit`.
time_error_percent: the worst error of estimated times, beside dialogues with the real Grbl; as in `robot.py time`.
export_ms, export_kb: the boat of docs/gallery, hatched at 1.4 mm, in a quick order, to G-code: seconds of the
    processor, the least of five, and its text.
help_ms: of the processor, for `maulstick --help`, the least of five.
studio_mb: memory of the studio's server, once it has answered with its first page.
"""

import os
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from http.cookiejar import CookieJar
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.request import HTTPCookieProcessor, build_opener

import numpy as np
import torch
from few_shot import DRAWN, sessions_of
from kept import ROOT
from recordings import mocap_hands
from robot_time import rows as rows_of_time

from maulstick.brush_fit.fit import fit_brush
from maulstick.drawing.options import DrawingOptions
from maulstick.jobs.export import ExportOptions, exported
from maulstick.jobs.paintable import read_paintable
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.store import load_hands

sys.path.append(str(ROOT / "experiments"))  # scripts there are not installed
from media import GENERIC, mypaint_trials

MEDIUM, TRIALS, RUNS = "acrylic", 60, 5
BOAT, HATCH = ROOT / "docs" / "gallery" / "boat.svg", 1.4e-3  # metres
COMMAND = Path(sys.executable).parent / "maulstick"


def hands() -> dict[str, float]:
    """Learn from twenty strokes of each session, and compare what is drawn then with the rest."""
    distances = []
    for session in sessions_of(mocap_hands()):
        few = session.few(0)
        style = Exemplar.fit("hand", Hand.of(few.strokes), load_hands())
        with torch.no_grad():
            codes, _ = style.sample(DRAWN, torch.Generator().manual_seed(0))
            drawn = few.compare(style.decode(codes).double().numpy())
        distances.append([each.energy for each in (drawn, few.floor, few.other_people)])
    energy, floor, other_people = np.mean(distances, axis=0)
    return {"hand_distance": float((energy - floor) / (other_people - floor))}


def brushes() -> dict[str, float]:
    """Fit a brush to strokes of libmypaint."""
    trials, scale = mypaint_trials(MEDIUM, GENERIC, TRIALS, seed=0)
    found = fit_brush(trials, scale, MEDIUM, source="benchmarks/summary_of_rooms.py")
    return {"brush_error_ratio": found.l1 / found.l1_paper}


def machines() -> dict[str, float]:
    """Estimate the times of the four dialogues."""
    return {"time_error_percent": 100 * max(abs(float(str(row["error"]))) for row in rows_of_time(quick=True))}


def exports() -> dict[str, float]:
    """Read an SVG, and write it as G-code."""
    painting = read_paintable(BOAT, DrawingOptions(hatch=HATCH)).painting
    (file,) = exported(painting, ExportOptions()).files
    seconds = []
    for _ in range(RUNS):
        started = time.process_time()
        exported(painting, ExportOptions())
        seconds.append(time.process_time() - started)
    return {"export_ms": 1e3 * min(seconds), "export_kb": len(file.text.encode()) / 1e3}


def command_line() -> dict[str, float]:
    """Ask for help."""
    seconds = []
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([COMMAND, "--help"], stdout=subprocess.DEVNULL, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return {"help_ms": 1e3 * min(seconds)}


def studio() -> dict[str, float]:
    """Start the studio in an empty folder, and read its first page."""
    with TemporaryDirectory() as folder:
        words = [str(COMMAND), "studio", folder, "--port", "0", "--no-browser"]
        data = {**os.environ, "XDG_DATA_HOME": f"{folder}/data"}
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=data) as server:
            assert server.stdout is not None
            link = next(line.strip() for line in server.stdout if "?token=" in line)
            build_opener(HTTPCookieProcessor(CookieJar())).open(link).read()
            (kib,) = re.findall(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{server.pid}/status").read_text())
            server.terminate()
    return {"studio_mb": float(kib) * 1.024e-3}


PARTS: dict[str, Callable[[], dict[str, float]]] = {
    "hands": hands,
    "brushes": brushes,
    "machines": machines,
    "exports": exports,
    "command_line": command_line,
    "studio": studio,
}
