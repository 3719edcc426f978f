import tracemalloc
from xml.etree.ElementTree import fromstring

import pytest

from maulstick.recording.files.style_sheet import StyleSheet
from tests.drawing.conftest import Read, labels, points

LINES = '<path class="a" d="M0 0h9"/><path class="b" d="M0 1h9"/>'


def test_rules_count_only_where_they_are_for_every_screen(read: Read) -> None:
    sheet = """
        @import url("other.css"); @font-face { font-family: x }
        .a { stroke: red /* } .b { display: none } */ }
        @media (prefers-color-scheme: dark) { .a { stroke: white } }
        @media print { .b { display: none } @media screen { .b { display: none } } }
        @keyframes x { from { stroke: white } to { stroke: white } }
        @media only screen, print { .b { stroke: blue } }
    """
    body = f'<style>{sheet}</style><style media="print">.a, .b {{ display: none }}</style>{LINES}'
    assert labels(read(body)) == ["#ff0000", "#0000ff"]


def test_a_comment_in_a_style_attribute_is_no_part_of_a_name_or_a_value(read: Read) -> None:
    style = "/* pen; ink: */ stroke: red/**/; stroke-width: 2; fill: none /* paper */"
    path = fromstring(f'<path style="{style}"/>')
    assert StyleSheet(path).of(path) == {"stroke": "red", "stroke-width": "2", "fill": "none"}
    assert labels(read(f'<path style="{style}" d="M0 0h9"/>')) == ["#ff0000"]


def test_a_rule_after_a_block_that_does_not_count_is_read(read: Read) -> None:
    assert points(read(f"<style>@media print {{ .a {{ display: none }} }} .b {{ display: none }}</style>{LINES}")) == [
        [[0, 0], [9, 0]]
    ]


@pytest.mark.parametrize(
    ("block", "counts"),
    [
        ("@MEDIA Screen", True),
        ("@media not print", True),
        ("@media(min-width: 9px)", False),
        ("@Supports (display: grid)", True),
        ("@supports not (display: grid)", False),
        ("@layer", True),
        ("@layer base.plain", True),
        ("@layer base { @media print", False),
        ("@layer base { @supports (mask: none)", True),
    ],
)
def test_blocks_that_browsers_read_for_every_screen_count(read: Read, block: str, counts: bool) -> None:
    sheet = f"{block} {{ .a {{ stroke: red }} }} {'}' * block.count('{')} .b {{ stroke: blue }}"
    assert labels(read(f"<style>{sheet}</style>{LINES}")) == ["#ff0000" if counts else "#000000", "#0000ff"]


@pytest.mark.parametrize(
    ("sheet", "colour"),
    [
        (".a{stroke:red}.b{stroke:blue}", "#0000ff"),
        (".b{stroke:blue}.a{stroke:red}", "#ff0000"),
        (".a{stroke:red}path{stroke:blue}*{stroke:blue}", "#ff0000"),
        ("#i{stroke:red}.a.b{stroke:blue}path.a{stroke:blue}", "#ff0000"),
        ("path.a.b{stroke:red}.b.a{stroke:blue}", "#ff0000"),
        ("path#i.a{stroke:red}#i{stroke:blue}", "#ff0000"),
        ("g path.a{stroke:red}.a{stroke:blue}", "#ff0000"),
        ("path.x, path.a.x{stroke:blue}", "#000000"),
    ],
)
def test_of_rules_the_more_special_counts_and_else_the_later(read: Read, sheet: str, colour: str) -> None:
    body = f'<style>{sheet}</style><g><path id="i" class="b a" stroke="black" d="M0 0h9"/></g>'
    assert labels(read(body)) == [colour]


@pytest.mark.parametrize(
    ("sheet", "style", "colour"),
    [
        (".a{stroke:red!important}#i{stroke:blue}", "", "#ff0000"),
        (".a{stroke:red !important}", "stroke:blue", "#ff0000"),
        (".a{stroke:red ! IMPORTANT;stroke:blue}", "", "#ff0000"),
        (".a{stroke:blue!important}.a.b{stroke:red!important}.a{stroke:blue!important}", "stroke:blue", "#ff0000"),
        (".a{stroke:blue!important}", "stroke:red!important;stroke:blue", "#ff0000"),
    ],
)
def test_what_is_important_counts_before_all_else(read: Read, sheet: str, style: str, colour: str) -> None:
    body = f'<style>{sheet}</style><path id="i" class="a b" style="{style}" d="M0 0h9"/>'
    assert labels(read(body)) == [colour]


@pytest.mark.parametrize(
    ("selector", "hidden"),
    [
        (".axis path", [0, 1, 2]),
        (".axis>path", [0]),
        ("g.axis > g > path", [1, 2]),
        ("svg > .axis .tick path", [1]),
        ("#y path, .tick path", [1, 2]),
        (".tick > .axis path", []),
        ("path path", []),
    ],
)
def test_rules_are_of_what_lies_in_other_elements(read: Read, selector: str, hidden: list[int]) -> None:
    ticks = '<g class="big tick"><path d="M0 1h9"/></g><g id="y"><path d="M0 2h9"/></g>'
    body = f'<g class="axis"><path d="M0 0h9"/>{ticks}</g><path d="M0 3h9"/>'
    drawing = read(f"<style>{selector} {{ display: none }}</style>{body}")
    assert [line[0][1] for line in points(drawing)] == [y for y in range(4) if y not in hidden]
    assert drawing.notes == ()


