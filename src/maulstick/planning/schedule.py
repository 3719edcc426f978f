"""What happens when while a plan is made."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Schedule:
    """When what happens, each as a share of all steps.

    begins: for strokes that are nearly there already, planning begins as if this share were over.
    sorts: strokes are put in order from light to dark.  relocations: the strokes that would be missed least begin anew.
    quantise: free colours become paints; with `grouped`, all strokes of a paint then stand together.
    repaints: of paints that are given, strokes take others where that is better.
    """

    begins: float = 0.0
    sorts: tuple[float, ...] = tuple(0.025 * i for i in range(24))
    relocations: tuple[float, ...] = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
    quantise: float = 0.6
    repaints: tuple[float, ...] = ()
    grouped: bool = True


AGAIN = Schedule(begins=0.6, sorts=(), relocations=(0.6, 0.64), quantise=0.68, repaints=(0.75, 0.85))
"""Strokes that were planned before, on a sheet that has become another than was thought."""

GIVEN_PAINTS = Schedule(quantise=0.35, repaints=tuple(0.4 + 0.05 * i for i in range(10)))
"""Paints that are given may be far from the colours that strokes would choose, so shapes need longer to adapt."""
