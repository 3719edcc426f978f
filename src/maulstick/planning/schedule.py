"""Schedule of a plan: when strokes are sorted, relocated, and given paints."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Schedule:
    """Times at which things happen, each as a share of all steps.

    begins: the share that counts as over at the start, for strokes that are nearly in place already.
    coarse: until the first the canvas is drawn on coarse pixels, until the second on ones half as large.
    fine: from then on it is drawn on fine pixels, where its own misjudge it.
    sorts: strokes are put in order from light to dark.  relocations: the strokes that would be missed least are moved.
    quantise: free colours become paints; with `grouped`, all strokes of a paint are then painted together.
    repaints: strokes take other paints of a palette where that is better.
    """

    begins: float = 0.0
    coarse: tuple[float, float] = (0.3, 0.5)
    fine: float = 0.9
    sorts: tuple[float, ...] = tuple(0.025 * i for i in range(24))
    relocations: tuple[float, ...] = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
    quantise: float = 0.6
    repaints: tuple[float, ...] = ()
    grouped: bool = True


REPLAN = Schedule(begins=0.3, coarse=(0.0, 0.0), sorts=(), relocations=(), quantise=0.3, repaints=(0.5, 0.6, 0.7, 0.8))
"""Schedule for strokes that were planned before, when the sheet looks other than planned: they are nearly in place.

None is moved elsewhere: so late, that spoils more than it mends.
"""

IN_INK = Schedule(relocations=(0.05, 0.1, 0.15, 0.2, 0.3))
"""Schedule for inks: none is moved late, for it cannot take the colour of its place and needs longer to suit it."""

GIVEN_PAINTS = Schedule(quantise=0.35, repaints=tuple(0.4 + 0.05 * i for i in range(10)))
"""Schedule for a palette: its paints may be far from the colours that strokes would choose, so shapes need longer."""