@pytest.mark.parametrize("selector", ["[id=q]", "path:not(.a)", ".a + path", ".a ~ path", "> path"])
def test_the_first_selector_that_is_not_understood_is_named(read: Read, selector: str) -> None:
    sheet = f"a:hover {{ cursor: help }} .a, {selector.replace('>', '&gt;')} {{ stroke: red }} :root {{ fill: red }}"
    drawing = read(f"<style>{sheet}</style>{LINES}")
    assert labels(drawing) == ["#ff0000", "#000000"]
    (note,) = drawing.notes
    assert note.startswith(f"a style sheet's rule for '{selector}' is left out: ")


@pytest.mark.parametrize("selector", [".a:hover", "g:focus-within path", "path:not(.b):active", "*::selection"])
def test_selectors_of_a_drawing_in_use_are_passed_over_in_silence(read: Read, selector: str) -> None:
    sheet = f"{selector}, .a {{ stroke: red }} {selector} {{ stroke: blue }}"
    assert read(f"<style>{sheet}</style>{LINES}").notes == ()
    (note,) = read(f"<style>{sheet} path:not(:hover) {{ stroke: blue }}</style>{LINES}").notes
    assert note.startswith("a style sheet's rule for 'path:not(:hover)' is left out: ")


@pytest.mark.parametrize("move", ["rotate: 9deg", "scale: 2", "translate: 1px", "transform: scale(2)"])
def test_a_selector_that_is_not_understood_is_named_where_its_rule_only_moves(read: Read, move: str) -> None:
    (note,) = read(f"<style>.a + path {{ {move} }}</style>{LINES}").notes
    assert note.startswith("a style sheet's rule for '.a + path' is left out: ")


def test_a_list_in_parentheses_is_part_of_its_selector(read: Read) -> None:
    drawing = read(f"<style>path:not(.x, :is(.y, .z), .a, .x), .b {{ display: none }}</style>{LINES}")
    assert points(drawing) == [[[0, 0], [9, 0]]]
    (note,) = drawing.notes
    assert note.startswith("a style sheet's rule for 'path:not(.x, :is(.y, .z), .a, .x)' is left out: ")


def test_a_comma_too_many_in_a_list_is_passed_over(read: Read) -> None:
    drawing = read(f"<style>.b, {{ display: none }}</style>{LINES}")
    assert points(drawing) == [[[0, 0], [9, 0]]]
    assert drawing.notes == ()


def test_selectors_that_could_be_tried_in_endless_ways_are_tried_once(read: Read) -> None:
    sheet = "<style>b " + "g " * 40 + "path { display: none }</style>"
    assert len(points(read(f"{sheet}{'<g>' * 80}{LINES}{'</g>' * 80}"))) == 2


@pytest.mark.parametrize("name", ["m", "l"])
def test_many_rules_of_many_groups_are_not_tried_with_each_other(name: str) -> None:
    rules = "".join(f"g.l{i} path {{ stroke: red }}" for i in range(100))
    groups = "".join(f'<g class="{name}{i}"><path/></g>' for i in range(1000))
    root = fromstring(f"<svg><style>{rules}</style>{groups}</svg>")
    sheet = StyleSheet(root)
    tracemalloc.start()
    try:
        coloured = sum("stroke" in sheet.of(element) for element in root.iter())
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert coloured == (100 if name == "l" else 0)
    assert peak < 1e6


def test_sizes_in_styles_are_said_to_be_passed_over(read: Read) -> None:
    drawing = read('<style>rect { width: 30px }</style><rect width="20" height="20"/>')
    assert drawing.notes == ("passed over: sizes and places in styles",)


@pytest.mark.parametrize("page", ['style="width:90mm;height:45mm"', 'style="width:90mm" width="50mm" height="45mm"'])
def test_a_page_has_the_size_that_its_style_says(read: Read, page: str) -> None:
    drawing = read('<path d="M0 0L100 50"/>', f'viewBox="0 0 100 50" {page}')
    assert points(drawing) == [[[0, 0], [90, 45]]]
    assert drawing.notes == ()


def test_what_every_element_is_to_inherit_is_the_outermost_ones_own_however_deep_they_lie() -> None:
    depth, sheet = 60, "* { translate: inherit; rotate: inherit; margin: inherit; padding: inherit }"
    root = fromstring(f'<svg style="translate: 1px"><style>{sheet}</style>{"<g>" * depth}<path/>{"</g>" * depth}</svg>')
    (path,) = root.iter("path")
    assert {name: StyleSheet(root).of(path).get(name) for name in ("translate", "rotate")} == {
        "translate": "1px", "rotate": None,
    }  # fmt: skip
