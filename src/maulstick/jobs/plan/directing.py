"""What a person says of places on the picture, by the files that options name: regions, and lines as guides."""

from collections.abc import Mapping, Sequence

from maulstick.errors import InputError, option
from maulstick.jobs.plan.guide_files import GuideFile, painted_guides
from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.region_files import RegionFiles
from maulstick.painting.brush import Brush
from maulstick.painting.painting import Painting
from maulstick.planning.guides import Guides
from maulstick.planning.layout import Layout
from maulstick.planning.problem import Colour
from maulstick.planning.regions import Regions
from maulstick.storage.arrays import Floats
from maulstick.style import Style


class Directing:
    """Regions and guides of options, as far as they name any. Raises InputError for a file that cannot be used.

    shape: (h, w) of the picture that both are stretched over.  margin: metres around it.
    """

    def __init__(self, options: PlanOptions, shape: tuple[int, ...], margin: float) -> None:
        self._regions = RegionFiles(options.regions, options.say) if options.regions and options.say else None
        self._guides = GuideFile(options.guides) if options.guides else None
        self._shape, self._fit, self._margin = shape, options.fit, margin

    def brushes(self, usual: Sequence[Brush]) -> tuple[Brush, ...]:
        """Return the usual brushes, and those that regions use beside them, the broadest first."""
        return tuple(usual) if self._regions is None else self._regions.brushes(usual)

    @property
    def colours(self) -> tuple[Colour, ...]:
        """Colours that regions are painted in alone, sRGB in [0, 1]."""
        return () if self._regions is None else self._regions.colours

    def painted_colours(self, layout: Layout, brush: Brush, regions: Regions | None) -> tuple[Colour, ...]:
        """Return the colours of guides that are painted by this brush, sRGB in [0, 1], each once."""
        return tuple(dict.fromkeys(colour for colour, _ in self._pieces(layout, brush, regions)))

    @property
    def painted_sum(self) -> str | None:
        """Sum of guides that are painted, as of `GuideFile`."""
        return None if self._guides is None else self._guides.painted_sum

    def check_windows(self) -> None:
        """Raise InputError for what is not planned in windows."""
        for name, given in (("regions", self._regions), ("guides", self._guides)):
            if given is not None:
                raise InputError(f"{option(name)} plans in one piece; choose a smaller {option('px')}")

    def regions(
        self, layout: Layout, hand: Style, hand_size: float, brushes: Sequence[Brush], usual: Sequence[Brush]
    ) -> Regions | None:
        """Return the regions on a layout; arguments as those of `RegionFiles.on`."""
        if self._regions is None:
            return None
        return self._regions.on(layout.canvas, self._shape, self._fit, self._margin, hand, hand_size, brushes, usual)

    def guides(self, layout: Layout, regions: Regions | None) -> Guides | None:
        """Return the directions that guides and regions say. Raises InputError where regions follow no guides."""
        said = () if regions is None else regions.said
        for region in said:
            if region.follows_guides and self._guides is None:
                raise InputError(
                    f"{region.name} is to follow guides, and there are none; name them: {option('guides')}"
                )
        if self._guides is None and all(region.angle is None for region in said):
            return None
        lines = []
        if self._guides is not None:
            lines = self._guides.lines_on(layout.canvas, self._shape, self._fit, self._margin)
        return Guides.of(layout.canvas, lines, regions)

    def painted(
        self,
        layout: Layout,
        brush: Brush,
        paints: Sequence[Colour],
        names: Mapping[str, str],
        regions: Regions | None,
    ) -> Painting | None:
        """Return the guides that are painted, as `painted_guides` does, off paper that regions leave bare."""
        return painted_guides(self._pieces(layout, brush, regions), layout, brush, paints, names)

    def _pieces(self, layout: Layout, brush: Brush, regions: Regions | None) -> list[tuple[Colour, Floats]]:
        """Return what is painted of the guides, as `GuideFile.pieces`, off paper that regions leave bare."""
        if self._guides is None:
            return []
        bare = None if regions is None else regions.bare_paper
        return self._guides.pieces(layout, self._shape, self._fit, self._margin, brush, bare)
