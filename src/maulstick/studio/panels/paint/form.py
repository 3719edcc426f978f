"""Form for the options of a run: machine, speed, sheet, tray and camera."""

import asyncio
import re
from collections.abc import Callable
from pathlib import Path

from nicegui import events, ui

from maulstick.errors import InputError
from maulstick.jobs.paint.options import MOST_COPIES, PaintOptions
from maulstick.jobs.plan.options import MOST_STROKES
from maulstick.robot.machines import is_simulated
from maulstick.studio.state.studio import Studio
from maulstick.studio.state.typed_numbers import number, whole_number
from maulstick.studio.widgets.number_field import NumberField
from maulstick.studio.widgets.uploading import upload_button
from maulstick.studio.wording import DETAILS_LABEL, MACHINES

SHORT_MENU = "outlined popup-content-class=short-menu"
"""Properties of a select whose menu opens downwards, and not up under the frame."""

USUAL_MACHINE = "sim:real"
"""Machine that is chosen where nobody has named one."""

_AT_A_PORT = ("grbl", "axidraw")
_CAMERAS = {"": "No camera", "usb:0": "First USB camera", "usb:1": "Second USB camera", "usb:2": "Third USB camera"}
_LIES = {
    "grbl": "The sheet's lower left corner lies at the machine's origin, where the tip is at X0 Y0.",
    "axidraw": "Push the pen to its home corner before the board is switched on. It rests on the sheet's upper left "
    "corner then.",
    **dict.fromkeys(
        ("lite6", "xarm", "franka", "ur"),
        f"An easel file says where an arm's sheet lies: bring it under “{DETAILS_LABEL}”.",
    ),
}
"""Where a sheet lies without an easel file, by the kind of the machine."""

_EASEL_S_OWN = "easel"
_LARGEST_EASEL = 2**16  # bytes; an easel file has a few hundred
_SLOWEST, _FASTEST = 0.1, 10_000  # mm/s: no limit, where the machine has one of its own, as all have
_LONGEST_ADDRESS = 253  # letters, as of a host name


