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


def test_a_rule_after_a_block_that_does_not_count_is_read(read: Read) -> None:
    assert points(read(f"<style>@media print {{ .a {{ display: none }} }} .b {{ display: none }}</style>{LINES}")) == [
        [[0, 0], [9, 0]]
    ]
