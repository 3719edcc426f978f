"""Several brushes of a plan, as settings, forms and cards have them, without a page."""

from maulstick.jobs.plan.options import PlanOptions
from maulstick.jobs.plan.request import PlanRequest
from maulstick.painting.painting import Paint
from maulstick.studio.panels.plan.again import values_of
from maulstick.studio.panels.plan.brushes import are_offered
from maulstick.studio.state.presets import Preset
from maulstick.studio.state.settings import Choices
from maulstick.studio.widgets.brushes import brushes_in_words
from maulstick.studio.workers.planned_paints import asked_in_words

SEVERAL = "fineliner,wash,marker"


def test_settings_and_the_form_for_an_earlier_plan_have_all_brushes() -> None:
    values = values_of(PlanRequest(None, PlanOptions(text="a boat", brush=SEVERAL)))
    settings = Choices.model_validate(values)
    assert settings.brush == SEVERAL
    assert Preset.read(Preset.of("wet", settings).written(), "wet.json").settings.brush == SEVERAL


def test_several_brushes_are_named_from_the_broadest_to_the_finest() -> None:
    assert brushes_in_words(SEVERAL) == "wash, marker and fineliner"
    assert brushes_in_words("marker,gone,wash") == "marker, gone and wash"
    assert brushes_in_words("micron-01") == "a pen of 0.25 mm"


def test_several_brushes_are_offered_where_each_of_them_is() -> None:
    for machine in ("", "axidraw"):
        assert are_offered(machine, SEVERAL)
    assert not are_offered("", f"{SEVERAL},gone")
    assert not are_offered("", "")


def test_a_machine_asks_for_a_pen_as_it_is_called_in_a_shop_and_for_a_brush_by_its_name() -> None:
    for brush, words in (("micron-01", "pen Sakura Pigma Micron 01"), ("fineliner", "fineliner")):
        paint = Paint(colour=(0, 0, 0), brush=brush)
        asked = asked_in_words(f"put in the {brush} with the paint {paint.label}", paint, 0)
        assert asked == f"put in the {words} with paint 1 (black)"
