"""Part of the panel where a person sets a machine up: moves the pen, tries it, and says where the sheet begins."""

from collections.abc import Callable
from functools import partial

from nicegui import html, ui

from maulstick.jobs.paint.options import PaintOptions
from maulstick.studio.state.by_hand import HandState
from maulstick.studio.state.studio import Studio
from maulstick.studio.widgets.showing import shown_by
from maulstick.studio.wording import BY_HAND_LABEL
from maulstick.studio.workers.by_hand import Deed, Jog, SetServo, Standing, Word

_STEPS = {10.0: "10 mm", 1.0: "1 mm", 0.1: "0.1 mm"}
_SHARES = {10.0: 0.05, 1.0: 0.01, 0.1: 0.002}  # of a servo's range, by the same choice
# Label, axis, sign, and column and row of the pad.
_PAD = (
    ("y +", 1, 1, 2, 1),
    ("x \N{MINUS SIGN}", 0, -1, 1, 2),
    ("x +", 0, 1, 3, 2),
    ("y \N{MINUS SIGN}", 1, -1, 2, 3),
    ("z +", 2, 1, 4, 1),
    ("z \N{MINUS SIGN}", 2, -1, 4, 3),
)


class ByHandForm:
    """Buttons that move the machine that is chosen.

    machine: returns the options that name it.  plan: returns the name of what will be painted, or "".
    kept: called with the name of an easel that was kept.
    """

    def __init__(
        self,
        studio: Studio,
        machine: Callable[[], PaintOptions],
        plan: Callable[[], str],
        kept: Callable[[str], None],
    ) -> None:
        self._studio, self._hand = studio, studio.by_hand
        self._machine, self._plan, self._kept = machine, plan, kept
        self.root = ui.expansion(BY_HAND_LABEL).classes("more")
        self._heights: list[ui.button] = []  # for pens that no servo lifts
        with self.root:
            self._hint = html.p("Moves the lifted pen step by step, shows where the sheet lies, and tries the pen.")
            self._hint.classes("hint")
            self._begin = ui.button("Take hold of the machine", icon="back_hand", on_click=self._take_hold)
            self._begin.props("outline")
            self._said = ui.label().props('role="status"')
            self._where = ui.label().classes("figure")
            with ui.element().classes("by-hand") as self._moves:
                self._step = ui.toggle(_STEPS, value=1.0).props('aria-label="How far one click moves"')
                with ui.element().classes("pad"):
                    for label, axis, sign, column, row in _PAD:
                        button = ui.button(label, on_click=partial(self._jog, axis, sign)).props("outline")
                        button.style(f"grid-area: {row} / {column}")
                        if axis == 2:
                            self._heights.append(button)
                self._heights.append(self._act("The paper is at this height", "vertical_align_bottom", Deed.PAPER))
                with ui.element().classes("line"):
                    self._lower = self._act("Lower the pen", "south", Deed.LOWER)
                    self._lift = self._act("Lift the pen", "north", Deed.LIFT)
                    self._square = self._act("Draw a test square", "crop_square", Deed.SQUARE)
                with ui.element().classes("line") as self._servo:
                    ui.button("Servo higher", icon="add", on_click=partial(self._turn_servo, 1)).props("outline")
                    ui.button("Servo lower", icon="remove", on_click=partial(self._turn_servo, -1)).props("outline")
                with ui.element().classes("line"):
                    self._act("Go to the corner", "home", Deed.HOME)
                    self._outline = self._act("Go around the sheet", "crop_free", Deed.OUTLINE)
                    self._act("The sheet begins here", "my_location", Deed.CORNER)
                with ui.element().classes("line") as self._keeping:
                    self._name = ui.input("Name of this place", value="my-sheet").props("outlined maxlength=40")
                    ui.button("Keep it", icon="save", on_click=self._keep).props("outline")
                self._off = self._act("Motors off", "power_off", Deed.LET_GO)
            with ui.element().classes("line"):
                self._find = self._act("Find home by its switches", "where_to_vote", Deed.FIND_HOME)
                self._unlock = self._act("Unlock it where it is", "lock_open", Deed.UNLOCK)
            self._hold = self._act("Motors on: this is its home", "power", Deed.TAKE_HOLD)
            self._leave = self._act("Done: let the machine go", "close", Deed.LEAVE)
        shown_by(self.root, self._hand.changed, self.show)

    def show(self) -> None:
        """Show where the machine stands, and what it can do."""
        state = self._hand.state
        self._hint.visible = self._begin.visible = state.phase == "off"
        self._said.text = _said(state)
        self._said.visible = bool(self._said.text)
        self._said.classes(add="fault" if state.fault else "", remove="" if state.fault else "fault")
        standing = state.standing if state.phase in ("ready", "moving") else None
        self._moves.visible = self._where.visible = holds = standing is not None
        self._hold.visible = state.phase == "loose"
        self._unlock.visible = state.phase == "locked"
        self._find.visible = state.phase == "locked" or (standing is not None and standing.finds_home)
        self._leave.visible = holds or state.phase in ("loose", "locked")
        if state.phase != "off":
            self.root.open()
        if standing is not None:
            self._show_standing(standing)

    def _show_standing(self, standing: Standing) -> None:
        self._where.text = _where(standing)
        for button in self._heights:
            button.visible = standing.pen is None
        self._servo.visible = standing.pen is not None
        self._lower.visible, self._lift.visible = standing.lifted, not standing.lifted
        self._square.enabled = standing.lifted
        self._outline.visible = standing.has_sheet
        self._off.visible = standing.lets_go
        self._keeping.visible = standing.changed

    def _act(self, label: str, icon: str, word: Word) -> ui.button:
        return ui.button(label, icon=icon, on_click=lambda: self._hand.do(word)).props("outline")

    def _jog(self, axis: int, sign: int) -> None:
        self._hand.do(Jog(axis, sign * 1e-3 * float(self._step.value)))

    def _turn_servo(self, sign: int) -> None:
        self._hand.do(SetServo(sign * _SHARES[float(self._step.value)]))

    def _take_hold(self) -> None:
        plan = self._plan()
        self._hand.begin(self._machine(), self._studio.folder.painting(plan) if plan else None)

    def _keep(self) -> None:
        self._kept(self._hand.keep(str(self._name.value or "")))


def _where(standing: Standing) -> str:
    x, y, z = (f"{1e3 * value:.1f}" for value in standing.place)
    if standing.pen is None:
        return f"x {x}, y {y}, z {z} mm, pen {'lifted' if standing.lifted else 'lowered'}"
    at, number = ("up", standing.pen.up) if standing.lifted else ("down", standing.pen.down)
    return f"x {x}, y {y} mm, pen {at} at {number:g}"


def _said(state: HandState) -> str:
    said = {"connecting": "Connecting …", "stopping": "Stopping, and lifting the pen …"}.get(
        state.phase, state.sentence
    )
    return said[:1].upper() + said[1:]
