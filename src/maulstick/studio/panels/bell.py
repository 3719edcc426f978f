"""Notifications of the browser, once a person asks for them: a plan is done, or a machine waits or has ended."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Self

from nicegui import html, ui

from maulstick.studio.state.plan import Phase
from maulstick.studio.state.run import State
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by

_LABEL = "Tell me when it waits or is finished"

# A browser is asked by the button alone. Where it refuses, also once it is to show one, the button is gone.
_SCRIPT = """<script>
  const BELL = "maulstick-bell";
  const bellRings = () => Notification.permission === "granted" && localStorage.getItem(BELL) === "on";
  function showBell() {
    const bell = document.querySelector(".bell"), may = "Notification" in window && isSecureContext;
    bell.hidden = !may || Notification.permission === "denied";
    if (!bell.hidden) bell.setAttribute("aria-pressed", bellRings());
  }
  async function turnBell() {
    if (bellRings()) localStorage.removeItem(BELL);
    else if ((await Notification.requestPermission()) === "granted") localStorage.setItem(BELL, "on");
    showBell();
  }
  function ringBell(title, body, tag) {
    const bell = document.querySelector(".bell");
    if (bell.hidden || !bellRings() || document.hasFocus()) return;
    try {
      const shown = new Notification(title, { body, tag });
      shown.onclick = () => { focus(); shown.close(); };
    } catch { bell.hidden = true; }
  }
</script>"""


@dataclass(frozen=True)
class News:
    """Notification. tag: where several pages have one with the same tag, a browser shows it once."""

    title: str
    text: str
    tag: str


@dataclass(frozen=True)
class Moment:
    """What goes on in a studio at a moment: phases of its plans by name, and the state of its machine."""

    phases: Mapping[str, Phase]
    run: State

    @classmethod
    def of(cls, studio: Studio) -> Self:
        """Return the present one."""
        return cls({name: plan.phase for name, plan in studio.plans.plans.items()}, studio.run.state)


def bell(studio: Studio) -> None:
    """Show the button that turns notifications on and off, and send them to this page."""
    client, past = ui.context.client, Moment.of(studio)
    button = html.button().classes("bell").props(f'type=button hidden aria-pressed=false aria-label="{_LABEL}"')
    with button:
        ui.icon("notifications_none").classes("off").props("aria-hidden=true")
        ui.icon("notifications_active").classes("on").props("aria-hidden=true")
        ui.tooltip(_LABEL)
    button.on("click", js_handler="() => turnBell()").on("vnodeMounted", js_handler="() => showBell()")
    ui.add_body_html(_SCRIPT)

    def look() -> None:
        nonlocal past
        past, before = Moment.of(studio), past
        for news in news_between(before, past, studio):
            said = ", ".join(map(json.dumps, (news.title, news.text, news.tag)))
            client.run_javascript(f"ringBell({said})")

    shown_by(button, studio.plans.changed, look)
    shown_by(button, studio.run.changed, look)


def news_between(before: Moment, now: Moment, studio: Studio) -> Iterator[News]:
    """Return what a person wants to hear that happened between two moments; not what they did themselves."""
    for name, phase in now.phases.items():
        if before.phases.get(name) is not Phase.PLANNING or phase not in (Phase.PLANNED, Phase.FAILED):
            continue
        plan, title = studio.plans.plans[name], studio.plans.titles()[name]
        if phase is Phase.PLANNED:
            yield News(f"{title} is planned", ", ".join(plan.metrics), f"plan {name}")
        else:
            yield News(f"{title} was not planned", plan.why, f"plan {name}")
    past, run = before.run, now.run
    if run.question and (past.question, past.question_number) != (run.question, run.question_number):
        yield News(f"{studio.run.title} waits for you", f"Please {run.question}.", "run")
    if past.is_on and run.phase == "ended" and past.phase != "stopping":
        yield News(f"{studio.run.title} {'stopped' if run.fault else 'is painted'}", run.sentence, "run")
