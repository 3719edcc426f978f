import numpy as np
import pytest
from defusedxml import EntitiesForbidden
from hypothesis import given
from hypothesis import strategies as st

from maulstick.errors import InputError
from maulstick.recording.files.inkml import read_inkml
from maulstick.recording.files.page import Page
from maulstick.recording.files.traces import points_of
from maulstick.storage.arrays import Floats

XYTF = """<traceFormat {}>
  <channel name="X" type="decimal" units="mm"/><channel name="Y" type="decimal" units="mm"/>
  <channel name="T" type="integer" units="ms"/><channel name="F" type="integer" min="0" max="1000"/>
</traceFormat>"""


def ink(body: str, namespace: str = ' xmlns="http://www.w3.org/2003/InkML"') -> Page:
    return read_inkml(f'<?xml version="1.0" encoding="UTF-8"?>\n<ink{namespace}>{body}</ink>'.encode())


def places(page: Page) -> list[list[list[float]]]:
    """The x, y of each stroke in units."""
    return [np.round(stroke[:, 1:3], 9).tolist() for stroke in page.strokes]


def fault(body: str) -> str:
    with pytest.raises(InputError) as caught:
        ink(body)
    return str(caught.value)


def test_a_trace_without_a_format_is_x_and_y_in_an_unknown_unit() -> None:
    page = ink("<trace>10 0, 9 14, 8 28</trace><trace>130 155\n,144 159,</trace>")
    assert places(page) == [[[10, 0], [9, 14], [8, 28]], [[130, 155], [144, 159]]]
    assert (page.unit, page.size, page.kind) == (None, None, "InkML")
    assert all(np.isnan(stroke[:, [0, 3]]).all() for stroke in page.strokes)


def test_documents_without_a_namespace_are_read_alike() -> None:
    assert places(ink("<trace>1 2</trace>", namespace="")) == [[[1, 2]]]


def test_time_and_force_become_seconds_and_pressure() -> None:
    (stroke,) = ink(XYTF.format("") + "<trace>10 20 5000 0, 11.5 20 5008 250, 12 20 5016 1500</trace>").strokes
    assert stroke == pytest.approx(np.array([[5, 0.01, 0.02, 0], [5.008, 0.0115, 0.02, 0.25], [5.016, 0.012, 0.02, 1]]))


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("m", 1), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("in", 25.4e-3), ("pt", 25.4e-3 / 72), ("himetric", 1e-5)],
)
def test_units_of_length_are_kept(unit: str, metres: float) -> None:
    channels = f'<channel name="Y" units="{unit}"/><channel name="X" units="{unit}"/>'
    page = ink(f"<traceFormat>{channels}</traceFormat><trace>1 2</trace>")
    assert page.unit == 1
    assert page.strokes[0][0, 1:3] == pytest.approx([2 * metres, metres]), "the channels are in the order of the format"


def device(x: str, y: str, channel: str = 'type="integer"', trace: str = "3000 -500, 0 0") -> Page:
    """A trace of a tablet with a resolution for each channel, as drawing programs on Windows write it."""
    properties = "".join(
        f'<channelProperty channel="{name}" name="resolution" {resolution}/>'
        for name, resolution in (("X", x), ("Y", y))
    )
    return ink(f"""<definitions><context xml:id="ctx0"><inkSource xml:id="tablet">
      <traceFormat><channel name="X" {channel}/><channel name="Y" {channel}/></traceFormat>
      <channelProperties>{properties}<channelProperty channel="X" name="accuracy" value="9" units="cm"/>
      </channelProperties></inkSource></context></definitions><trace contextRef="#ctx0">{trace}</trace>""")


def test_integers_count_steps_of_the_resolution_of_each_channel() -> None:
    for channel in ('type="integer"', 'type="integer" units="cm"', 'type="integer" units="dev"', 'type="decimal"'):
        page = device('value="1000" units="1/cm"', 'value="50" units="1/in"', channel)
        assert page.unit == 1
        assert page.strokes[0][0, 1:3] == pytest.approx([0.03, -0.254])


def test_a_resolution_of_no_length_leaves_the_unit_unknown() -> None:
    page = device('value="1" units="1/dev"', 'value="0" units="1/cm"')
    assert page.unit is None
    assert places(page) == [[[3000, -500], [0, 0]]]


def test_decimals_with_a_unit_are_no_steps_of_the_resolution() -> None:
    page = device(*['value="1000" units="1/cm"'] * 2, channel='type="decimal" units="mm"')
    assert page.strokes[0][0, 1:3] == pytest.approx([3, -0.5])


def test_a_channel_that_grows_upwards_is_turned_over() -> None:
    channels = '<channel name="X"/><channel name="Y" orientation="-ve"/>'
    assert places(ink(f"<traceFormat>{channels}</traceFormat><trace>1 2, 3 4</trace>")) == [[[1, -2], [3, -4]]]


