"""Files whose way to the studio breaks off, in a real browser."""

from pathlib import Path

from playwright.sync_api import Browser, expect

from tests.studio.conftest import RunningStudio, patient
from tests.studio.test_plan_page import picture_to_bring


def test_a_file_that_did_not_arrive_is_said_and_can_be_brought_again(
    studio: RunningStudio, browser: Browser, tmp_path: Path
) -> None:
    context = studio.let_in(patient(browser.new_context()))
    tab, picture = context.new_page(), picture_to_bring(tmp_path)
    tab.goto(f"{studio.url}/plan")

    def bring() -> None:
        with tab.expect_file_chooser() as chooser:
            tab.get_by_role("button", name="Bring a picture").click()
        chooser.value.set_files(picture)

    tab.route("**/upload/*", lambda route: route.abort("connectionreset"), times=1)
    bring()
    expect(tab.get_by_text("That file did not arrive")).to_be_visible()
    bring()
    expect(tab.get_by_role("radio", name=picture.stem)).to_be_checked()
    context.close()
