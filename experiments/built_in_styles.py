"""Learn the styles that come with Maulstick from the Wacom drawings, and what all their hands have in common.

    .venv/bin/python experiments/built_in_styles.py

A drawing mixes several ways of drawing; a style is one of them, told by how its strokes are described. Two more are
whole drawings, with all ways of drawing in them and with how their strokes are arranged.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from wacom import wacom_hands

import maulstick
from maulstick.strokes.strokes import Strokes
from maulstick.style.compare import describe
from maulstick.style.exemplar import Exemplar
from maulstick.style.hand import Hand
from maulstick.style.pooled import PooledHands, pool
from maulstick.style.store import write_hands, write_style

BUILT_IN = Path(maulstick.__file__).parent / "style" / "built_in"
MOST = 80

Floats = NDArray[np.float64]
Chosen = NDArray[np.bool_]
Rule = Callable[[Floats, Floats, Floats, Floats], Chosen]
"""From length in mm, chord over length, turning, and its sum, to whether a stroke belongs."""

STYLES: dict[str, tuple[tuple[str, ...], Rule]] = {
    "hatching": (
        ("eiffel_tower", "elephant", "moscow", "sydney_opera", "wine"),
        lambda mm, chord, turning, turn: (mm > 8) & (mm < 45) & (chord > 0.97),
    ),
    "loops": (
        ("moscow", "wine", "boots", "coffee", "monkey", "ship", "1-value-of-ink-1", "2-digital-ink-is-processable-1"),
        lambda mm, chord, turning, turn: (
            (mm > 6) & (mm < 60) & (np.abs(turn) > 4.5) & (chord < 0.35) & (np.abs(turn) > 0.8 * turning)
        ),
    ),
    "scribble": (
        ("chocolate_cake", "earth", "moscow", "sydney_opera", "elephant", "wine"),
        lambda mm, chord, turning, turn: (mm > 40) & (mm < 250) & (turning > 12) & (np.abs(turn) < 0.6 * turning),
    ),
    "contour": (
        ("ball", "apple", "laptop", "monkey", "coffee", "fish", "elephant", "fuji"),
        lambda mm, chord, turning, turn: (mm > 30) & (mm < 200) & (turning < 6),
    ),
    "marks": (("animal",), lambda mm, chord, turning, turn: (mm > 1.5) & (mm < 9) & (chord > 0.5)),
    "cursive": (
        ("3-digital-ink-1", "4-hello-world-1", "5-cell-structure-1", "math-structures"),
        lambda mm, chord, turning, turn: (mm > 9) & (mm < 40) & (turning > 6) & (chord < 0.9),
    ),
}
WHOLE = ("elephant", "moscow")
"""Styles that are drawings: those of most strokes, but for `animal`, which `marks` has."""


def main() -> None:
    """Write all files."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    drawings = wacom_hands()
    hands = pool([Hand.of(strokes) for strokes in drawings.values()])
    write_hands(hands, BUILT_IN)
    for name, (sources, rule) in STYLES.items():
        strokes = _joined([_chosen(drawings[source], rule) for source in sources])
        rows = np.random.default_rng(0).permutation(len(strokes))[:MOST]
        hand = replace(Hand.of(strokes[np.sort(rows)]), poses=None)  # of several documents, with gaps between them
        _write(name, hand, hands, sources)
    for name in WHOLE:
        _write(name, Hand.of(drawings[name]), hands, (name,))


def _write(name: str, hand: Hand, hands: PooledHands, sources: tuple[str, ...]) -> None:
    style = Exemplar.fit(name, hand, hands)
    write_style(style, f"Wacom universal-ink-library 2.1.2, Apache-2.0: {', '.join(sources)}", BUILT_IN)
    arranged = "unknown" if style.arrangement is None else f"{len(style.arrangement.groups)} groups"
    print(f"{name}: {len(hand)} strokes, freedom {style.freedom}, arrangement {arranged}")


def _chosen(strokes: Strokes, rule: Rule) -> Strokes:
    described = describe(strokes.trajectories[..., :2])
    return strokes[rule(strokes.lengths * 1e3, described[:, 1], described[:, 2], described[:, 3])]


def _joined(parts: list[Strokes]) -> Strokes:
    return Strokes(
        np.concatenate([part.trajectories for part in parts]),
        np.concatenate([part.times for part in parts]),
        np.concatenate([part.poses for part in parts]),
    )


if __name__ == "__main__":
    main()