def test_contexts_are_found_wherever_they_are_said() -> None:
    page = ink(f"""<definitions>{XYTF.format('xml:id="mm"')}
      <context xml:id="named" traceFormatRef="#mm"/><context xml:id="derived" contextRef="#named"/>
      <inkSource xml:id="pen">{XYTF.format("")}</inkSource></definitions>
      <trace contextRef="#named">1 2 0 0</trace>
      <traceGroup contextRef="#derived"><traceGroup><trace>3 4 0 0</trace></traceGroup></traceGroup>
      <context inkSourceRef="#pen"/><trace>5 6 0 0</trace>
      <context><traceFormat><channel name="X" units="cm"/><channel name="Y" units="cm"/></traceFormat></context>
      <trace>7 8</trace>""")
    assert places(page) == [[[0.001, 0.002]], [[0.003, 0.004]], [[0.005, 0.006]], [[0.07, 0.08]]]


def test_pens_in_the_air_and_views_draw_nothing() -> None:
    body = '<trace type="penUp">0 0, 9 9</trace><trace xml:id="a">1 2</trace><traceView traceDataRef="#a"/>'
    assert places(ink(body)) == [[[1, 2]]]


def test_traces_of_the_definitions_are_drawn_where_there_are_no_others() -> None:
    defined = '<definitions><trace xml:id="a">1 2</trace></definitions>'
    assert places(ink(defined + '<traceView traceDataRef="#a"/>')) == [[[1, 2]]]
    assert places(ink(defined + "<trace>3 4</trace>")) == [[[3, 4]]]


def test_traces_that_continue_each_other_are_one_stroke() -> None:
    body = """<trace xml:id="a" continuation="begin">1 1</trace><trace>9 9</trace>
      <trace xml:id="b" continuation="middle" priorRef="#a">2 2</trace>
      <trace continuation="end" priorRef="#b">3 3</trace>"""
    assert places(ink(body)) == [[[1, 1], [2, 2], [3, 3]], [[9, 9]]]


def test_a_trace_continues_none_but_the_one_that_it_names() -> None:
    body = """<trace continuation="begin">1 1</trace><trace continuation="end">2 2</trace>
      <trace continuation="end" priorRef="">3 3</trace><trace continuation="end" priorRef="#None">4 4</trace>"""
    assert places(ink(body)) == [[[1, 1]], [[2, 2]], [[3, 3]], [[4, 4]]]


def test_a_context_without_a_name_is_nobodys() -> None:
    context = '<definitions><context><traceFormat><channel name="Y"/><channel name="X"/></traceFormat></context>'
    assert places(ink(context + '</definitions><trace contextRef="#None">1 2</trace>')) == [[[1, 2]]]


def test_times_of_a_trace_are_counted_from_its_offset() -> None:
    channels = '<channel name="X"/><channel name="Y"/><channel name="T" units="s"/>'
    page = ink(f'<traceFormat>{channels}</traceFormat><trace timeOffset="2500">0 0 0, 1 1 0.5</trace>')
    assert page.strokes[0][:, 0].tolist() == [2.5, 3]


def test_a_time_without_a_unit_is_milliseconds() -> None:
    channels = '<channel name="X"/><channel name="Y"/><channel name="T"/>'
    assert ink(f"<traceFormat>{channels}</traceFormat><trace>0 0 1500</trace>").strokes[0][0, 0] == 1.5


def force(trace: str, channel: str = "") -> list[float]:
    channels = f'<channel name="X"/><channel name="Y"/><channel name="F" {channel}/>'
    page = ink(
        f"<traceFormat>{channels}</traceFormat>" + "".join(f"<trace>{text}</trace>" for text in trace.split("|"))
    )
    return np.concatenate(page.strokes)[:, 3].tolist()


def test_force_is_divided_by_its_range_or_else_by_the_largest_there_is() -> None:
    assert force("0 0 128, 0 0 192", 'min="64" max="192"') == [0.5, 1]
    assert force("0 0 50, 0 0 25|0 0 100") == [0.5, 0.25, 1]
    assert force("0 0 0.5, 0 0 0.25") == [0.5, 0.25]


def test_a_force_that_never_changes_was_not_recorded() -> None:
    assert np.isnan(force("0 0 7, 1 1 7|2 2 7", 'max="10"')).all()


def test_an_unknown_force_or_time_lies_between_its_neighbours_and_an_unknown_place_is_left_out() -> None:
    assert force("0 0 ?, 0 0 0.5, 0 0 ?, 0 0 1") == [0.5, 0.5, 0.75, 1]
    assert places(ink("<trace>0 0, ? 1, 2 ?, 3 3</trace>")) == [[[0, 0], [3, 3]]]


