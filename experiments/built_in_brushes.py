"""Fit the brushes that come with Maulstick to strokes that libmypaint drew, and write them into the package.

    .venv/bin/python experiments/built_in_brushes.py [NAME ...]

The strokes are those of the built-in styles (Wacom's drawings), the ink is libmypaint's: nobody's photographs are
needed, and everything may be shipped. libmypaint's media have no size, so each is drawn with the radius at which it is
about as wide as the real tool of that name. Its tips also trail the pen and feel its speed; a machine's do not, so the
strokes are drawn slowly and only the shape of the mark is fitted. How deep a real tool must be pressed is nominal.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

from media import GENERIC, SPECIAL, mypaint_trials

import maulstick
from maulstick.brush_fit.fit import fit_brush
from maulstick.robot.simulated.mypaint import MEDIA
from maulstick.storage.files import atomic_write

FOLDER = Path(maulstick.__file__).parent / "painting" / "built_in_brushes"
STROKES = 120


@dataclass(frozen=True)
class Recipe:
    """medium: of libmypaint.  tool: what it stands for.  radius, side: metres.  depth: metres at pressure 0 and 1.

    pales: whether a light touch leaves it paler.
    """

    medium: str
    tool: str
    radius: float
    side: float
    depth: tuple[float, float]
    pales: bool = False


RECIPES = {
    "fineliner": Recipe("marker_fat", "a fineliner, which a plotter can only lift", 0.5e-3, 6e-3, (0.0, 0.0)),
    "marker": Recipe("marker", "a bullet-tip permanent marker", 1.2e-3, 36e-3, (0.0, 0.002), pales=True),
    "round": Recipe("acrylic", "a 6 mm round with acrylic", 3.2e-3, 120e-3, (0.0, 0.008)),
    "wash": Recipe("marker", "a 20 mm wash", 8.5e-3, 255e-3, (0.0, 0.005), pales=True),
}


def main() -> None:
    """Fit and write those that are named, or all of them, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", choices=[*RECIPES, []], metavar="NAME")
    for name in parser.parse_args().names or RECIPES:
        recipe = RECIPES[name]
        trials, pixels_per_metre = mypaint_trials(
            recipe.medium,
            (*GENERIC, *SPECIAL),
            STROKES,
            seed=2,
            radius=recipe.radius,
            side=recipe.side,
            speed=recipe.side / 5,
        )
        source = (
            f"{recipe.tool}: fitted to {STROKES} strokes of libmypaint's {MEDIA[recipe.medium]}, not to photographs"
        )
        fit = fit_brush(
            trials,
            pixels_per_metre,
            name,
            source=source,
            depth=recipe.depth,
            additions=("plateau", "curve", "faint") if recipe.pales else ("plateau", "curve"),
        )
        rounded = {key: round(value, 6) for key, value in fit.brush.model_dump().items() if isinstance(value, float)}
        # Nothing was displaced: what is left of the affine error is that of the fit.
        rounded |= {
            "m_x": 1.0,
            "m_y": 1.0,
            "b_x": 0.0,
            "b_y": 0.0,
            "curve": tuple(round(x, 4) for x in fit.brush.curve),
        }
        brush = fit.brush.model_copy(update=rounded)
        atomic_write(FOLDER / f"{name}.json", (brush.model_dump_json(indent=2, exclude_defaults=True) + "\n").encode())
        print(f"{name}: L1 {fit.l1:.4f}, the paper's seven {fit.l1_paper:.4f}, kept {', '.join(fit.kept)}")
        print(brush)


if __name__ == "__main__":
    main()