class OptionsForm:
    """Form that shows only the fields that fit the chosen machine.

    first: place of the fields of the machine.  later: place of the finer options.
    touched: called after a person has changed a field.
    """

    def __init__(self, studio: Studio, first: ui.element, later: ui.element, touched: Callable[[], None]) -> None:
        self._studio = studio
        self._tray_file = studio.folder.root / "tray.json"
        self._easel_files: dict[str, Path] = {}
        with first:
            self._machine = ui.select(MACHINES, label="Machine", value=USUAL_MACHINE, on_change=self.fit)
            self._machine.props(SHORT_MENU)
            self._port = ui.select([], label="Port", with_input=True, new_value_mode="add-unique", clearable=True)
            self._port.props(f"{SHORT_MENU} hint='as in /dev/ttyUSB0'")
            self._address = ui.input("Address in the network").props("outlined hint='as in 192.168.1.20'")
            self._lies = ui.label().classes("hint")
        with later:
            self._speed = NumberField("No faster than, mm/s", min=0, max=_FASTEST).props("outlined clearable")
            self._speed.props("hint='empty: as fast as hand and machine are'")
            self._easel = ui.select({}, label="Where the sheet lies", on_change=self.fit).props(SHORT_MENU)
            upload_button("Bring an easel file", ".json", self._take_easel)
            self._tray = ui.switch("Dip the brush into the tray", value=True)
            self._camera = ui.select({}, label="Camera", on_change=self.fit).props(SHORT_MENU)
            self._every = NumberField("Look and plan again every … strokes", value=0, min=0)
            self._every.props("outlined hint='0: only when you ask for it'")
            self._copies = NumberField("Copies", value=1, min=1, max=MOST_COPIES).props("outlined")
            self._copies.props("hint='each on a new sheet, which it asks you for'")
            self._pauses = ui.input("Wait before strokes").props("outlined hint='by number: 40, 120; empty: never'")
        for field in (
            self._machine,
            self._port,
            self._address,
            self._speed,
            self._easel,
            self._tray,
            self._camera,
            self._every,
            self._copies,
            self._pauses,
        ):
            field.on("update:model-value", touched, args=[])  # unlike on_change, not when it is filled in for them
        # The event above comes in a message of its own, before which what is usual might be filled in.
        self._is_filling = False
        self._machine.on_value_change(lambda: None if self._is_filling else touched())
        self._offer_easels("")
        self.fit()

    async def offer_ports(self) -> None:
        """List the serial ports of this computer in the form."""
        ports = await asyncio.to_thread(_ports)
        if not self._port.is_deleted:
            self._port.set_options([*dict.fromkeys([*ports, *filter(None, [self._port.value])])])

    @property
    def usb_camera(self) -> str | None:
        """Spec of the chosen camera that a person has put over the sheet, or None."""
        return None if self.is_simulated else str(self._camera.value or "") or None

    @property
    def is_simulated(self) -> bool:
        """Whether the chosen machine is a simulated easel."""
        return is_simulated(str(self._machine.value))

    def leave_plan(self) -> None:
        """Forget what was asked for one plan alone, once another is chosen."""
        self._copies.value, self._pauses.value = 1, ""

    def begin(self, machine: str | None, dips: bool) -> None:
        """Show what is usual for a plan that has no options yet.

        machine: its spec, or only its kind; None leaves the one that is chosen, as does one that only takes a file.
        dips: whether the brush is dipped into the tray.
        """
        self._tray_file = self._studio.folder.root / "tray.json"
        self._tray.value = dips
        if machine is not None:
            self._show_machine(machine)
        self.fit()

    def fill(self, options: PaintOptions) -> None:
        """Show the options of an earlier run."""
        self._tray_file = options.tray or self._studio.folder.root / "tray.json"
        self._tray.value = options.tray is not None
        self._show_machine(options.machine)
        self._speed.value = None if options.speed in (None, 1e-3 * _FASTEST) else 1e3 * options.speed
        self._offer_easels("" if options.easel is None else self._easel_of(options.easel))
        self.fit()
        watched = bool(options.replan or options.look)
        self._camera.value = (_EASEL_S_OWN if options.simulated else options.camera or "") if watched else ""
        self._every.value = options.replan or 0
        self._copies.value = options.sheets
        self._pauses.value = ", ".join(map(str, options.pause_at or ()))

    def options(self, picture: Path | None) -> PaintOptions:
        """Return the options as filled in. picture: that the plan is of, None where it is of none.

        Raises InputError for options that are invalid or do not fit each other.
        """
        looks = bool(self._camera.value)
        every = whole_number(self._every.value, "the number of strokes between two looks", 0, MOST_STROKES)
        if looks and picture is None:
            raise InputError("a camera is for plans of a picture, and this one is of none; let nobody look")
        easel = str(self._easel.value)
        return PaintOptions(
            robot=self._machine_spec(),
            easel=(self._easel_files.get(easel) or self._studio.run.easels.path(easel)) if easel else None,
            tray=self._tray_file if self._tray.visible and self._tray.value else None,
            speed=1e-3 * _speed(self._speed.value),
            replan=every if looks else 0,
            look=looks,
            camera=None if self._camera.value in ("", _EASEL_S_OWN) else str(self._camera.value),
            picture=picture if looks else None,
            copies=whole_number(self._copies.value, "the number of copies", 1, MOST_COPIES)
            if self._copies.visible
            else None,
            pause_at=_numbers(str(self._pauses.value or "")) if self._pauses.visible else None,
        )

    def _show_machine(self, spec: str) -> None:
        kind, _, address = spec.partition(":")
        shown = spec if is_simulated(spec) else kind
        if shown not in MACHINES:
            return
        self._is_filling = True
        self._machine.value = shown
        self._is_filling = False
        if kind in _AT_A_PORT and address:
            self._port.set_options([*dict.fromkeys([*self._port.options, address])], value=address)
        elif kind not in _AT_A_PORT and not is_simulated(spec):
            self._address.value = address

    def _machine_spec(self) -> str:
        """Return the machine with its address, as for ``--robot``. Raises InputError where the address is missing."""
        kind = str(self._machine.value)
        if is_simulated(kind):
            return kind
        address = str((self._port.value if kind in _AT_A_PORT else self._address.value) or "").strip()
        if not address and kind == "axidraw":
            return kind
        if not address:
            what = "port" if kind in _AT_A_PORT else "address in the network"
            raise InputError(f"where is the {MACHINES[kind]}? Give its {what}")
        if len(address) > _LONGEST_ADDRESS or not address.isprintable():
            raise InputError("that is no port and no address; write it as in /dev/ttyUSB0, or 192.168.1.20")
        return f"{kind}:{address}"

    def fit(self) -> None:
        """Show the fields that fit the machine, and the switch for the tray if there is one."""
        kind = str(self._machine.value)
        simulated = is_simulated(kind)
        self._port.visible = kind in _AT_A_PORT
        self._address.visible = not simulated and kind not in _AT_A_PORT
        self._lies.text = "" if self._easel.value else _LIES.get(kind, "")
        self._lies.visible = bool(self._lies.text)
        self._tray.visible = self._tray_file.is_file()
        own = {"": _CAMERAS[""], _EASEL_S_OWN: "The easel's own camera"}
        cameras = own if simulated else _CAMERAS
        if self._camera.options != cameras:
            self._camera.set_options(cameras, value=self._camera.value if self._camera.value in cameras else "")
        self._every.visible = bool(self._camera.value)
        self._copies.visible = not simulated and not self._camera.value  # a camera sees one sheet
        self._pauses.visible = not self._camera.value  # strokes that are planned again have other numbers

    def take_easel(self, name: str) -> None:
        """Choose an easel that was kept."""
        self._offer_easels(name)
        ui.notify(f"The sheet lies as {name} says", type="positive")

    def _easel_of(self, path: Path) -> str:
        """Return an easel's name in the studio, or its path where it comes from the command line."""
        easels = self._studio.run.easels
        if path.stem in easels.names() and easels.path(path.stem).absolute() == path:
            return path.stem
        self._easel_files[str(path)] = path
        return str(path)

    def _offer_easels(self, chosen: str) -> None:
        names = [*self._studio.run.easels.names(), *self._easel_files]
        self._easel.set_options({"": "Where the machine expects it", **{name: name for name in names}}, value=chosen)

    async def _take_easel(self, file: events.UploadEventArguments) -> None:
        if file.file.size() > _LARGEST_EASEL:
            raise InputError("that file is too large for an easel; choose one from maulstick calibrate touch")
        content = await file.file.read()
        name = await asyncio.to_thread(self._studio.run.easels.keep, str(file.file.name), content)
        self.take_easel(name)


def _ports() -> list[str]:
    from serial.tools import list_ports

    return [port.device for port in list_ports.comports()]


def _speed(value: float | None) -> float:
    """Check the speed, millimetres per second; None is no limit. Raises InputError for a speed out of range."""
    return _FASTEST if value is None else number(value, "the speed", _SLOWEST, _FASTEST, "mm/s")


def _numbers(text: str) -> tuple[int, ...] | None:
    """Read numbers of strokes, apart by commas or spaces; None for none. Raises InputError where one is no number."""
    words = text.replace(",", " ").split()
    for word in words:
        if not (re.fullmatch("[0-9]{1,6}", word) and 1 <= int(word) <= MOST_STROKES):
            allowed = f"a number from 1 to {MOST_STROKES}, as in 40, 120"
            raise InputError.of_range("the stroke to wait before", repr(word[:20]), allowed)
    return tuple(map(int, words)) or None