def test_booleans_and_other_channels_are_passed_over() -> None:
    channels = '<channel name="S" type="boolean"/><channel name="X"/><channel name="OTx"/><channel name="Y"/>'
    page = ink(f"<traceFormat>{channels}</traceFormat><trace>T 1 90 2, F 3 80 4</trace>")
    assert places(page) == [[[1, 2], [3, 4]]]


def test_intermittent_channels_may_be_left_out() -> None:
    channels = '<channel name="X"/><channel name="Y"/><intermittentChannels><channel name="F" max="2"/>'
    page = ink(f"<traceFormat>{channels}</intermittentChannels></traceFormat><trace>1 2 1, 3 4, 5 6 2</trace>")
    assert page.strokes[0][:, 3].tolist() == [0.5, 0.75, 1]


def test_differences_and_differences_of_differences_are_added_up() -> None:
    coded = points_of("""1125 18432,'23'43,"7"-8,3-5,7 -3,6 2,6 8,3 6,2 4,3 5""", 2)
    expected = [[1125, 18432], [1148, 18475], [1178, 18510], [1211, 18540], [1251, 18567]]
    assert coded[:5].tolist() == expected, "the example of the Recommendation, section 3.2.1"
    assert points_of("""5 5,'1'1,!9 2""", 2).tolist() == [[5, 5], [6, 6], [9, 8]]


def test_an_asterisk_goes_on_as_before() -> None:
    assert points_of("1 2, * 3, * *", 2).tolist() == [[1, 2], [1, 3], [1, 3]]
    assert points_of("1 2, '3 '1, * *, * *", 2).tolist() == [[1, 2], [4, 3], [7, 4], [10, 5]]
    assert points_of("""1, '3, "1, *, *""", 1).ravel().tolist() == [1, 4, 8, 13, 19]


def test_numbers_may_be_hexadecimal_and_need_no_space_between() -> None:
    assert points_of("#1F-#A,1.5e1-.5", 2).tolist() == [[31, -10], [15, -0.5]]


@given(st.lists(st.tuples(st.integers(-9999, 9999), st.integers(-9999, 9999)), min_size=1, max_size=9))
def test_a_trace_says_the_same_in_values_in_differences_and_in_differences_of_these(p: list[tuple[int, int]]) -> None:
    def text(points: Floats, prefix: str) -> str:
        return ",".join(" ".join(f"{prefix}{value:.0f}" for value in point) for point in points)

    values = np.array(p, dtype=np.float64)
    steps = np.diff(values, axis=0)
    assert points_of(text(values, ""), 2).tolist() == values.tolist()
    assert points_of(",".join([text(values[:1], "!"), text(steps, "'")]), 2).tolist() == values.tolist()
    turns = np.diff(steps, axis=0)
    coded = ",".join([text(values[:1], ""), text(steps[:1], "'"), text(turns, '"')])
    assert points_of(coded, 2).tolist() == values.tolist()


@pytest.mark.parametrize(
    ("body", "text"),
    [
        ("<trace>1 2, 3 x4</trace>", "a trace has 'x4' where a value must be"),
        ("<trace>1 2 3</trace>", "a point of a trace has more than 2 values, as many as it has channels"),
        (
            "<traceFormat><channel name='X'/></traceFormat>",
            "a traceFormat has the channels X; it must have X and Y, and",
        ),
        ("<traceFormat/>", "a traceFormat has the channels none; it must have X and Y, and none twice"),
        (XYTF.format("").replace("1000", "many"), "max of a <channel> is 'many'; it must be a number"),
        (XYTF.format("").replace("1000", "inf"), "max of a <channel> is inf; it must be a finite number"),
        (
            XYTF.format("").replace("mm", "ells") + "<trace>1 2</trace>",
            "there is no unit of the channel X 'ells'; there",
        ),
        (
            XYTF.format("").replace("ms", "days") + "<trace>1 2</trace>",
            "there is no unit of the channel T 'days'; there",
        ),
        (
            "<trace>1 2</trace>" + XYTF.format("") + "<trace>1 2 3 4</trace>",
            "a part of its X and Y has a unit of length",
        ),
        (
            "<trace id='a'>1 2</trace>" + XYTF.format("") + "<trace continuation='end' priorRef='#a'/>",
            "a trace continues",
        ),
    ],
)
def test_what_cannot_be_read_is_told(body: str, text: str) -> None:
    assert fault(body).startswith(text)


def test_another_kind_of_document_is_refused() -> None:
    with pytest.raises(InputError, match="its outermost element is <inc>; it must be <ink>"):
        read_inkml(b"<inc/>")


def test_entities_are_refused() -> None:
    with pytest.raises(EntitiesForbidden):
        read_inkml(b'<!DOCTYPE ink [<!ENTITY a "1 2">]><ink><trace>&a;</trace></ink>')
