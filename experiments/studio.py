"""Go through the studio in a browser, from a hand to a painting and a survey, and photograph each panel: the README's.

    .venv/bin/python experiments/studio.py docs

The hand that is drawn is the built-in one called cursive, traced with the browser's pen; the two machines' drawings in
the survey are answered at random.
"""

import argparse
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image
from playwright.sync_api import Page, expect, sync_playwright

from maulstick.style.cards import style_path
from maulstick.style.store import read_style
from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import Match, Opinions, Pair, SurveyHand, build
from maulstick.survey.questions import questions

sys.path.append(str(Path(__file__).resolve().parents[1]))  # the tests are not installed
from tests.studio.conftest import RunningStudio
from tests.studio.test_pen import pressure

SIZE = {"width": 1280, "height": 800}
PATIENCE = 300_000.0  # milliseconds
STROKES, COLUMNS, ROWS = 24, 6, 4
PARTICIPANTS = 40


def strokes() -> Iterator[tuple[list[tuple[float, float]], list[float]]]:
    """Places as shares of the sheet, and pressures."""
    paths = read_style(style_path("cursive")).hand.paths[:STROKES]
    for number, path in enumerate(paths):
        middle = (np.array([number % COLUMNS, number // COLUMNS]) + 0.5) / [COLUMNS, ROWS]
        extent = np.ptp(path, axis=0).max()
        shares = (path - path.mean(axis=0)) / extent * [0.62 / COLUMNS, 0.88 / COLUMNS] + middle
        force = 0.35 + 0.4 * np.sin(np.linspace(0.2, 3.0, len(path)))
        yield [(float(x), float(y)) for x, y in shares], force.tolist()


def photograph(page: Page, name: str, out: Path) -> None:
    """The page from its top, once it has come to rest."""
    page.evaluate("scrollTo(0, 0)")
    page.mouse.move(640, 60)
    page.wait_for_timeout(1500)
    page.screenshot(path=out / "panel.png")
    with Image.open(out / "panel.png") as shot:
        shot.convert("RGB").save(out / f"studio-{name}.jpg", quality=86)
    (out / "panel.png").unlink()


def choose(page: Page, label: str, option: str) -> None:
    """Of a list."""
    page.get_by_label(label, exact=True).click()
    page.get_by_role("option", name=re.compile(option)).click()


def draw(page: Page, url: str, out: Path) -> None:
    """A hand, and let it be learned."""
    page.goto(url)
    for path, forces in strokes():
        pressure(page, path, forces)
    page.get_by_label("Name of this hand").fill("anna")
    photograph(page, "draw", out)
    page.get_by_role("button", name="Learn this hand").click()
    expect(page.get_by_role("heading", name="This is how anna draws")).to_be_visible(timeout=PATIENCE)


def look_at_styles(page: Page, url: str, out: Path) -> None:
    """At the one that was learned, and one of its strokes."""
    page.goto(f"{url}/styles?style=anna")
    strokes_of_it = page.locator(".stroke-map path[data-stroke]")
    expect(strokes_of_it.first).to_be_visible(timeout=PATIENCE)
    strokes_of_it.nth(9).press("Enter")
    expect(page.get_by_text("No stroke is chosen yet.")).to_be_hidden(timeout=PATIENCE)
    photograph(page, "styles", out)


def plan(page: Page, url: str, out: Path) -> None:
    """Two plans, one of which is still being made."""
    page.goto(f"{url}/plan?style=loops")
    page.get_by_role("button", name="Try an example picture").click()
    expect(page.get_by_role("radio", name="portrait")).to_be_visible(timeout=PATIENCE)
    page.get_by_label("Strokes", exact=True).fill("1000")
    page.get_by_role("button", name="Plan it").click()
    expect(page.get_by_role("button", name="Mix and paint")).to_be_visible(timeout=PATIENCE)
    choose(page, "Hand", "anna")
    choose(page, "Brush or pen", "^fineliner")
    choose(page, "Colours", "One ink")
    page.get_by_label("Outlines").first.fill("0.5")
    page.get_by_role("button", name="Plan it").click()
    second = page.get_by_role("article", name="Plan Portrait 2", exact=True)
    expect(second.get_by_text(re.compile("^[3-5].%"))).to_be_visible(timeout=PATIENCE)
    page.get_by_role("article", name="Plan Portrait", exact=True).get_by_label("Picture or plan").fill("55")
    photograph(page, "plan", out)
    expect(second.get_by_role("button", name="Paint it")).to_be_visible(timeout=PATIENCE)


def mix(page: Page, url: str, out: Path) -> None:
    """All paints."""
    page.goto(f"{url}/paints?plan=portrait")
    expect(page.locator(".tick").first).to_be_visible(timeout=PATIENCE)
    page.locator(".tick").first.click()
    photograph(page, "paints", out)
    page.get_by_role("button", name="All are mixed").click()


def paint(page: Page, url: str, out: Path) -> None:
    """Until the machine is well on its way."""
    page.goto(f"{url}/paint?plan=portrait")
    choose(page, "Machine", "as fast as it can")
    page.get_by_role("button", name="Speed, sheet, camera and copies").click()
    choose(page, "Camera", "own camera")
    page.get_by_role("button", name="Start painting").click()
    expect(page.locator(".doing")).to_have_text(re.compile("stroke [4-6].. of"), timeout=PATIENCE)
    page.get_by_role("button", name="Pause").click()
    photograph(page, "paint", out)
    page.get_by_role("button", name="STOP").click()


def ask(studio: RunningStudio, page: Page, out: Path) -> None:
    """People, who answer at random, about the two plans."""
    plans, pictures = studio.folder / "plans", studio.folder / "pictures"
    looks = plans / "portrait" / "preview.png", plans / "portrait-2" / "preview.png"
    hands = [
        SurveyHand(name="loops", by_hand=looks[0], by_machine=(looks[0],)),
        SurveyHand(name="anna", by_hand=studio.folder / "hands" / "anna" / "hand.png", by_machine=(looks[1],)),
    ]
    pair = Pair(reference=pictures / "portrait" / "picture.png", looks=looks)
    folder = studio.folder / "surveys" / "two-hands"
    survey = build(folder, "Two hands", Match(hands=tuple(hands)), Opinions(systems=("loops", "anna"), pairs=(pair,)))
    answers, rng = Answers(folder), Random(0)
    for token in answers.mint(PARTICIPANTS):
        participant = answers.participant(token)
        assert participant is not None
        answers.begin(token)
        asked = questions(survey, participant.seed)
        for number, question in enumerate(asked):
            chosen = rng.choice(question.choices).name
            answers.answer(token, number, question, chosen, last=number + 1 == len(asked))
    page.goto(f"{studio.url}/survey")
    page.get_by_text(re.compile("two.hands", re.IGNORECASE)).first.click()
    page.wait_for_timeout(5000)
    photograph(page, "survey", out)


def main(out: Path) -> None:
    """Write studio-PANEL.jpg into a folder, a panel each."""
    with TemporaryDirectory() as root, sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        studio = RunningStudio(Path(root))
        try:
            page = studio.let_in(chromium.new_context(viewport=SIZE)).new_page()
            page.set_default_timeout(PATIENCE)
            for step in (draw, look_at_styles, plan, mix, paint):
                step(page, studio.url, out)
            ask(studio, page, out)
        finally:
            studio.close()
            chromium.close()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="the folder for the pictures, as in docs")
    main(parser.parse_args().out)
