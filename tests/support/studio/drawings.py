"""SVGs that people bring to the studio."""

INKSCAPE = 'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'


def svg(inside: str, width: float = 60, height: float = 40) -> str:
    """Write an SVG whose user unit is a millimetre."""
    size = f'width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {INKSCAPE} {size}>{inside}</svg>'


ROWS = 24
"""Number of lines of `COMB`."""

COMB = svg("".join(f'<path d="M 5 {y + 5} H 35" stroke="#1f5fa8"/>' for y in range(ROWS)))
"""Lines of 30 mm, 0.4 s each at an arm's pace."""

BOAT = svg(
    '<g inkscape:groupmode="layer" inkscape:label="1 sea"><path d="M 5 30 H 70" fill="none" stroke="#1f5fa8"/></g>'
    '<g inkscape:groupmode="layer" inkscape:label="2 hull"><path d="M 20 20 H 40 V 28 H 20 Z" fill="#8c3d26"/></g>'
)
"""Drawing of two pens, with a line that reaches beyond its page, and a shape that is filled."""

WITH_TEXT = svg('<text x="5" y="10">Hello</text>')
"""Drawing that is refused."""
